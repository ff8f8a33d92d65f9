#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/haptics/loop.h"
#include "palpate/haptics/tick_row.h"
#include "palpate/scene/setup.h"

namespace palpate::record {

/// What a recording tells about the run itself.
struct RunFacts {
  std::string version;  // of palpate
  std::string compiler;
  std::string machine;               // processor, kernel
  std::int64_t started_unix_ns = 0;  // wall time of tick 0; 0 when no tick was due yet
  bool offline = false;
  bool complete = false;  // closed in good order (false: cut off)
  // The loop's own account, zero when cut off:
  std::uint64_t missed_deadlines = 0;
  std::int64_t longest_gap_ns = 0;
  bool realtime_priority = false;
  bool memory_locked = false;
};

/// A whole recording in memory.
struct Recording {
  scene::Setup setup;
  RunFacts facts;
  std::vector<haptics::TickRow> rows;  // by tick, then hand
};

/// [setup] Reads a recording, also one that was cut off (kill -9, full disk). @throws InputError naming the
/// file.
[[nodiscard]] Recording read_recording(const std::filesystem::path& file);

/// [setup] Makes a recording that was cut off open in every HDF5 tool. @return rows kept. @throws InputError.
std::size_t repair_recording(const std::filesystem::path& file);

/// [setup] Writes the ticks as CSV with the contract's columns, numbers in shortest round-trip form.
void export_csv(const Recording& recording, const std::filesystem::path& file);

}  // namespace palpate::record
