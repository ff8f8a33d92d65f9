#include "palpate/read_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <fmt/core.h>

#include "core/base/index.h"
#include "core/base/text.h"
#include "io/mesh_io/mesh_file.h"
#include "io/mesh_io/repair/repair_surface.h"
#include "io/system/path_text.h"
#include "io/system/plausible.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

struct Merged {
  geometry::TriangleMesh mesh;
  std::size_t collapsed = 0;  // dropped triangles that use a vertex twice
  std::size_t distinct = 0;   // distinct positions of vertices, used or not
};

/// For each vertex the first one with equal coordinates. Uses a sort: a hostile file could make all hashes of
/// coordinates collide.
std::vector<std::int32_t> first_at_position(const std::vector<Vec3>& vertices, std::size_t& places) {
  std::vector<std::pair<std::array<double, 3>, std::int32_t>> sorted;
  sorted.reserve(vertices.size());
  for (const Vec3& vertex : vertices) {
    const Vec3 p = vertex + Vec3::Zero();  // turns -0 into 0
    sorted.emplace_back(std::array{p.x(), p.y(), p.z()}, static_cast<std::int32_t>(sorted.size()));
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::int32_t> first(vertices.size());
  for (std::size_t n = 0; n < sorted.size(); ++n) {
    const bool is_new = n == 0 || sorted[n].first != sorted[n - 1].first;
    places += is_new ? 1 : 0;
    first[at(sorted[n].second)] = is_new ? sorted[n].second : first[at(sorted[n - 1].second)];
  }
  return first;
}

/// Keeps one vertex for each distinct position that a triangle uses, in the order of the input. Only exactly
/// equal positions are merged.
Merged merge_equal_vertices(geometry::TriangleMesh mesh) {
  Merged merged;
  const std::vector<std::int32_t> name = first_at_position(mesh.vertices, merged.distinct);
  for (geometry::Triangle& triangle : mesh.triangles) {
    for (std::int32_t& v : triangle) v = name[at(v)];
  }
  merged.collapsed = std::erase_if(mesh.triangles, [](const geometry::Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  });
  drop_unused_vertices(mesh);
  merged.mesh = std::move(mesh);
  return merged;
}

void report_merged(const MeshFile& file, std::size_t vertices, const Merged& merged,
                   std::vector<std::string>& repairs) {
  const std::size_t distinct = merged.distinct;
  const std::size_t kept = merged.mesh.vertices.size();
  if (file.format == MeshFormat::kStl) {  // triangles without a list of vertices
    repairs.push_back(fmt::format("joined {} triangle corners in {} vertices", vertices, kept));
  } else if (vertices > distinct) {
    repairs.push_back("merged " + counted(vertices - distinct, "duplicate vertex", "duplicate vertices"));
  }
  if (file.format != MeshFormat::kStl && distinct > kept) {
    repairs.push_back(
        fmt::format("dropped {} that no triangle uses", counted(distinct - kept, "vertex", "vertices")));
  }
  if (merged.collapsed > 0) {
    repairs.push_back(fmt::format("dropped {} with two corners in one place",
                                  counted(merged.collapsed, "triangle", "triangles")));
  }
}

}  // namespace

LoadedMesh read_mesh(const std::filesystem::path& path, std::optional<LengthUnit> unit) {
  const MeshFile file = open_mesh_file(path);
  if (!unit) throw InputError(to_text(path) + ": its unit is missing: must be mm, cm, m or in");
  ImportedMesh imported = import_mesh(file);
  if (imported.mesh.triangles.empty()) {
    throw InputError(to_text(path) + ": no triangles" +
                     (imported.repairs.empty() ? "" : " (" + joined(imported.repairs) + ")"));
  }
  const std::size_t vertices = imported.mesh.vertices.size();
  Merged merged = merge_equal_vertices(std::move(imported.mesh));
  report_merged(file, vertices, merged, imported.repairs);
  if (merged.mesh.triangles.empty()) {
    throw InputError(fmt::format("{}: no triangles ({})", to_text(path), joined(imported.repairs)));
  }
  for (Vec3& vertex : merged.mesh.vertices) vertex *= metres_per(*unit);
  LoadedMesh loaded{std::move(merged.mesh), {}, declared_space(file)};
  loaded.findings = findings_of(loaded.mesh);
  loaded.findings.repairs = std::move(imported.repairs);
  return loaded;
}

void require_organ(const LoadedMesh& loaded, const std::string& name) {
  const double size = geometry::bounds(loaded.mesh).size().maxCoeff();
  if (!kOrganExtent.possible.contains(size)) {
    throw InputError(fmt::format("{}: its largest side is {}, an organ's is 5 to 2000 mm{}", name,
                                 in_unit(kOrganExtent, size), unit_question(kOrganExtent, size)));
  }
  if (loaded.findings.defects.empty()) return;
  throw InputError(name + ": cannot be an organ: " + joined(loaded.findings.defects) +
                   "; an organ must be closed, manifold and turned outwards: repair it in a mesh tool first");
}

void require_tool(const LoadedMesh& loaded, const std::string& name) {
  const double size = geometry::bounds(loaded.mesh).size().maxCoeff();
  if (kToolExtent.possible.contains(size)) return;
  throw InputError(fmt::format("{}: its largest side is {}, a tool's is 0.1 to 5000 mm{}", name,
                               in_unit(kToolExtent, size), unit_question(kToolExtent, size)));
}

}  // namespace palpate::mesh_io
