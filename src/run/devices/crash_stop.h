#pragma once
// What CrashStop needs of the system, in posix/ and windows/.
#include <cstddef>
#include <memory>

namespace palpate::devices {

/// [rt] Whether a fatal signal is ending this program. Devices then display zero force only.
[[nodiscard]] bool is_crashing() noexcept;

/// Zero force before a fatal signal (on Windows an exception that nobody handles) ends the program.
///
/// While at least one object exists, SIGSEGV, SIGABRT, SIGBUS, SIGFPE and SIGILL have a handler. It sets
/// is_crashing(), so that the threads of the devices send zero force, and calls the vendors' stop functions.
/// After kLastWords it ends the program by the same signal and the action that it had before, such as a core
/// dump.
///
/// The handler calls only async-signal-safe functions, except a vendor's stop function, of which no maker
/// promises that. If it waits for a lock that the program held when it crashed, SIGALRM ends the program
/// after a second. If it crashes, the system ends the program at once. Either way the device gets no further
/// command, as without a handler, and its own watchdog acts.
class CrashStop final {
 public:
  using Stop = void (*)(void* device) noexcept;
  static constexpr long kLastWords = 20'000'000;  // ns; devices' threads send every 10 ms or more often

  /// [setup] @param stop called with `device` by the handler; null for a device with its own thread, which
  /// sends zero force when is_crashing()
  explicit CrashStop(Stop stop = nullptr, void* device = nullptr);
  /// [setup] Call it before the device is closed.
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

 private:
  std::size_t entry_;
};

/// A stack on which the calling thread handles signals during the lifetime of this object, because a thread
/// whose own stack has overflowed cannot use that.
class SignalStack final {
 public:
  /// [setup]
  SignalStack();
  ~SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  struct Stack;
  std::unique_ptr<Stack> stack_;
};

/// [setup] Handlers that call stop_devices() before a crash ends the program, and those from before.
void install_crash_handlers();
void restore_crash_handlers();

/// [rt] Sets is_crashing(). @return whether it was set before: a vendor's stop function has crashed, or
/// another thread crashes too
[[nodiscard]] bool begin_crash() noexcept;

/// [rt] Calls the stop functions of all open devices; takes no lock.
void stop_devices() noexcept;

}  // namespace palpate::devices
