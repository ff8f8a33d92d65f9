// edge_neighbours(): which triangles share an edge.
#include <algorithm>
#include <string>

#include "palpate/base/error.h"
#include "palpate/geometry/mesh.h"

namespace palpate::geometry {
namespace {

std::uint64_t edge_key(std::int32_t a, std::int32_t b) {
  const auto low = static_cast<std::uint64_t>(std::min(a, b));
  const auto high = static_cast<std::uint64_t>(std::max(a, b));
  return (low << 32) | high;
}

struct HalfEdge {
  std::uint64_t key;
  std::int32_t triangle;
  std::int32_t edge;
  bool ascending;  // runs from the smaller to the larger vertex index
};

std::string edge_words(std::uint64_t key) {
  return "the edge of vertices " + std::to_string(key >> 32) + " and " + std::to_string(key & 0xffffffffU);
}

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> half_edges;
  half_edges.reserve(3 * mesh.triangles.size());
  const auto vertex_count = static_cast<std::int32_t>(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t from = mesh.triangles[t][e];
      const std::int32_t to = mesh.triangles[t][(e + 1) % 3];
      if (from < 0 || from >= vertex_count) {
        throw InputError("triangle " + std::to_string(t) + " names vertex " + std::to_string(from) +
                         ": the mesh has " + std::to_string(vertex_count));
      }
      if (from == to) throw InputError("triangle " + std::to_string(t) + " names one vertex twice");
      half_edges.push_back(
          {edge_key(from, to), static_cast<std::int32_t>(t), static_cast<std::int32_t>(e), from < to});
    }
  }
  std::sort(half_edges.begin(), half_edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.key != b.key ? a.key < b.key : a.triangle < b.triangle;
  });
  return half_edges;
}

}  // namespace

std::vector<std::array<std::int32_t, 3>> edge_neighbours(const TriangleMesh& mesh) {
  const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh);
  std::vector<std::array<std::int32_t, 3>> neighbours(mesh.triangles.size(), {-1, -1, -1});
  for (std::size_t first = 0; first < half_edges.size();) {
    std::size_t end = first + 1;
    while (end < half_edges.size() && half_edges[end].key == half_edges[first].key) ++end;
    if (end - first > 2) {
      throw InputError(edge_words(half_edges[first].key) + " has " + std::to_string(end - first) +
                       " triangles: at most two can meet there");
    }
    if (end - first == 2) {
      const HalfEdge& a = half_edges[first];
      const HalfEdge& b = half_edges[first + 1];
      if (a.ascending == b.ascending) {
        throw InputError(edge_words(a.key) + " is run the same way by triangles " +
                         std::to_string(a.triangle) + " and " + std::to_string(b.triangle) +
                         ": one of them is turned over");
      }
      neighbours[static_cast<std::size_t>(a.triangle)][static_cast<std::size_t>(a.edge)] = b.triangle;
      neighbours[static_cast<std::size_t>(b.triangle)][static_cast<std::size_t>(b.edge)] = a.triangle;
    }
    first = end;
  }
  return neighbours;
}

}  // namespace palpate::geometry
