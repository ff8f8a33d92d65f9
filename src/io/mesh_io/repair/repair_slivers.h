#pragma once
#include <cstddef>

#include "io/mesh_io/repair/repair_surface.h"

namespace palpate::geometry {

/// A triangle lower than this share of its longest edge has no area but the rounding of 32-bit coordinates.
inline constexpr double kFlat = 2e-7;

[[nodiscard]] bool is_flat(const TriangleMesh& mesh, const Triangle& triangle);

[[nodiscard]] std::size_t count_flat(const TriangleMesh& mesh);

/// Takes triangles without area out of a closed, evenly turned surface: by shrinking an edge that has hardly
/// a length, or by turning the longest edge to the other diagonal; both leave the surface where it is, closed
/// and manifold. @return how many triangles without area went; those that neither way works for stay
std::size_t remove_slivers(WorkSurface& surface);

}  // namespace palpate::geometry
