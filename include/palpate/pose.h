#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

/// Rigid transform from the inner to the outer frame: x_outer = rotation * x_inner + position [m].
struct Pose {
  Quat rotation = Quat::Identity();
  Vec3 position = Vec3::Zero();

  bool operator==(const Pose&) const = default;
  [[nodiscard]] Vec3 operator*(const Vec3& p) const noexcept { return rotation * p + position; }
  [[nodiscard]] Pose operator*(const Pose& inner) const noexcept {
    return {rotation * inner.rotation, rotation * inner.position + position};
  }
  [[nodiscard]] Pose inverse() const noexcept {
    const Quat back = rotation.conjugate();
    return {back, -(back * position)};
  }
};

/// [setup] Rotation from extrinsic angles [deg] about x, then y, then z.
[[nodiscard]] Quat rotation_from_degrees(const Vec3& degrees);

/// [rt] Rotation by `angle` [rad] about the unit vector `axis`, right-handed.
[[nodiscard]] Quat rotation_about(const Vec3& axis, double angle) noexcept;

/// [rt] Spherical linear interpolation on the shorter arc from a (u = 0) to b (u = 1), at constant speed.
[[nodiscard]] Quat slerp(const Quat& a, const Quat& b, double u) noexcept;

}  // namespace palpate
