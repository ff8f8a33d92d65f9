#pragma once
// A recording whose replay is a fault.
#include <cstdint>
#include <limits>
#include <string>

#include "io/record/recorder.h"
#include "palpate/scene.h"

namespace palpate::tests {

/// Records a hand at rest above the gallbladder for `ticks` ticks. Its sample `broken_tick` is NaN.
inline void record_broken_hand(const std::string& file, std::uint64_t ticks, std::uint64_t broken_tick) {
  record::Recorder recorder(file, scene::load(scene::Overrides{}), true);
  recorder.on_start(1);
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    haptics::TickRow row;
    row.tick = tick;
    row.time = 1e-3 * static_cast<double>(tick);
    row.device = {0.0, 0.0, 0.2};
    row.device_q = {1.0, 0.0, 0.0, 0.0};
    if (tick == broken_tick) row.device[1] = std::numeric_limits<double>::quiet_NaN();
    recorder.on_row(row);
  }
  recorder.finish({});
}

}  // namespace palpate::tests
