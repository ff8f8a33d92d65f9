#include "io/scene/mesh_source.h"

#include "io/mesh_io/repair/repair.h"
#include "io/system/file_content.h"

namespace palpate::scene {
namespace {

/// The field or flag that gives a mesh's unit: "tool.jaw.mesh" -> "tool.unit", "--organ" -> "--organ-unit".
std::string unit_field(const LocatedString& mesh) {
  if (mesh.by_flag) return mesh.where + "-unit";
  return mesh.where.find(": organ.") != std::string::npos ? "organ.unit" : "tool.unit";
}

void note(const mesh_io::MeshFindings& findings, const std::string& file, MeshNotes& notes) {
  const auto add = [&](const std::vector<std::string>& texts, std::vector<std::string>& all) {
    for (const std::string& word : texts) all.push_back(file + ": " + word);
  };
  add(findings.repairs, notes.repairs);
  add(findings.defects, notes.remarks);
  add(findings.remarks, notes.remarks);
}

/// @throws InputError for a missing unit; first for a file that is no mesh, which needs none
void require_unit(const LocatedString& mesh, const std::optional<LengthUnit>& unit) {
  if (unit) return;
  with_location(mesh, [&] { refuse_other_content(mesh.file(), FileContent::kMesh, "a mesh file"); });
  mesh.fail("its unit is missing, give " + unit_field(mesh) + ": mm, cm, m or in");
}

}  // namespace

mesh_io::LoadedMesh read_part_source(const LocatedString& mesh, const std::optional<LengthUnit>& unit,
                                     MeshNotes& notes) {
  require_unit(mesh, unit);
  mesh_io::LoadedMesh loaded = with_location(mesh, [&] { return mesh_io::read_mesh(mesh.file(), unit); });
  note(loaded.findings, mesh.value, notes);
  return loaded;
}

mesh_io::LoadedMesh read_organ_source(const LocatedString& mesh, const std::optional<LengthUnit>& unit,
                                      MeshNotes& notes) {
  require_unit(mesh, unit);
  mesh_io::LoadedMesh loaded = with_location(
      mesh, [&] { return mesh_io::repair_organ(mesh_io::read_mesh(mesh.file(), unit), mesh.value); });
  note(loaded.findings, mesh.value, notes);
  return loaded;
}

}  // namespace palpate::scene
