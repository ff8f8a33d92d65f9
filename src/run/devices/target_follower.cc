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
  for (int i = 0; i < steps; ++i) step(wanted, period_ / steps);
  if (!std::isfinite(gripper)) return;
  const double most = kMaxGripperSpeed * period_;
  gripper_ += std::clamp(std::clamp(gripper, 0.0, 1.0) - gripper_, -most, most);
}

haptics::DeviceState TargetFollower::state() const noexcept {
  haptics::DeviceState state;
  state.position_D = position_;
  state.orientation_D = orientation_;
  state.velocity_D = velocity_;
  state.gripper = gripper_;
  return state;
}

}  // namespace palpate::devices
