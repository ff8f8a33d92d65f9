#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "io/record/recorder.h"
#include "io/system/temporary.h"
#include "palpate/histogram.h"
#include "palpate/parameter_updates.h"
#include "palpate/run_control.h"
#include "palpate/scene.h"
#include "palpate/tick_row.h"

namespace palpate::app {

/// The rows and parameter updates of a run since its first tick, in a temporary file, so that a recording can
/// begin at any time without a restart of the run. A recording has all rows from tick 0 on,
/// because a replay needs them. All members: [setup], one thread.
class RunTape final {
 public:
  static constexpr std::uint64_t kMaxBytes = 2UL << 30U;  // of rows: over an hour of one hand at 1 kHz
  static constexpr std::size_t kRowsAFrame = 4096;        // that feed() passes on at most in one frame

  /// @param scene of the run; must outlive this @param max_bytes of rows that are kept
  explicit RunTape(const scene::Scene& scene, std::uint64_t max_bytes = kMaxBytes);

  /// Keeps a row, in the order of the run.
  void add(const haptics::TickRow& row);
  /// Keeps an update. Add it before feed() gets the rows of its tick.
  void add(const haptics::ParameterUpdate& update) { updates_.push_back(update); }

  /// Begins a recording of the run from its first tick. @param started_unix_ns wall time of tick 0
  /// @throws InputError naming the file, or why the rows are not complete
  void begin(const std::filesystem::path& file, std::int64_t started_unix_ns);
  [[nodiscard]] bool writing() const noexcept { return recorder_ != nullptr; }
  /// The newest recording's file; empty: there was none.
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  /// Passes rows to the recording, the oldest first. @return whether it has all rows so far
  bool feed(std::size_t max_rows = kRowsAFrame);
  /// Completes the recording with all rows so far. @param report of the run; null: the run goes on
  /// @throws InputError naming the file when it is incomplete
  void end(const haptics::LoopReport* report);
  /// Why rows are missing, or why the recording can no longer be written; empty: nothing is wrong.
  [[nodiscard]] std::string failure() const;

 private:
  [[nodiscard]] std::uint64_t rows() const noexcept { return on_disk_ + block_.size(); }
  void write_block();
  void read_rows(std::uint64_t from, std::vector<haptics::TickRow>& rows);
  [[nodiscard]] haptics::LoopReport report_so_far() const;

  const scene::Scene& scene_;
  std::uint64_t max_rows_;
  ScratchFolder folder_{"palpate-run-"};
  std::filebuf disk_;                    // in that folder
  std::uint64_t on_disk_ = 0;            // rows in it
  std::vector<haptics::TickRow> block_;  // rows after those
  std::vector<haptics::ParameterUpdate> updates_;
  std::string gap_;  // why later rows are not kept; empty: all are

  // For the report of a recording that ends before its run:
  haptics::Histogram tick_time_;
  haptics::Histogram lateness_;
  std::uint64_t missed_ = 0;
  std::int64_t longest_gap_ns_ = 0;
  std::int64_t late_before_ns_ = 0;

  std::filesystem::path file_;
  std::uint64_t fed_ = 0;  // rows that the recorder has
  std::size_t updates_fed_ = 0;
  mutable std::mutex mutex_;  // guards writing_failure_, which the recorder's thread sets
  std::string writing_failure_;
  std::unique_ptr<record::Recorder> recorder_;  // last: its thread ends before the members above
};

/// [setup] "FOLDER/NAME-2.h5" for FOLDER/NAME.h5, or with the first higher number for which there is no file.
/// @param allow_itself whether `file` itself is returned when it does not exist
[[nodiscard]] std::filesystem::path free_name(const std::filesystem::path& file, bool allow_itself);

/// [setup] A file of the current folder named by the local time, such as "palpate-20260131-154500.h5".
[[nodiscard]] std::filesystem::path named_by_time(const std::string& ending);

}  // namespace palpate::app
