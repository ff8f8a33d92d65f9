#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "io/record/recording_frames.h"

namespace palpate::app {

/// Replays a recording on a separate thread, towards the latest requested tick, so that the window stays
/// responsive. All members: [any], one thread.
class ReplayThread final {
 public:
  /// @param frames used only by this thread until the destructor returns
  explicit ReplayThread(record::RecordingFrames& frames);
  ~ReplayThread();
  ReplayThread(const ReplayThread&) = delete;
  ReplayThread& operator=(const ReplayThread&) = delete;

  /// Requests this tick.
  void want(std::uint64_t tick);
  /// Takes the latest snapshot. @return whether it is new
  [[nodiscard]] bool take(haptics::Snapshot& snapshot);
  /// Whether the requested tick has been reached or has failed (failure()).
  [[nodiscard]] bool there();
  /// Why the requested tick cannot be reached; empty: no failure.
  [[nodiscard]] std::string failure();

 private:
  void work();
  void go_to(std::uint64_t tick);
  [[nodiscard]] bool is_there() const { return !failure_.empty() || (reached_any_ && reached_ == wanted_); }

  record::RecordingFrames& frames_;
  std::mutex mutex_;  // guards the members below
  std::condition_variable news_;
  std::uint64_t wanted_ = 0;
  std::uint64_t reached_ = 0;
  bool reached_any_ = false;
  bool taken_ = true;
  bool ending_ = false;
  haptics::Snapshot newest_;
  std::string failure_;  // at the requested tick
  std::thread thread_;
};

}  // namespace palpate::app
