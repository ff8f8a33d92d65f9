#include "palpate/pose.h"

#include <cmath>

#include "core/base/portable_math.h"

namespace palpate {

Quat rotation_about(const Vec3& axis, double angle) noexcept {
  const auto [sine, cosine] = portable::sin_cos(0.5 * angle);
  return {cosine, sine * axis.x(), sine * axis.y(), sine * axis.z()};
}

Quat rotation_from_degrees(const Vec3& degrees) {
  constexpr double kRadiansPerDegree = portable::kPi / 180.0;
  const Vec3 angles = degrees * kRadiansPerDegree;
  return rotation_about(Vec3::UnitZ(), angles.z()) * rotation_about(Vec3::UnitY(), angles.y()) *
         rotation_about(Vec3::UnitX(), angles.x());
}

Quat slerp(const Quat& a, const Quat& b, double u) noexcept {
  double cosine = a.w() * b.w() + a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
  const double side = cosine < 0.0 ? -1.0 : 1.0;
  cosine *= side;
  double weight_a = 1.0 - u;
  double weight_b = u;
  constexpr double kNearlyEqual = 1.0 - 1e-9;  // below this angle chord and arc agree to 1e-10
  if (cosine < kNearlyEqual) {
    const double angle = portable::acos(cosine);
    const double sine = std::sqrt(1.0 - cosine * cosine);
    weight_a = portable::sin_cos((1.0 - u) * angle).sine / sine;
    weight_b = portable::sin_cos(u * angle).sine / sine;
  }
  weight_b *= side;
  Quat mixed(weight_a * a.w() + weight_b * b.w(), weight_a * a.x() + weight_b * b.x(),
             weight_a * a.y() + weight_b * b.y(), weight_a * a.z() + weight_b * b.z());
  mixed.normalize();
  return mixed;
}

}  // namespace palpate
