#include "palpate/scripted_device.h"
#include "run/devices/path_end.h"

namespace palpate::devices {

haptics::DeviceState ScriptedDevice::read(std::uint64_t /*tick*/, double time) noexcept {
  const scene::PathRow row = path_.at(time);
  haptics::DeviceState state;
  state.position_D = row.position;
  state.orientation_D = row.orientation;
  state.velocity_D = path_.velocity_at(time);
  state.gripper = row.gripper;
  state.buttons = row.buttons;
  return state;
}

std::uint64_t ScriptedDevice::last_tick(double rate_Hz) const noexcept {
  return last_tick_of(path_, rate_Hz);
}

}  // namespace palpate::devices
