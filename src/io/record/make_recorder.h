#pragma once
#include <filesystem>
#include <memory>

#include "palpate/run_control.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"

namespace palpate::record {

/// Records a run to a file.
class RunRecorder : public haptics::TickObserver {
 public:
  /// [setup] Writes all rows so far, where the ticking thread writes the file.
  virtual void flush() {}
  /// [setup] Writes the remaining rows and closes the file. @throws InputError naming the file when writing
  /// failed (disk full) or rows were lost.
  virtual void finish(const haptics::LoopReport& report) = 0;
};

/// [setup] Creates the file: CSV for a name that ends in .csv, otherwise HDF5.
/// @param waits a tick waits for the disk; false: rows are lost where the disk is too slow
/// @throws InputError naming the file when it cannot be created, or when this build has no HDF5.
[[nodiscard]] std::unique_ptr<RunRecorder> make_recorder(const std::filesystem::path& file,
                                                         const scene::Scene& scene, bool waits);

}  // namespace palpate::record
