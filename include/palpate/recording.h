#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "palpate/preparation.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"
#include "palpate/tick_row.h"

namespace palpate::record {

/// Percentiles and maximum of a measured time; zero when unknown.
struct TimeFigures {
  std::int64_t p50_ns = 0;
  std::int64_t p99_ns = 0;
  std::int64_t p999_ns = 0;
  std::int64_t max_ns = 0;
};

/// Counts of a measured time: buckets at most 0.1 % wide, those that are not empty, ascending.
using TimeHistogram = std::vector<haptics::Histogram::Bucket>;

/// How far a long operation is, 0..1; may be empty.
using Progress = std::function<void(double)>;

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
  bool polled = false;           // between ticks; else the loop slept
  TimeFigures tick_time;         // the tick's own computing time
  TimeFigures lateness;          // how late ticks began
  TimeHistogram tick_histogram;  // of the same; also of offline runs, whose rows hold no times
  TimeHistogram late_histogram;
  std::uint64_t watchdog_stops = 0;
  std::vector<std::string> remarks;  // what the loop was not granted and what the watchdog did, in words
};

/// A whole recording in memory.
struct Recording {
  scene::Setup setup;
  RunFacts facts;
  std::vector<haptics::TickRow> rows;          // by tick, then hand
  std::vector<haptics::LiveChange> changes{};  // to tissue and noise, by tick; at most one a tick
};

/// [setup] Reads a recording, also one that was cut off (kill -9, full disk, a copy that broke off) or is
/// still being written: rows up to the last whole tick before the damage. @throws InputError naming the file
/// and what is missing or wrong.
[[nodiscard]] Recording read_recording(const std::filesystem::path& file, const Progress& progress = {});

/// What repair_recording() did.
struct RepairResult {
  std::uint64_t rows = 0;    // in the file now
  bool was_damaged = false;  // false: nothing was wrong and the file is untouched
};

/// [setup] Makes a recording that was cut off open in every HDF5 tool: writes what can be read into a new
/// file beside it and puts that in its place. @throws InputError, with the old file as it was, when it is no
/// recording, is still being written, or the new file cannot be made.
RepairResult repair_recording(const std::filesystem::path& file, const Progress& progress = {});

/// [setup] Writes the ticks as CSV with the contract's columns, numbers in shortest round-trip form;
/// then the device's own sample (device_*). phase is approach, press or pull; fault is 0, not-finite or
/// device. @throws InputError when the file cannot be written, naming it.
void export_csv(const Recording& recording, const std::filesystem::path& file, const Progress& progress = {});

/// [any] Where the changes of a recording go that is exported to `csv`: beside it, as NAME-changes.csv.
[[nodiscard]] std::filesystem::path changes_csv_beside(const std::filesystem::path& csv);

/// [setup] Writes the changes to tissue and noise as CSV, one line a change: all that is in force from its
/// tick on. what is tissue or noise, law is layered or smooth. @throws InputError as export_csv().
void export_changes_csv(const Recording& recording, const std::filesystem::path& file);

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
