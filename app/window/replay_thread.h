#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "io/record/recording_frames.h"

namespace palpate::app {

/// Runs a recording's ticks again on a thread of its own, towards whatever tick is wanted last, so that a
/// window stays fluid on a long way. All members: [any], one thread.
class ReplayThread final {
 public:
  /// @param frames are this thread's alone until its end
  explicit ReplayThread(record::RecordingFrames& frames);
  ~ReplayThread();
  ReplayThread(const ReplayThread&) = delete;
  ReplayThread& operator=(const ReplayThread&) = delete;

  /// From here on it goes towards this tick.
  void want(std::uint64_t tick);
  /// The snapshot that was reached last. @return whether there is one that was not taken yet
  [[nodiscard]] bool take(haptics::Snapshot& snapshot);
  /// Whether the tick that was wanted last has been reached (or never will be: failure()).
  [[nodiscard]] bool there();
  /// Why that tick cannot be reached, in words; empty: it can.
  [[nodiscard]] std::string failure();

 private:
  void work();
  void go_to(std::uint64_t tick);
  [[nodiscard]] bool is_there() const { return !failure_.empty() || (reached_any_ && reached_ == wanted_); }

  record::RecordingFrames& frames_;
  std::mutex mutex_;  // of what follows
  std::condition_variable news_;
  std::uint64_t wanted_ = 0;
  std::uint64_t reached_ = 0;
  bool reached_any_ = false;
  bool taken_ = true;
  bool ending_ = false;
  haptics::Snapshot newest_;
  std::string failure_;  // of the tick that is wanted
  std::thread thread_;
};

}  // namespace palpate::app
