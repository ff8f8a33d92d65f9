#include "core/geometry/half_edges.h"

#include <numeric>

namespace palpate::geometry {

std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles) {
  // Bucket sort by the smaller vertex, so that each bucket holds only a few.
  std::size_t vertices = 0;
  for (const Triangle& t : triangles)
    vertices = std::max(vertices, static_cast<std::size_t>(*std::max_element(t.begin(), t.end())) + 1);
  const auto side = [&](Corner c) {
    return HalfEdge{edge_key(triangles[c / 3][c % 3], triangles[c / 3][(c + 1) % 3]), c};
  };
  const auto corners = static_cast<Corner>(3 * triangles.size());
  std::vector<std::size_t> begin(vertices + 1, 0);
  for (Corner c = 0; c < corners; ++c) ++begin[(side(c).edge >> 32) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<HalfEdge> sides(corners);
  std::vector<std::size_t> next = begin;
  for (Corner c = 0; c < corners; ++c) {
    const HalfEdge one = side(c);
    sides[next[one.edge >> 32]++] = one;
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    std::sort(sides.begin() + static_cast<std::ptrdiff_t>(begin[v]),
              sides.begin() + static_cast<std::ptrdiff_t>(begin[v + 1]),
              [](const HalfEdge& a, const HalfEdge& b) {
                return a.edge != b.edge ? a.edge < b.edge : a.corner < b.corner;
              });
  }
  return sides;
}

}  // namespace palpate::geometry
