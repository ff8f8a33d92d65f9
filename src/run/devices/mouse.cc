#include "run/devices/mouse.h"

namespace palpate::devices {

haptics::DeviceState MouseDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  const MouseInput& input = wanted();
  hand_.hold_at(input.held);
  if (input.turns) hand_.turn_to(input.orientation_D);
  hand_.advance(input.target_D, input.gripper);
  return sample(input.present);
}

std::string MouseDevice::last_error() const { return gone() ? "the window whose mouse it was is gone" : ""; }

}  // namespace palpate::devices
