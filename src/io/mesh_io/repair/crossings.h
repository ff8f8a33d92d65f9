#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::mesh_io {

/// Triangles of one mesh that intersect each other.
struct Crossings {
  std::vector<std::array<std::uint32_t, 2>> pairs;  // of triangles, the smaller first, sorted
  bool all = true;                                  // false: too many candidate pairs to test all
};

/// [setup] Finds all pairs of triangles that have a piece of a line in common, longer than rounding, along
/// which each passes through the plane of the other [Moeller 1997]. Neighbours with a common edge, touches
/// and coplanar parts do not count. Tests at most some ten million pairs with overlapping boxes, so that any
/// mesh takes seconds.
[[nodiscard]] Crossings find_crossings(const geometry::TriangleMesh& mesh);

}  // namespace palpate::mesh_io
