#pragma once
#include "palpate/device.h"
#include "palpate/pose.h"
#include "palpate/tool_path.h"

namespace palpate::devices {

/// Filters the jumps of a pointer into smooth hand motion: a critically damped second-order filter with a
/// speed limit, so that a mouse moves no faster than the contact model assumes of hands. Only basic
/// arithmetic and square roots are used, so results are bit-identical on all processors. The orientation
/// stays constant unless turn_to() is called; it then follows by the same filter.
class TargetFollower final {
 public:
  static constexpr double kNaturalFrequency =
      40.0;                                 // 1/s, natural frequency: a step settles within about 0.15 s
  static constexpr double kMaxSpeed = 0.1;  // m/s
  static constexpr double kMaxGripperSpeed = 4.0;  // 1/s: from open to closed in 0.25 s
  static constexpr double kMaxDistance = 0.15;     // m, largest distance of a target from the start
  static constexpr double kMaxTurnSpeed = 2.0;     // rad/s

  /// [setup] At rest. @param period s
  TargetFollower(const scene::PathRow& start, double period) noexcept;

  /// [rt] The point nearest to `position` within kMaxDistance of the start.
  [[nodiscard]] Vec3 within_reach(const Vec3& position) const noexcept;
  /// [rt] Advances one period towards a target [m] and a gripper opening (0 closed .. 1 open). Ignores a
  /// target that is not finite.
  void advance(const Vec3& target, double gripper) noexcept;
  /// [rt] Moves and turns about this point of the tool from now on: targets are places of it. At first it is
  /// the handle's origin. @param point handle frame, in the device's lengths [m]
  void hold_at(const Vec3& point) noexcept;
  /// [rt] Turns to an orientation during every advance(). Ignores one that is not finite or not of unit
  /// length.
  void turn_to(const Quat& orientation) noexcept;

  /// [rt] Pose, velocity and gripper as a device gives them; no buttons, no fault.
  [[nodiscard]] haptics::DeviceState state() const noexcept;
  /// [rt] Position and velocity of the held point.
  [[nodiscard]] const Vec3& position() const noexcept { return position_; }
  [[nodiscard]] const Vec3& velocity() const noexcept { return velocity_; }
  [[nodiscard]] const Quat& orientation() const noexcept { return orientation_; }
  [[nodiscard]] double gripper() const noexcept { return gripper_; }
  [[nodiscard]] const Vec3& start() const noexcept { return start_; }

 private:
  void step(const Vec3& target, double period) noexcept;
  void turn(double period) noexcept;

  Vec3 start_;
  Quat orientation_;
  double period_;
  Vec3 position_;
  Vec3 velocity_ = Vec3::Zero();
  double gripper_;
  Vec3 held_ = Vec3::Zero();  // handle frame
  bool turns_ = false;
  Quat turned_to_ = Quat::Identity();
  Vec3 turning_ = Vec3::Zero();  // angular velocity [rad/s], device frame
};

}  // namespace palpate::devices
