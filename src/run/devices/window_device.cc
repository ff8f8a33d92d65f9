#include "run/devices/window_device.h"

namespace palpate::devices {

haptics::DeviceState MouseDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  const MouseInput& input = wanted();
  hand_.hold_at(input.held);
  if (input.turns) hand_.turn_to(input.orientation_D);
  hand_.advance(input.target_D, input.gripper);
  return sample(input.present);
}

std::string MouseDevice::last_error() const { return gone() ? "the window whose mouse it was is gone" : ""; }

haptics::DeviceState GamepadDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  const GamepadInput& input = wanted();
  if (input.connected && input.velocity_D.allFinite()) {
    led_to_ = hand_.within_reach(led_to_ + period_ * input.velocity_D);
  }
  // A disconnected gamepad leaves the tool at its position. A lost trigger signal must not pull the tool out.
  hand_.advance(input.connected ? Vec3(led_to_ + input.advance_D) : hand_.position(), input.gripper);
  return sample(input.connected);
}

std::string GamepadDevice::last_error() const {
  return gone() ? "no gamepad is connected any more: plug it in, then reset the fault" : "";
}

}  // namespace palpate::devices
