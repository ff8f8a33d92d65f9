#include "palpate/devices/replay.h"

#include <algorithm>

#include "palpate/base/error.h"

namespace palpate::devices {

ReplayDevice::ReplayDevice(std::vector<haptics::DeviceState> samples) : samples_(std::move(samples)) {
  if (samples_.empty()) throw InputError("a replayed recording must have at least one tick");
}

haptics::DeviceState ReplayDevice::read(std::uint64_t tick, double /*time*/) noexcept {
  return samples_[std::min<std::uint64_t>(tick, samples_.size() - 1)];
}

std::uint64_t ReplayDevice::last_tick(double /*rate_Hz*/) const noexcept { return samples_.size(); }

std::vector<haptics::DeviceState> samples_of_hand(const std::vector<haptics::TickRow>& rows,
                                                  std::size_t hand) {
  std::vector<haptics::DeviceState> samples;
  for (const haptics::TickRow& row : rows) {
    if (row.hand != hand) continue;
    haptics::DeviceState state;
    state.position_D = {row.device[0], row.device[1], row.device[2]};
    state.orientation_D = Quat(row.device_q[0], row.device_q[1], row.device_q[2], row.device_q[3]);
    state.velocity_D = {row.device_velocity[0], row.device_velocity[1], row.device_velocity[2]};
    state.gripper = row.device_gripper;
    state.buttons = row.buttons;
    state.valid = row.device_valid != 0;
    samples.push_back(state);
  }
  return samples;
}

}  // namespace palpate::devices
