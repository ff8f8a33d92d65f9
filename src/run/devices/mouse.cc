#include "run/devices/mouse.h"

#include <limits>

namespace palpate::devices {

haptics::DeviceState MouseDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  if (input_.refresh()) wanted_ = input_.value();
  hand_.advance(wanted_.target_D, wanted_.gripper);
  haptics::DeviceState sample = hand_.state();
  sample.buttons = wanted_.buttons;
  if (!wanted_.present) sample.fault = haptics::Fault::kDevice;
  gone_.store(!wanted_.present, std::memory_order_relaxed);
  return sample;
}

std::uint64_t MouseDevice::last_tick(double /*rate_Hz*/) const noexcept {
  return std::numeric_limits<std::uint64_t>::max();
}

std::string MouseDevice::trouble() const {
  return gone_.load(std::memory_order_relaxed) ? "the window whose mouse it was is gone" : "";
}

}  // namespace palpate::devices
