#pragma once
#include <algorithm>

#include "palpate/pose.h"

namespace palpate::contact {

/// [rt] Distance [m] of p from the segment from a to b. @param along position of the nearest point: 0 at a, 1
/// at b
[[nodiscard]] inline double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b,
                                                double& along) noexcept {
  const Vec3 edge = b - a;
  const double length_squared = edge.squaredNorm();
  along = length_squared > 0.0 ? std::clamp((p - a).dot(edge) / length_squared, 0.0, 1.0) : 0.0;
  return (p - (a + along * edge)).norm();
}

}  // namespace palpate::contact
