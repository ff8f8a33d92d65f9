// edge_neighbours(): which triangles share an edge.
#include <algorithm>
#include <string>

#include "core/base/index.h"
#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::geometry {
namespace {

std::string edge_words(std::int32_t low, std::int32_t high) {
  return "the edge of vertices " + std::to_string(low) + " and " + std::to_string(high);
}

/// One triangle's side of an edge, kept with the smaller of the edge's two vertices.
struct HalfEdge {
  std::int32_t high;  // the larger vertex
  std::int32_t side;  // three times the triangle's index, plus the edge

  bool operator<(const HalfEdge& other) const noexcept {
    return high != other.high ? high < other.high : side < other.side;
  }
};

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

/// All half edges, those of one smaller vertex side by side: of vertex v from start[v] to start[v + 1].
struct HalfEdges {
  std::vector<std::size_t> start;
  std::vector<HalfEdge> all;

  explicit HalfEdges(const TriangleMesh& mesh)
      : start(mesh.vertices.size() + 1, 0), all(3 * mesh.triangles.size()) {
    for (const Triangle& triangle : mesh.triangles) {
      for (std::size_t e = 0; e < 3; ++e) ++start[at(std::min(triangle[e], triangle[(e + 1) % 3])) + 1];
    }
    for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t e = 0; e < 3; ++e) {
        const std::int32_t a = mesh.triangles[t][e];
        const std::int32_t b = mesh.triangles[t][(e + 1) % 3];
        all[next[at(std::min(a, b))]++] = {std::max(a, b), static_cast<std::int32_t>(3 * t + e)};
      }
    }
  }
};

}  // namespace

std::vector<std::array<std::int32_t, 3>> edge_neighbours(const TriangleMesh& mesh) {
  check_corners(mesh);
  HalfEdges half_edges(mesh);
  std::vector<std::array<std::int32_t, 3>> neighbours(mesh.triangles.size(), {-1, -1, -1});
  const auto neighbour_over = [&](std::int32_t side) -> std::int32_t& {
    return neighbours[at(side / 3)][at(side % 3)];
  };
  for (std::size_t low = 0; low < mesh.vertices.size(); ++low) {
    const auto begin = half_edges.all.begin() + static_cast<std::ptrdiff_t>(half_edges.start[low]);
    const auto end = half_edges.all.begin() + static_cast<std::ptrdiff_t>(half_edges.start[low + 1]);
    std::sort(begin, end);
    for (auto first = begin; first != end;) {
      const auto last =
          std::find_if(first, end, [&](const HalfEdge& other) { return other.high != first->high; });
      const auto vertex = static_cast<std::int32_t>(low);
      if (last - first > 2) {
        throw InputError(edge_words(vertex, first->high) + " has " + std::to_string(last - first) +
                         " triangles: at most two can meet there");
      }
      if (last - first == 2) {
        const std::int32_t a = first->side;
        const std::int32_t b = (first + 1)->side;
        if (mesh.triangles[at(a / 3)][at(a % 3)] == mesh.triangles[at(b / 3)][at(b % 3)]) {
          throw InputError(edge_words(vertex, first->high) + " is run the same way by triangles " +
                           std::to_string(a / 3) + " and " + std::to_string(b / 3) +
                           ": one of them is turned over");
        }
        neighbour_over(a) = b / 3;
        neighbour_over(b) = a / 3;
      }
      first = last;
    }
  }
  return neighbours;
}

}  // namespace palpate::geometry
