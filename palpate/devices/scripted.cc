#include "palpate/devices/scripted.h"

#include <cmath>

namespace palpate::devices {

haptics::DeviceState ScriptedDevice::read(std::uint64_t /*tick*/, double time) noexcept {
  const scene::PathRow row = path_.at(time);
  haptics::DeviceState state;
  state.position_D = row.position;
  state.orientation_D = row.orientation;
  state.velocity_D = path_.velocity_at(time);
  state.gripper = row.gripper;
  return state;
}

std::uint64_t ScriptedDevice::last_tick(double rate_Hz) const noexcept {
  constexpr double kLargest = 9e18;  // below 2^63
  const double ticks = std::floor((path_.end_time() + kRest) * rate_Hz + 0.5);
  if (!(ticks > 0.0)) return 0;
  return ticks < kLargest ? static_cast<std::uint64_t>(ticks) : ~std::uint64_t{0};
}

}  // namespace palpate::devices
