#include "run/devices/target_follower.h"

#include <algorithm>
#include <cmath>

namespace palpate::devices {
namespace {

constexpr double kLongestStep = 2e-3;  // s; below 1/kNaturalFrequency, for stable steps

}  // namespace

TargetFollower::TargetFollower(const scene::PathRow& start, double period) noexcept
    : start_(start.position),
      orientation_(start.orientation),
      period_(period),
      position_(start.position),
      gripper_(start.gripper) {}

Vec3 TargetFollower::within_reach(const Vec3& position) const noexcept {
  const Vec3 way = position - start_;
  const double far = way.norm();
  return far > kMaxDistance ? Vec3(start_ + kMaxDistance / far * way) : position;
}

void TargetFollower::step(const Vec3& target, double period) noexcept {
  velocity_ += period * (kNaturalFrequency * kNaturalFrequency * (target - position_) -
                         2.0 * kNaturalFrequency * velocity_);
  const double speed = velocity_.norm();
  if (speed > kMaxSpeed) velocity_ *= kMaxSpeed / speed;
  position_ += period * velocity_;
}

void TargetFollower::advance(const Vec3& target, double gripper) noexcept {
  const Vec3 wanted = target.allFinite() ? within_reach(target) : position_;
  const int steps = std::max(1, static_cast<int>(std::ceil(period_ / kLongestStep)));
  for (int i = 0; i < steps; ++i) {
    step(wanted, period_ / steps);
    if (turns_) turn(period_ / steps);
  }
  if (!std::isfinite(gripper)) return;
  const double most = kMaxGripperSpeed * period_;
  gripper_ += std::clamp(std::clamp(gripper, 0.0, 1.0) - gripper_, -most, most);
}

void TargetFollower::hold_at(const Vec3& point) noexcept {
  if (point == held_ || !point.allFinite()) return;
  const Vec3 way = orientation_ * Vec3(point - held_);
  position_ += way;
  start_ += way;
  velocity_ += turning_.cross(way);
  held_ = point;
}

void TargetFollower::turn_to(const Quat& orientation) noexcept {
  if (!orientation.coeffs().allFinite() || std::abs(orientation.norm() - 1.0) > 1e-6) return;
  turned_to_ = orientation;
  turns_ = true;
}

void TargetFollower::turn(double period) noexcept {
  const Quat left = turned_to_ * orientation_.conjugate();
  const Vec3 error = (left.w() < 0.0 ? -2.0 : 2.0) * left.vec();  // 2 sin(a/2) approximates a
  turning_ += period * (kNaturalFrequency * kNaturalFrequency * error - 2.0 * kNaturalFrequency * turning_);
  const double speed = turning_.norm();
  if (speed > kMaxTurnSpeed) turning_ *= kMaxTurnSpeed / speed;
  const Vec3 half = 0.5 * period * turning_;
  orientation_ = (Quat(1.0, half.x(), half.y(), half.z()) * orientation_).normalized();
}

haptics::DeviceState TargetFollower::state() const noexcept {
  const Vec3 held = orientation_ * held_;
  haptics::DeviceState state;
  state.position_D = position_ - held;
  state.orientation_D = orientation_;
  state.velocity_D = velocity_ - turning_.cross(held);
  state.gripper = gripper_;
  return state;
}

}  // namespace palpate::devices
