#include "run/devices/gamepad.h"

#include <limits>

namespace palpate::devices {

haptics::DeviceState GamepadDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  if (input_.refresh()) wanted_ = input_.value();
  if (wanted_.connected && wanted_.velocity_D.allFinite()) {
    led_to_ = hand_.within_reach(led_to_ + period_ * wanted_.velocity_D);
  }
  // Unplugged, the tool stays where it is: a trigger that is let go by a cable must not pull it out.
  hand_.advance(wanted_.connected ? Vec3(led_to_ + wanted_.advance_D) : hand_.position(), wanted_.gripper);
  haptics::DeviceState sample = hand_.state();
  sample.buttons = wanted_.buttons;
  if (!wanted_.connected) sample.fault = haptics::Fault::kDevice;
  gone_.store(!wanted_.connected, std::memory_order_relaxed);
  return sample;
}

std::uint64_t GamepadDevice::last_tick(double /*rate_Hz*/) const noexcept {
  return std::numeric_limits<std::uint64_t>::max();
}

std::string GamepadDevice::trouble() const {
  if (!gone_.load(std::memory_order_relaxed)) return {};
  return "no gamepad is connected any more: plug it in, then reset the fault";
}

}  // namespace palpate::devices
