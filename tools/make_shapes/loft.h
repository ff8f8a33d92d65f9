#pragma once
#include <vector>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// [setup] A closed surface over closed rings of equally many points: quads (two triangles each) between
/// successive rings, and a fan to a point beyond each end. It is oriented outwards when the rings are
/// counter-clockwise seen from the last one's side.
[[nodiscard]] TriangleMesh loft(const std::vector<std::vector<Vec3>>& rings, const Vec3& first_pole,
                                const Vec3& last_pole);

}  // namespace palpate::geometry
