#pragma once
#include "palpate/device.h"
#include "palpate/pose.h"
#include "palpate/tool_path.h"

namespace palpate::devices {

/// Turns where a pointer jumps to into the way of a calm hand: a critically damped second-order follower
/// whose speed is limited, so that the rules of contact, which hold for hands, hold for a mouse. Own
/// arithmetic and square roots only. The orientation stays that of the start.
class SteadyHand final {
 public:
  static constexpr double kSwiftness = 40.0;      // 1/s: a step is all but done after 0.15 s
  static constexpr double kFastest = 0.1;         // m/s
  static constexpr double kFastestGripper = 4.0;  // 1/s: from open to closed in 0.25 s
  static constexpr double kReach = 0.15;          // m, from the start: targets beyond are drawn in to it

  /// [setup] At rest. @param period s
  SteadyHand(const scene::PathRow& start, double period) noexcept;

  /// [rt] The nearest place to `position` within reach of the start.
  [[nodiscard]] Vec3 within_reach(const Vec3& position) const noexcept;
  /// [rt] One period towards a target [m] and an opening (0 closed .. 1 open). A target that is not finite is
  /// left out.
  void advance(const Vec3& target, double gripper) noexcept;

  /// [rt] Pose, velocity and gripper as a device gives them; no buttons, no fault.
  [[nodiscard]] haptics::DeviceState state() const noexcept;
  [[nodiscard]] const Vec3& position() const noexcept { return position_; }
  [[nodiscard]] const Vec3& velocity() const noexcept { return velocity_; }
  [[nodiscard]] const Quat& orientation() const noexcept { return orientation_; }
  [[nodiscard]] double gripper() const noexcept { return gripper_; }
  [[nodiscard]] const Vec3& start() const noexcept { return start_; }

 private:
  void step(const Vec3& target, double period) noexcept;

  Vec3 start_;
  Quat orientation_;
  double period_;
  Vec3 position_;
  Vec3 velocity_ = Vec3::Zero();
  double gripper_;
};

}  // namespace palpate::devices
