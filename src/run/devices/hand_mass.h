#pragma once
#include "palpate/pose.h"

namespace palpate::devices {

/// What moves and what holds it.
struct HandMassParameters {
  double mass = 0.25;           // kg, of device and hand
  double damping = 1.5;         // N s/m, of the device, against its base
  double friction = 0.05;       // N, Coulomb, of the device; static and sliding alike
  double grip_stiffness = 0.0;  // N/m, from the hand's target
  double grip_damping = 0.0;    // N s/m
};

/// A point mass that a spring and damper pull along a target, against viscous damping and Coulomb friction,
/// and that the device's force moves. Its steps are implicit, so that no stiffness, damping or friction makes
/// them unstable by itself: v' = (m/h v + F + K (x_t' - x) + B v_t) / (m/h + b + B + K h), its norm shortened
/// by the friction's share; where friction is at least the whole of that force the mass sticks: v' = 0,
/// exactly. Own arithmetic and square roots only, so the bits are the same everywhere. What the implicit step
/// damps beyond B and b is K h / 2: 0.013 N s/m with a firm grip.
class HandMass final {
 public:
  static constexpr double kLongestStep = 50e-6;  // s

  /// [setup] At rest at `start` [m].
  HandMass(const HandMassParameters& parameters, const Vec3& start) noexcept
      : parameters_(parameters), position_(start) {}

  /// [rt] One period [s] in equal steps of at most kLongestStep under a constant force [N], while the target
  /// goes straight `from` .. `to` [m].
  void advance(const Vec3& from, const Vec3& to, const Vec3& force, double period) noexcept;

  [[nodiscard]] const Vec3& position() const noexcept { return position_; }
  [[nodiscard]] const Vec3& velocity() const noexcept { return velocity_; }
  /// [rt] Integral of the device's force along the hand's true way [J]: what the device has given to the
  /// hand, less what it took.
  [[nodiscard]] double work_of_force() const noexcept { return work_; }

 private:
  HandMassParameters parameters_;
  Vec3 position_;
  Vec3 velocity_ = Vec3::Zero();
  double work_ = 0.0;
};

}  // namespace palpate::devices
