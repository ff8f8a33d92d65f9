#include "core/base/rotation.h"

#include <Eigen/Geometry>

namespace palpate {

Quat rotation_between(const Vec3& from, const Vec3& to) noexcept { return Quat::FromTwoVectors(from, to); }

}  // namespace palpate
