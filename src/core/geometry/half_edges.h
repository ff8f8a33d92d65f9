#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// A triangle corner: 3 t + k is corner k of triangle t. It also names the half-edge from there to the next
/// corner.
using Corner = std::uint32_t;

[[nodiscard]] inline Corner next_corner(Corner corner) { return corner - corner % 3 + (corner + 1) % 3; }
[[nodiscard]] inline Corner previous_corner(Corner corner) { return corner - corner % 3 + (corner + 2) % 3; }

/// One side of an edge. When sorted, the half-edges of an edge are adjacent.
struct HalfEdge {
  std::uint64_t edge;  // edge_key()
  Corner corner;
};

/// All half-edges, sorted by edge, then by corner.
[[nodiscard]] std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles);

/// Calls `visit(first, last)` with the range of half-edges of each edge.
template <typename Visit>
void for_each_edge(const std::vector<HalfEdge>& sides, const Visit& visit) {
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t end = first + 1;
    while (end < sides.size() && sides[end].edge == sides[first].edge) ++end;
    visit(sides.data() + first, sides.data() + end);
    first = end;
  }
}

/// [any] An undirected edge: smaller vertex << 32 | larger vertex.
[[nodiscard]] constexpr std::uint64_t edge_key(std::int32_t a, std::int32_t b) noexcept {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32U | static_cast<std::uint64_t>(std::max(a, b));
}

}  // namespace palpate::geometry
