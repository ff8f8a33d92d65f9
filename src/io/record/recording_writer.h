#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "io/record/hdf5_handle.h"
#include "palpate/live_changes.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/tick_row.h"

namespace palpate::record {

/// Layout of the one HDF5 file of a recording, written by one thread (docs/file-formats.md). Internal to
/// record; throws hdf5::Error.
class RecordingWriter final {
 public:
  /// Rows of one chunk of /ticks; also the most that one append() should bring.
  static constexpr std::size_t kChunkRows = 1024;

  /// [setup] Makes the file with everything that is known before the first tick.
  RecordingWriter(const std::filesystem::path& file, const scene::Setup& setup, const RunFacts& facts);
  /// Closes without a word; call close() to hear of failure.
  ~RecordingWriter() = default;
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// [setup] Writes the wall time of tick 0 and goes over to HDF5's mode for files that are read, or cut off,
  /// while they grow; from now on the file is locked as being written.
  void start(std::int64_t started_unix_ns);

  /// [setup] Appends rows. @throws hdf5::Error before anything is written when the disk is full.
  void append(std::span<const haptics::TickRow> rows);

  /// [setup] Appends changes of tissue and noise; those of a tick before its rows.
  void append(std::span<const haptics::LiveChange> changes);

  /// [setup] Hands all rows to the system, so that they outlive this process; with `to_disk` waits until they
  /// outlive a power failure.
  void flush(bool to_disk);

  /// [setup] Writes how the run went; with facts.complete the recording counts as whole.
  void write_summary(const RunFacts& facts, std::uint64_t rows_lost);

  /// [setup] Closes the file so that every HDF5 tool opens it.
  void close();

  /// [any] Where the file is; tells of a new name.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  void moved_to(const std::filesystem::path& path) { path_ = path; }

  /// [any] Whether HDF5 failed to write, so that close() would spoil the file.
  [[nodiscard]] bool damaged() const noexcept { return damaged_; }

  /// [any] Leaves the file as it stands, as a killed process would: after a failed write HDF5 would spoil it.
  void abandon() noexcept;

 private:
  /// Takes room on the disk ahead. @throws hdf5::Error when it is full.
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
  bool damaged_ = true;            // while a step is under way, and after it failed
  std::int64_t reserved_end_ = 0;  // bytes of the file that the disk is known to have room for
};

/// [setup] HDF5's description of a TickRow in memory, with the columns' names.
[[nodiscard]] hdf5::Handle tick_row_type();

/// [setup] The same of a ChangeRow.
[[nodiscard]] hdf5::Handle change_row_type();

/// Datasets of the group /run, in the file's and the reader's words.
namespace run_names {
inline constexpr const char* kComplete = "complete";
inline constexpr const char* kMissedDeadlines = "missed_deadlines";
inline constexpr const char* kLongestGap = "longest_gap_ns";
inline constexpr const char* kRealtimePriority = "realtime_priority";
inline constexpr const char* kMemoryLocked = "memory_locked";
inline constexpr const char* kPolled = "polled";
inline constexpr const char* kRowsLost = "rows_lost";
inline constexpr const char* kTickTime = "tick_ns";
inline constexpr const char* kLateness = "late_ns";
inline constexpr const char* kTickHistogram = "tick_histogram_ns";
inline constexpr const char* kLateHistogram = "late_histogram_ns";
inline constexpr const char* kWatchdogStops = "watchdog_stops";
inline constexpr const char* kRemarks = "remarks";
}  // namespace run_names

/// The root attribute that makes an HDF5 file a recording, and the version of its layout.
inline constexpr const char* kFormatName = "palpate recording";
inline constexpr std::int64_t kFormatVersion = 1;

}  // namespace palpate::record
