#pragma once
#include <Eigen/Core>

#include "core/base/simd.h"

namespace palpate::deform {

/// Four vectors, one a lane.
struct Float4x3 {
  Float4 x, y, z;
};

inline Float4x3 lanes_of(const Eigen::Vector3f& v) noexcept {
  return {Float4(v.x()), Float4(v.y()), Float4(v.z())};
}
inline Float4x3 operator+(const Float4x3& a, const Float4x3& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Float4x3 operator-(const Float4x3& a, const Float4x3& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Float4x3 operator*(const Float4& s, const Float4x3& a) noexcept { return {s * a.x, s * a.y, s * a.z}; }
inline Float4 dot(const Float4x3& a, const Float4x3& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Float4x3 cross(const Float4x3& a, const Float4x3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Float4x3 select(const Float4Mask& mask, const Float4x3& a, const Float4x3& b) noexcept {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
/// Normalizes; a zero vector stays zero.
inline Float4x3 unit(const Float4x3& a) noexcept {
  return (Float4(1.0F) / sqrt(max(dot(a, a), Float4(1e-30F)))) * a;
}
/// A normal after a deformation with these columns of I + J, by the transposed adjugate; not unit.
inline Float4x3 turned_normal(const Float4x3& normal, const Float4x3& by_x, const Float4x3& by_y,
                              const Float4x3& by_z) noexcept {
  return normal.x * cross(by_y, by_z) + normal.y * cross(by_z, by_x) + normal.z * cross(by_x, by_y);
}

}  // namespace palpate::deform
