#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// Triangles of one mesh that go through each other.
struct Crossings {
  std::vector<std::array<std::uint32_t, 2>> pairs;  // of triangles, the smaller first, sorted
  bool all = true;                                  // false: there were too many to look at them all
};

/// [setup] Finds all pairs of which an edge of one goes through the inside of the other by more than
/// rounding; neighbours with a common edge and parts that lie in one plane do not count. Looks at no more
/// than some ten million pairs whose boxes overlap, so that any mesh takes seconds.
[[nodiscard]] Crossings find_crossings(const TriangleMesh& mesh);

}  // namespace palpate::geometry
