#include "io/scene/mesh_source.h"

#include <cstdint>
#include <span>
#include <utility>

#include "core/base/content_hash.h"
#include "io/mesh_io/mesh_file.h"
#include "io/mesh_io/repair/repair.h"
#include "io/system/file_content.h"

namespace palpate::scene {
namespace {

/// The field or flag that gives a mesh's unit: "tool.jaw.mesh" -> "tool.unit", "--organ" -> "--organ-unit".
std::string unit_field(const LocatedString& mesh) {
  if (mesh.by_flag) return mesh.where + "-unit";
  return mesh.where.find(": organ.") != std::string::npos ? "organ.unit" : "tool.unit";
}

void add(const std::vector<std::string>& texts, const std::string& file, std::vector<std::string>& all) {
  for (const std::string& text : texts) all.push_back(file + ": " + text);
}

/// @throws InputError for a missing unit; first for a file that is no mesh, which needs none
void require_unit(const LocatedString& mesh, const std::optional<LengthUnit>& unit) {
  if (unit) return;
  with_location(mesh, [&] { refuse_other_content(mesh.file(), FileContent::kMesh, "a mesh file"); });
  mesh.fail("its unit is missing, give " + unit_field(mesh) + ": mm, cm, m or in");
}

// Raise this whenever another mesh or other messages come from a file, so that stored meshes are not used. A
// test compares a hash of them.
constexpr std::uint64_t kReadVersion = 1;

constexpr std::size_t kLeastStored = 1'000'000;  // bytes; a smaller file is read in 0.05 s

contact::ReadOrgan read_and_repair(mesh_io::MeshFile file, LengthUnit unit, const std::string& name) {
  mesh_io::LoadedMesh loaded = mesh_io::repair_organ(mesh_io::read_mesh(std::move(file), unit), name);
  return {std::move(loaded.mesh), std::move(loaded.findings.repairs), std::move(loaded.findings.remarks),
          std::move(loaded.space)};
}

contact::ReadOrgan read_organ(const LocatedString& mesh, LengthUnit unit, const contact::OrganStore* store) {
  mesh_io::MeshFile file = mesh_io::open_mesh_file(mesh.file());
  using Format = mesh_io::MeshFormat;
  const bool names_others = file.format == Format::kGltf || file.format == Format::kGlb;
  if (store == nullptr || names_others || file.bytes.size() < kLeastStored) {
    return read_and_repair(std::move(file), unit, mesh.value);
  }
  const ContentHash key = ContentHasher()
                              .add(kReadVersion)
                              .add(metres_per(unit))
                              .add(file.format)
                              .add(std::span<const char>(file.bytes))
                              .hash();
  if (std::optional<contact::ReadOrgan> stored = store->load_read(key)) return std::move(*stored);
  contact::ReadOrgan organ = read_and_repair(std::move(file), unit, mesh.value);
  store->store_read(key, organ);
  return organ;
}

}  // namespace

mesh_io::LoadedMesh read_part_source(const LocatedString& mesh, const std::optional<LengthUnit>& unit,
                                     MeshNotes& notes) {
  require_unit(mesh, unit);
  mesh_io::LoadedMesh loaded = with_location(mesh, [&] { return mesh_io::read_mesh(mesh.file(), unit); });
  add(loaded.findings.repairs, mesh.value, notes.repairs);
  add(loaded.findings.defects, mesh.value, notes.remarks);
  add(loaded.findings.remarks, mesh.value, notes.remarks);
  return loaded;
}

contact::ReadOrgan read_organ_source(const LocatedString& mesh, const std::optional<LengthUnit>& unit,
                                     const contact::OrganStore* store, MeshNotes& notes) {
  require_unit(mesh, unit);
  contact::ReadOrgan organ = with_location(mesh, [&] { return read_organ(mesh, *unit, store); });
  add(organ.repairs, mesh.value, notes.repairs);
  add(organ.remarks, mesh.value, notes.remarks);
  return organ;
}

}  // namespace palpate::scene
