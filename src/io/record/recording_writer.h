#pragma once
#include <cstdint>
#include <filesystem>
#include <span>

#include "io/record/hdf5_handle.h"
#include "palpate/parameter_updates.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/tick_row.h"

namespace palpate::record {

/// Writes the HDF5 file of a recording on one thread (docs/file-formats.md). Only for the module record;
/// throws hdf5::Error.
class RecordingWriter final {
 public:
  /// Rows per chunk of /ticks; also the largest number of rows for one append().
  static constexpr std::size_t kChunkRows = 1024;

  /// [setup] Creates the file with all that is known before the first tick.
  RecordingWriter(const std::filesystem::path& file, const scene::Scene& scene, const RunFacts& facts);
  /// Closes without reporting errors; call close() to get them.
  ~RecordingWriter() = default;
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// [setup] Writes the wall time of tick 0 and switches to HDF5's SWMR mode, in which the file can be read,
  /// or the process killed, while it grows. From now on the file has a lock of its writer.
  void start(std::int64_t started_unix_ns);

  /// [setup] Appends rows. @throws hdf5::Error before it writes anything when the disk is full.
  void append(std::span<const haptics::TickRow> rows);

  /// [setup] Appends updates of tissue and noise; those of a tick must precede its rows.
  void append(std::span<const haptics::ParameterUpdate> changes);

  /// [setup] Gives all rows to the system, so that they survive the end of this process; with `to_disk` waits
  /// until they survive a power failure.
  void flush(bool to_disk);

  /// [setup] Writes the summary of the run; facts.complete marks the recording as complete.
  void write_summary(const RunFacts& facts, std::uint64_t rows_lost);

  /// [setup] Closes the file so that every HDF5 tool can open it.
  void close();

  /// [any] The file's path, which follows a rename.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  void moved_to(const std::filesystem::path& path) { path_ = path; }

  /// [any] Whether an HDF5 write failed, so that close() would corrupt the file.
  [[nodiscard]] bool damaged() const noexcept { return damaged_; }

  /// [any] Leaves the file as it is, like a killed process: after a failed write HDF5 would corrupt it.
  void abandon() noexcept;

 private:
  /// Reserves disk space ahead. @throws hdf5::Error when the disk is full.
  void reserve_space(std::int64_t extra_bytes);
  [[nodiscard]] int descriptor() const;
  void append_to(hid_t dataset, hid_t type, hsize_t start, hsize_t count, const void* data);

  std::filesystem::path path_;
  hdf5::Handle file_;
  hdf5::Handle row_type_;
  hdf5::Handle ticks_;
  hdf5::Handle change_type_;
  hdf5::Handle changes_;
  std::uint64_t rows_ = 0;
  std::uint64_t change_rows_ = 0;
  bool change_unflushed_ = false;
  bool damaged_ = true;            // during a step, and after a step failed
  std::int64_t reserved_end_ = 0;  // bytes of the file for which disk space is reserved
};

/// [setup] The HDF5 type of a TickRow in memory, with the column names.
[[nodiscard]] hdf5::Handle tick_row_type();

/// [setup] The HDF5 type of a UpdateRow in memory, with the column names.
[[nodiscard]] hdf5::Handle update_row_type();

/// Names of the datasets of the group /run, for writer and reader.
namespace run_names {
inline constexpr const char* kComplete = "complete";
inline constexpr const char* kMissedDeadlines = "missed_deadlines";
inline constexpr const char* kLongestGap = "longest_gap_ns";
inline constexpr const char* kRealtimePriority = "realtime_priority";
inline constexpr const char* kMemoryLocked = "memory_locked";
inline constexpr const char* kPolled = "polled";
inline constexpr const char* kRows = "rows";
inline constexpr const char* kRowsLost = "rows_lost";
inline constexpr const char* kTickTime = "tick_ns";
inline constexpr const char* kLateness = "late_ns";
inline constexpr const char* kTickHistogram = "tick_histogram_ns";
inline constexpr const char* kLateHistogram = "late_histogram_ns";
inline constexpr const char* kWatchdogStops = "watchdog_stops";
inline constexpr const char* kRemarks = "remarks";
}  // namespace run_names

/// The root attribute that marks an HDF5 file as a recording, and the version of its layout.
inline constexpr const char* kFormatName = "palpate recording";
inline constexpr std::int64_t kFormatVersion = 1;

/// The root attribute that names the study of a recording; its runs are blind until it is unblinded. The
/// other one holds StudyMark::commitment.
inline constexpr const char* kStudyAttribute = "study_blind";
inline constexpr const char* kCommitmentAttribute = "study_commitment";

}  // namespace palpate::record
