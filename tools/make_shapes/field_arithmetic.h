#pragma once
#include <cmath>

#include "core/base/portable_math.h"

#include "tools/make_shapes/implicit.h"

/// Arithmetic on field values with their gradients (forward-mode differentiation), so that a solid can be
/// written as a formula.
namespace palpate::geometry {

/// A coordinate of the point, or another linear function of it.
[[nodiscard]] inline FieldValue coordinate(const Vec3& p, const Vec3& along) noexcept {
  return {p.dot(along), along};
}

[[nodiscard]] inline FieldValue operator+(const FieldValue& a, const FieldValue& b) noexcept {
  return {a.value + b.value, a.gradient + b.gradient};
}
[[nodiscard]] inline FieldValue operator-(const FieldValue& a, const FieldValue& b) noexcept {
  return {a.value - b.value, a.gradient - b.gradient};
}
[[nodiscard]] inline FieldValue operator*(const FieldValue& a, const FieldValue& b) noexcept {
  return {a.value * b.value, a.value * b.gradient + b.value * a.gradient};
}
[[nodiscard]] inline FieldValue operator+(const FieldValue& a, double b) noexcept {
  return {a.value + b, a.gradient};
}
[[nodiscard]] inline FieldValue operator*(double a, const FieldValue& b) noexcept {
  return {a * b.value, a * b.gradient};
}
[[nodiscard]] inline FieldValue operator-(const FieldValue& a) noexcept { return {-a.value, -a.gradient}; }

/// Absolute value; its gradient at 0 is that of +a.
[[nodiscard]] inline FieldValue magnitude(const FieldValue& a) noexcept { return a.value < 0.0 ? -a : a; }

/// Length of the vector (a, b); gradient 0 at the zero vector.
[[nodiscard]] inline FieldValue length_of(const FieldValue& a, const FieldValue& b) noexcept {
  const double length = std::sqrt(a.value * a.value + b.value * b.value);
  if (length <= 0.0) return {};
  return {length, (a.value * a.gradient + b.value * b.gradient) / length};
}

struct SinCosField {
  FieldValue sine;
  FieldValue cosine;
};
/// Sine and cosine of an angle [rad].
[[nodiscard]] inline SinCosField sin_cos_of(const FieldValue& angle) noexcept {
  const portable::SinCos at = portable::sin_cos(angle.value);
  return {{at.sine, at.cosine * angle.gradient}, {at.cosine, -at.sine * angle.gradient}};
}

/// Angle [rad], 0..pi, of the vector (x, y) from the first axis; requires y >= 0.
[[nodiscard]] inline FieldValue angle_of(const FieldValue& x, const FieldValue& y) noexcept {
  const double length2 = x.value * x.value + y.value * y.value;
  if (length2 <= 0.0) return {};
  return {portable::acos(x.value / std::sqrt(length2)),
          (x.value * y.gradient - y.value * x.gradient) / length2};
}

/// 0 up to `from`, 1 beyond `to`, with continuous slope and curvature.
[[nodiscard]] inline FieldValue rise(const FieldValue& a, double from, double to) noexcept {
  const double t = (a.value - from) / (to - from);
  if (t <= 0.0) return {};
  if (t >= 1.0) return {1.0, Vec3::Zero()};
  const double slope = 30.0 * t * t * (t - 1.0) * (t - 1.0) / (to - from);
  return {t * t * t * (10.0 + t * (6.0 * t - 15.0)), slope * a.gradient};
}

/// 1 where `a` is 0, 0 farther than `half` from 0, with continuous slope and curvature.
[[nodiscard]] inline FieldValue bump(const FieldValue& a, double half) noexcept {
  const FieldValue t = (1.0 / half) * a;
  if (t.value * t.value >= 1.0) return {};
  const FieldValue rest = -(t * t) + 1.0;
  return rest * rest * rest;
}

}  // namespace palpate::geometry
