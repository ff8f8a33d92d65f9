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
struct TimeStatistics {
  std::int64_t p50_ns = 0;
  std::int64_t p99_ns = 0;
  std::int64_t p999_ns = 0;
  std::int64_t max_ns = 0;
};

/// Histogram of a measured time: the buckets that are not empty, in ascending order, at most 0.1 % wide.
using TimeHistogram = std::vector<haptics::Histogram::Bucket>;

/// Called with the progress of a long operation, 0..1; may be empty.
using Progress = std::function<void(double)>;

/// The study that a run belongs to. Its recording is blind (Blind) until the study is unblinded.
struct StudyMark {
  std::string name{};  // empty: none
  // SHA-256 of the proof in the study's unblinded.json, in hexadecimal; empty: no proof opens the recording
  std::string commitment{};

  bool operator==(const StudyMark&) const = default;
};

/// Facts about a recorded run.
struct RunFacts {
  std::string version;  // of palpate
  std::string compiler;
  std::string machine;               // processor, kernel
  std::int64_t started_unix_ns = 0;  // wall time of tick 0; 0 when no tick was due yet
  bool offline = false;
  bool complete = false;  // the file was closed; false: truncated
  // From the loop's report; zero in a truncated file:
  std::uint64_t missed_deadlines = 0;
  std::int64_t longest_gap_ns = 0;
  bool realtime_priority = false;
  bool memory_locked = false;
  bool polled = false;           // the loop polled the clock between ticks; false: it slept
  TimeStatistics tick_time;      // computing time of a tick
  TimeStatistics lateness;       // delay of the start of ticks
  TimeHistogram tick_histogram;  // of tick_time; also for offline runs, whose rows have no times
  TimeHistogram late_histogram;  // of lateness
  std::uint64_t watchdog_stops = 0;
  std::vector<std::string> remarks;  // requests that the system refused, and stops by the watchdog
  StudyMark study{};                 // that the run belongs to
  bool blind = false;                // of a study that is not unblinded yet
};

/// A complete recording in memory.
struct Recording {
  scene::Scene scene;
  RunFacts facts;
  std::vector<haptics::TickRow> rows;               // by tick, then hand
  std::vector<haptics::ParameterUpdate> changes{};  // of tissue and noise, by tick; at most one per tick
};

/// Whether the recording of a study that is not unblinded yet may be read. Its forces and noise show the
/// condition, so a caller that allows it must not show them.
enum class Blind { kRefuse, kAllow };

/// [setup] Reads a recording. A truncated file (kill -9, full disk, interrupted copy), or one that is still
/// being written, gives the rows up to the last complete tick before the damage. @throws InputError that
/// names the file and the defect, or the study that is still blind.
[[nodiscard]] Recording read_recording(const std::filesystem::path& file, const Progress& progress = {},
                                       Blind blind = Blind::kRefuse);

/// [setup] Reads a recording, also of a study that is still blind. Then it first appends a line to the file
/// blind-broken.jsonl in the recording's folder. @param command that reads it @throws InputError as
/// read_recording(), and when the line cannot be written.
[[nodiscard]] Recording break_blind(const std::filesystem::path& file, const std::string& command,
                                    const Progress& progress = {});

/// Result of repair_recording().
struct RepairResult {
  std::uint64_t rows = 0;    // in the file after the repair
  bool was_damaged = false;  // false: the file was valid and is unchanged
};

/// [setup] Makes a truncated recording readable for every HDF5 tool: writes the readable rows to a new file
/// in the same folder, which then replaces the old one. @throws InputError, with the old file unchanged, when
/// it is no recording, is still being written, or the new file cannot be created.
RepairResult repair_recording(const std::filesystem::path& file, const Progress& progress = {});

/// [setup] Writes the ticks as CSV with the columns of docs/file-formats.md, numbers in shortest round-trip
/// form, then the device's sample (device_*). phase is approach, press or pull; fault is 0 or a name such as
/// not-finite. @throws InputError that names the file when it cannot be written.
void export_csv(const Recording& recording, const std::filesystem::path& file, const Progress& progress = {});

/// [any] The file for the parameter updates of a recording that is exported to `csv`: NAME-changes.csv in the
/// same folder.
[[nodiscard]] std::filesystem::path changes_csv_path(const std::filesystem::path& csv);

/// [setup] Writes the parameter updates as CSV. A line holds one update, with the tissue and noise that apply
/// from its tick on. The column what is tissue, noise, inclusion or stimulus, law is layered or smooth.
/// @throws InputError that names the file when it cannot be written.
void export_changes_csv(const Recording& recording, const std::filesystem::path& file);

/// Result of a replay.
struct ReplayResult {
  std::uint64_t rows_compared = 0;
  std::uint64_t rows_different = 0;
  // tick, hand, column, and unless blind the recorded and replayed value; empty: all rows are equal
  std::string first_difference;
  std::uint64_t hash = 0;  // of the replayed rows' bits, without tick_ns and late_ns
};

/// [setup] Describes the first column whose bits differ; tick_ns and late_ns are not compared. Empty: all
/// columns are equal. @param values whether the description has the values
[[nodiscard]] std::string row_difference(const haptics::TickRow& recorded, const haptics::TickRow& replayed,
                                         bool values = true);

inline constexpr std::uint64_t kHashStart = 14695981039346656037ULL;

/// [any] 64-bit FNV-1a hash (Fowler, Noll, Vo) of the rows' bits without tick_ns and late_ns. Columns that
/// older recordings lack count only where they are not 0. `hash` is the hash of the previous rows.
[[nodiscard]] std::uint64_t hash_rows(std::span<const haptics::TickRow> rows,
                                      std::uint64_t hash = kHashStart) noexcept;

/// [setup] Replays the recorded device samples and compares all rows bit for bit, except tick_ns and late_ns.
/// @param how options for the preparation of the organ @throws InputError when rows are missing in the middle
/// or the scene is invalid.
[[nodiscard]] ReplayResult replay(const Recording& recording, const Progress& progress = {},
                                  const contact::Preparation& how = {});

/// [setup] Replays the recording and returns the snapshots at `ticks` (ascending), for pictures; their
/// taken_ns is the time since tick 0. @throws InputError as replay(), or when a tick is after the end or out
/// of order.
[[nodiscard]] std::vector<haptics::Snapshot> snapshots_at(const Recording& recording,
                                                          const std::vector<std::uint64_t>& ticks,
                                                          const contact::Preparation& how = {});

}  // namespace palpate::record
