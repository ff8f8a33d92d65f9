#pragma once
#include <cstddef>

#include "io/mesh_io/repair/repair_surface.h"

namespace palpate::mesh_io {

/// A triangle whose height is below this fraction of its longest edge is a sliver: its area is rounding of
/// 32-bit coordinates.
inline constexpr double kFlat = 2e-7;

[[nodiscard]] bool is_sliver(const geometry::TriangleMesh& mesh, const geometry::Triangle& triangle);

[[nodiscard]] std::size_t count_slivers(const geometry::TriangleMesh& mesh);

/// Removes slivers from a closed, consistently oriented surface: collapses very short edges, or flips the
/// longest edge. The surface keeps its shape and stays closed and manifold. @return the number of removed
/// slivers; slivers that neither operation removes stay
std::size_t remove_slivers(WorkSurface& surface);

}  // namespace palpate::mesh_io
