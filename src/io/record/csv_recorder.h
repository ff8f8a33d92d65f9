#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "core/base/spsc_queue.h"
#include "io/record/make_recorder.h"
#include "palpate/parameter_updates.h"
#include "palpate/tick_row.h"

namespace palpate::record {

/// Records a run as the CSV that export_csv() writes. Parameter updates go to changes_csv_path() at the end,
/// if there were any.
class CsvRecorder final : public RunRecorder {
 public:
  /// [setup] Creates the file. @param waits the ticking thread writes the file; otherwise another thread
  /// does, fed by a ring @throws InputError naming the file when it cannot be created, or the system has no
  /// threads.
  CsvRecorder(std::filesystem::path file, const scene::Scene& scene, bool waits);
  ~CsvRecorder() override;

  void on_update(const haptics::ParameterUpdate& update) noexcept override;
  void on_row(const haptics::TickRow& row) noexcept override;
  void flush() override;
  void finish(const haptics::LoopReport& report) override;

 private:
  /// Writes all rows of the ring.
  void drain() noexcept;
  void stop_thread();

  std::filesystem::path file_;
  bool waits_;
  SpscQueue<haptics::TickRow> ring_;
  SpscQueue<haptics::ParameterUpdate> updates_;
  std::atomic<std::uint64_t> rows_lost_{0};
  std::atomic<bool> finishing_{false};
  // Used by the writing thread:
  std::ofstream out_;
  std::vector<char> text_;
  int failure_ = 0;  // errno; 0: none
  std::thread thread_;
};

}  // namespace palpate::record
