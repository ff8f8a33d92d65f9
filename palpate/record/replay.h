#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/haptics/loop.h"
#include "palpate/record/recording.h"

namespace palpate::record {

/// What a replay found.
struct ReplayResult {
  std::uint64_t rows_compared = 0;
  std::uint64_t rows_different = 0;
  std::string first_difference;  // in words: tick, hand, column, recorded and replayed value; empty: none
  std::uint64_t hash = 0;        // of the replayed rows' bits without tick_ns and late_ns
};

/// [setup] Feeds the recorded device samples through the tick again and compares every row bit for bit (all
/// columns but tick_ns and late_ns).
[[nodiscard]] ReplayResult replay(const Recording& recording);

/// [setup] Runs the recording again and returns the snapshots at `ticks` (ascending), for pictures.
[[nodiscard]] std::vector<haptics::Snapshot> snapshots_at(const Recording& recording,
                                                          const std::vector<std::uint64_t>& ticks);

}  // namespace palpate::record
