#include "palpate/scene/mesh_source.h"

#include "palpate/base/error.h"

namespace palpate::scene {
namespace {

/// The field or flag that would have given the unit: "tool.jaw.mesh" -> "tool.unit", "--organ" ->
/// "--organ-unit".
std::string unit_field(const Stated& mesh) {
  if (mesh.by_flag()) return mesh.where + "-unit";
  return mesh.where.find(": organ.") != std::string::npos ? "organ.unit" : "tool.unit";
}

}  // namespace

geometry::LoadedMesh read_mesh_source(const Stated& mesh, const std::optional<LengthUnit>& unit,
                                      std::vector<std::string>& remarks) {
  if (!unit) mesh.fail("its unit is missing, give " + unit_field(mesh) + ": mm, cm, m or in");
  try {
    geometry::LoadedMesh loaded = geometry::read_mesh(mesh.file(), unit);
    for (const auto* findings : {&loaded.findings.repairs, &loaded.findings.defects}) {
      for (const std::string& finding : *findings) remarks.push_back(mesh.value + ": " + finding);
    }
    return loaded;
  } catch (const InputError& error) {
    throw InputError(mesh.where + ": " + error.what());
  }
}

}  // namespace palpate::scene
