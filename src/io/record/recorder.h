#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "io/record/make_recorder.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"

namespace palpate::record {

/// Records a run to one HDF5 file on its own thread, fed by a ring. The file gets its name when the first
/// tick is due, and is flushed at least every 0.5 s.
class Recorder final : public RunRecorder {
 public:
  /// [setup] Creates the file under a temporary name in the same folder and starts the thread.
  /// @param on_failure called once, on the recorder's thread, when writing fails (disk full), with the file,
  /// the rows that are safe in it and the reason; the run can continue
  /// @param study that the recording belongs to @param waits whether on_row() and on_update() wait for the
  /// disk, as they always do offline; false: a row is lost when the ring is full
  /// @throws InputError naming the file when it cannot be created.
  Recorder(std::filesystem::path file, const scene::Scene& scene, bool offline,
           std::function<void(const std::string&)> on_failure = {}, const StudyMark& study = {},
           bool waits = false);
  ~Recorder() override;

  void on_start(std::int64_t started_unix_ns) noexcept override;
  void on_update(const haptics::ParameterUpdate& change) noexcept override;
  void on_row(const haptics::TickRow& row) noexcept override;

  /// [setup] Writes the remaining rows and the loop's report, and closes the file. @throws InputError naming
  /// the file when writing failed (disk full) or rows were lost because the ring was full.
  void finish(const haptics::LoopReport& report) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::record
