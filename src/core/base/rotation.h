#pragma once
#include "palpate/pose.h"

namespace palpate {

/// [any] The shortest rotation that turns `from` into the direction of `to`. Of opposite directions, one of
/// the half turns. (Eigen's function, which takes seconds to compile wherever it is used.)
[[nodiscard]] Quat rotation_between(const Vec3& from, const Vec3& to) noexcept;

}  // namespace palpate
