// edge_neighbours(): the triangles that share edges.
#include <algorithm>
#include <string>

#include "core/geometry/half_edges.h"
#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::geometry {
namespace {

std::string edge_text(std::int32_t a, std::int32_t b) {
  return "the edge of vertices " + std::to_string(std::min(a, b)) + " and " + std::to_string(std::max(a, b));
}

void check_corners(const TriangleMesh& mesh) {
  const auto vertex_count = static_cast<std::int32_t>(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t from = mesh.triangles[t][e];
      if (from < 0 || from >= vertex_count) {
        throw InputError("triangle " + std::to_string(t) + " names vertex " + std::to_string(from) +
                         ": the mesh has " + std::to_string(vertex_count));
      }
      if (from == mesh.triangles[t][(e + 1) % 3]) {
        throw InputError("triangle " + std::to_string(t) + " names one vertex twice");
      }
    }
  }
}

}  // namespace

std::vector<std::array<std::int32_t, 3>> edge_neighbours(const TriangleMesh& mesh) {
  check_corners(mesh);
  std::vector<std::array<std::int32_t, 3>> neighbours(mesh.triangles.size(), {-1, -1, -1});
  for_each_edge(sorted_half_edges(mesh.triangles), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first == 1) return;
    const Corner a = first[0].corner;
    const Corner b = first[1].corner;
    const auto from = [&](Corner corner) { return mesh.triangles[corner / 3][corner % 3]; };
    if (last - first > 2) {
      throw InputError(edge_text(from(a), from(next_corner(a))) + " has " + std::to_string(last - first) +
                       " triangles: at most two can meet there");
    }
    if (from(a) == from(b)) {
      throw InputError(edge_text(from(a), from(next_corner(a))) + " has the same direction in triangles " +
                       std::to_string(a / 3) + " and " + std::to_string(b / 3) + ": one of them is inverted");
    }
    neighbours[a / 3][a % 3] = static_cast<std::int32_t>(b / 3);
    neighbours[b / 3][b % 3] = static_cast<std::int32_t>(a / 3);
  });
  return neighbours;
}

}  // namespace palpate::geometry
