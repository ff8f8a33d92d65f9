#pragma once
#include <algorithm>
#include <cstddef>
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

/// [setup] Numbers edges in the order in which they are first asked for. A hash table with linear probing,
/// several times as fast as std::unordered_map.
class EdgeNumbers final {
 public:
  /// The number of the edge with this edge_key().
  std::int32_t operator[](std::uint64_t edge) {
    if (2 * edges_.size() >= slots_.size()) grow();
    std::int32_t& slot = slots_[slot_of(edge)];
    if (slot < 0) {
      slot = static_cast<std::int32_t>(edges_.size());
      edges_.push_back(edge);
    }
    return slot;
  }

 private:
  [[nodiscard]] std::size_t slot_of(std::uint64_t edge) const noexcept {
    const std::size_t last = slots_.size() - 1;  // the size is a power of two
    std::size_t slot = static_cast<std::size_t>(edge * 0x9e3779b97f4a7c15U >> 32U) & last;
    while (slots_[slot] >= 0 && edges_[static_cast<std::size_t>(slots_[slot])] != edge)
      slot = (slot + 1) & last;
    return slot;
  }
  void grow() {
    slots_.assign(std::max<std::size_t>(64, 4 * slots_.size()), -1);
    std::int32_t number = 0;
    for (const std::uint64_t edge : edges_) slots_[slot_of(edge)] = number++;
  }

  std::vector<std::uint64_t> edges_;
  std::vector<std::int32_t> slots_;  // number of an edge; -1: free
};

}  // namespace palpate::geometry
