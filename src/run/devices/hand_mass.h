#pragma once
#include "palpate/pose.h"

namespace palpate::devices {

/// Dynamics of a device and the hand that holds it.
struct HandMassParameters {
  double mass = 0.25;           // kg, device and hand
  double damping = 1.5;         // N s/m, device against its base
  double friction = 0.05;       // N, Coulomb friction of the device, static and kinetic
  double grip_stiffness = 0.0;  // N/m, towards the hand's target
  double grip_damping = 0.0;    // N s/m
};

/// A point mass under the device's force F. A spring and damper (grip K, B) pull it towards a target; viscous
/// damping b and Coulomb friction resist. Implicit Euler steps h are stable for any stiffness, damping and
/// friction: v' = (m/h v + F + K (x_t' - x) + B v_t) / (m/h + b + B + K h). Friction shortens the norm of v'.
/// If friction is at least the net force, the mass sticks: v' = 0 exactly. Only basic arithmetic and square
/// roots are used, so results are bit-identical on all processors. The implicit step adds the damping K h /
/// 2: 0.013 N s/m with a firm grip.
class HandMass final {
 public:
  static constexpr double kLongestStep = 50e-6;  // s

  /// [setup] At rest at `start` [m].
  HandMass(const HandMassParameters& parameters, const Vec3& start) noexcept
      : parameters_(parameters), position_(start) {}

  /// [rt] One period [s] in equal steps of at most kLongestStep under a constant force [N], while the target
  /// moves linearly `from` .. `to` [m].
  void advance(const Vec3& from, const Vec3& to, const Vec3& force, double period) noexcept;

  [[nodiscard]] const Vec3& position() const noexcept { return position_; }
  [[nodiscard]] const Vec3& velocity() const noexcept { return velocity_; }
  /// [rt] Integral of the device's force along the exact path of the hand [J]: the net energy from device to
  /// hand.
  [[nodiscard]] double work_of_force() const noexcept { return work_; }

 private:
  HandMassParameters parameters_;
  Vec3 position_;
  Vec3 velocity_ = Vec3::Zero();
  double work_ = 0.0;
};

}  // namespace palpate::devices
