#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"

namespace palpate::record {

/// Writes a run to one HDF5 file by a thread of its own, fed from a ring. The file appears under its name
/// when the first tick is due, not earlier, and is flushed at least every 0.5 s.
class Recorder final : public haptics::TickObserver {
 public:
  /// [setup] Prepares the file next to its final name and starts the thread.
  /// @param on_failure is called once, from the recorder's thread, when writing fails (the disk is full),
  /// with the file, the rows that are safe in it, and the reason; the run can go on
  /// @throws InputError when the file cannot be made, naming it.
  Recorder(std::filesystem::path file, const scene::Setup& setup, bool offline,
           std::function<void(const std::string&)> on_failure = {});
  ~Recorder() override;

  void on_start(std::int64_t started_unix_ns) noexcept override;
  void on_update(const haptics::LiveChange& change) noexcept override;
  void on_row(const haptics::TickRow& row) noexcept override;

  /// [setup] Writes what is left and the loop's account, closes the file. @throws InputError when writing
  /// failed (disk full), or rows were lost because the ring was full, naming the file.
  void finish(const haptics::LoopReport& report);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::record
