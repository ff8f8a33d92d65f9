#pragma once
#include "palpate/geometry/mesh.h"

namespace palpate::geometry {

/// [setup] Ball of `radius` [m] about the origin: an icosahedron divided until it has at least `triangles`
/// (20, 80, 320, 1280, ...). Every vertex lies on the sphere.
[[nodiscard]] TriangleMesh make_ball(double radius, int triangles = 1280);

/// [setup] Box of `size` [m] about the origin, each side divided into squares of edge <= `longest` and those
/// into two triangles; closed.
[[nodiscard]] TriangleMesh make_box(const Vec3& size, double longest);

}  // namespace palpate::geometry
