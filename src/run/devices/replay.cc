#include "run/devices/replay.h"

#include <algorithm>

#include "core/haptics/simulation.h"
#include "palpate/error.h"

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
    if (row.hand == hand) samples.push_back(haptics::sample_of(row));
  }
  return samples;
}

}  // namespace palpate::devices
