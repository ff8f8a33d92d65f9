#pragma once
#include <vector>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// [setup] Closed skin over closed rings of equally many points: quads (two triangles each) between
/// successive rings, a fan to a point beyond each end. Turned outwards when the rings run counter-clockwise
/// seen from the last one's side.
[[nodiscard]] TriangleMesh loft(const std::vector<std::vector<Vec3>>& rings, const Vec3& first_pole,
                                const Vec3& last_pole);

}  // namespace palpate::geometry
