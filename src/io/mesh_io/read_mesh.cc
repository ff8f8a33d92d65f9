#include "palpate/read_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>

#include <fmt/core.h>

#include "core/base/index.h"
#include "core/base/text.h"
#include "core/geometry/cell.h"
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

/// For each vertex the first one with equal coordinates. Vertices are sorted within the buckets of a hash, so
/// that a hostile file whose hashes all collide costs one sort.
std::vector<std::int32_t> first_at_position(const std::vector<Vec3>& vertices, std::size_t& places) {
  const int bits = std::max(1, static_cast<int>(std::bit_width(vertices.size())) - 2);
  const auto bucket_of = [bits](const Vec3& vertex) {
    const Vec3 p = vertex + Vec3::Zero();  // turns -0 into 0
    return geometry::ThreeWordsHash()(std::array{p.x(), p.y(), p.z()}) >> (64 - bits);
  };
  std::vector<std::uint32_t> ends((std::size_t{1} << bits) + 1, 0);
  for (const Vec3& vertex : vertices) ++ends[bucket_of(vertex) + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<std::int32_t> sorted(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v)
    sorted[ends[bucket_of(vertices[v])]++] = static_cast<std::int32_t>(v);
  std::vector<std::int32_t> first(vertices.size());
  std::size_t begin = 0;
  for (const std::uint32_t end : ends) {
    std::sort(sorted.data() + begin, sorted.data() + end, [&](std::int32_t a, std::int32_t b) {
      const Vec3& p = vertices[at(a)];
      const Vec3& q = vertices[at(b)];
      return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
    });
    for (; begin < end; ++begin) {
      const std::int32_t v = sorted[begin];
      const bool is_new = places == 0 || vertices[at(v)] != vertices[at(sorted[begin - 1])];
      places += is_new ? 1 : 0;
      first[at(v)] = is_new ? v : first[at(sorted[begin - 1])];
    }
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
  MeshFile file = open_mesh_file(path);
  if (!unit) throw InputError(to_text(path) + ": its unit is missing: must be mm, cm, m or in");
  return read_mesh(std::move(file), *unit);
}

LoadedMesh read_mesh(MeshFile file, LengthUnit unit) {
  const std::filesystem::path& path = file.path;
  ImportedMesh imported = import_mesh(file);
  if (imported.mesh.triangles.empty()) {
    throw InputError(to_text(path) + ": no triangles" +
                     (imported.repairs.empty() ? "" : " (" + joined(imported.repairs) + ")"));
  }
  std::string space = declared_space(file);
  std::string().swap(file.bytes);
  const std::size_t vertices = imported.mesh.vertices.size();
  Merged merged = merge_equal_vertices(std::move(imported.mesh));
  report_merged(file, vertices, merged, imported.repairs);
  if (merged.mesh.triangles.empty()) {
    throw InputError(fmt::format("{}: no triangles ({})", to_text(path), joined(imported.repairs)));
  }
  for (Vec3& vertex : merged.mesh.vertices) vertex *= metres_per(unit);
  LoadedMesh loaded{std::move(merged.mesh), {}, std::move(space)};
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
