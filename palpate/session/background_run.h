#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "palpate/haptics/run_control.h"
#include "palpate/session/run_result.h"

namespace palpate::session {

/// A run on a thread of its own. All members: [any], unless said; none is for the tick.
class BackgroundRun final {
 public:
  /// [setup] Starts. @param run does the run, on the new thread @param control of that run, outlives this
  BackgroundRun(haptics::RunControl& control, std::function<RunResult()> run);
  /// Ends the run: zero force, recording closed.
  ~BackgroundRun();
  BackgroundRun(const BackgroundRun&) = delete;
  BackgroundRun& operator=(const BackgroundRun&) = delete;

  /// Asks the run to end at its next tick. Does not wait.
  void stop() noexcept { control_.stop(); }
  /// Waits for the end: zero force, recording closed.
  void wait();
  /// Waits at most so long. @return whether the run has ended
  [[nodiscard]] bool wait_for(std::chrono::milliseconds time) const;
  [[nodiscard]] bool ended() const { return wait_for(std::chrono::milliseconds(0)); }

  /// After the end: how the run went; nothing when it failed.
  [[nodiscard]] const std::optional<RunResult>& result() const noexcept { return result_; }
  /// After the end: why the run failed; empty: it did not.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  haptics::RunControl& control_;
  std::optional<RunResult> result_;
  std::string failure_;
  mutable std::mutex mutex_;  // of ended_
  mutable std::condition_variable changed_;
  bool ended_ = false;
  std::mutex joining_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate::session
