#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "palpate/contact/preparation.h"
#include "palpate/haptics/snapshot.h"
#include "palpate/record/recording.h"

namespace palpate::record {

/// What a replay found.
struct ReplayResult {
  std::uint64_t rows_compared = 0;
  std::uint64_t rows_different = 0;
  std::string first_difference;  // in words: tick, hand, column, recorded and replayed value; empty: none
  std::uint64_t hash = 0;        // of the replayed rows' bits without tick_ns and late_ns
};

/// [setup] The first column, in words, whose bits differ (tick_ns and late_ns do not count); empty: none.
[[nodiscard]] std::string row_difference(const haptics::TickRow& recorded, const haptics::TickRow& replayed);

inline constexpr std::uint64_t kHashStart = 14695981039346656037ULL;

/// [any] 64-bit FNV-1a (Fowler, Noll, Vo) of the rows' bits without tick_ns and late_ns, going on from
/// `hash`, that of the rows before.
[[nodiscard]] std::uint64_t hash_rows(std::span<const haptics::TickRow> rows,
                                      std::uint64_t hash = kHashStart) noexcept;

/// [setup] Feeds the recorded device samples through the tick again and compares every row bit for bit (all
/// columns but tick_ns and late_ns). @throws InputError when rows are missing in the middle or the scene is
/// bad. @param how as for contact::World
[[nodiscard]] ReplayResult replay(const Recording& recording, const Progress& progress = {},
                                  const contact::Preparation& how = {});

/// [setup] Runs the recording again and returns the snapshots at `ticks` (ascending), for pictures; their
/// taken_ns is the time since tick 0. @throws InputError as replay(), or when a tick is past the end or out
/// of order.
[[nodiscard]] std::vector<haptics::Snapshot> snapshots_at(const Recording& recording,
                                                          const std::vector<std::uint64_t>& ticks,
                                                          const contact::Preparation& how = {});

}  // namespace palpate::record
