#pragma once
// Requests of the user and the system to end a run or to reset its faults, in each system's way (posix/,
// windows/).
#include <atomic>
#include <string>

namespace palpate::app {

/// [setup] During the lifetime of this object Ctrl-C, SIGTERM or the end of the terminal (SIGHUP) ends the
/// run with zero force and a closed recording, or its preparation before any file is written. A second one
/// ends the program at once. Make it before anything that takes time. On Windows Ctrl-C, Ctrl-Break, the
/// closed console, the end of the session and the shutdown do that; the system waits a few seconds for the
/// end of the run.
class StopOnSignal final {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  /// [any] True after the first signal.
  [[nodiscard]] const std::atomic<bool>& flag() const noexcept;

 private:
  void (*hangup_before_)(int);  // nohup ignores SIGHUP, which then stays ignored
};

/// During the lifetime of this object SIGUSR1 resets the faults of all hands; it is ignored afterwards. A
/// late reset must not end the program before its report is written. Windows has no such signal.
class ResetOnSignal final {
 public:
  /// [setup]
  ResetOnSignal();
  ~ResetOnSignal();
  ResetOnSignal(const ResetOnSignal&) = delete;
  ResetOnSignal& operator=(const ResetOnSignal&) = delete;

  /// [rt] Whether a reset was asked for since the last call.
  [[nodiscard]] static bool take() noexcept;
};

/// [setup] How the user resets a fault, at the end of a message: "until it is reset: kill -USR1 4242".
[[nodiscard]] std::string describe_reset();
/// [any] What a command's help says about faults, one line.
[[nodiscard]] const char* describe_faults() noexcept;

/// [setup] Ignores signals that would end the program: of a file that is too large, and resets outside a run.
void ignore_signals() noexcept;

}  // namespace palpate::app
