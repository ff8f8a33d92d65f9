#pragma once
#include <csignal>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::haptics {

/// Which of a run's threads goes first when several want a processor.
enum class Urgency { kLoop, kWatchdog };

/// [setup] Asks for SCHED_FIFO for the calling thread, and for wake-ups that are never put off to be taken
/// together with others (timer slack). @return why the priority was not granted, in words; none: it was.
[[nodiscard]] std::optional<std::string> ask_for_priority(Urgency urgency);

/// What Linux lets real-time threads have together: so long of every period; then it stops them until the
/// next.
struct RealtimeBudget {
  long runtime_us = 0;  // below 0: all of it
  long period_us = 0;   // > 0
};

/// [setup] This machine's; none where it cannot be read. @param root in place of /, for tests
[[nodiscard]] std::optional<RealtimeBudget> realtime_budget(const std::filesystem::path& root = "/");

/// [setup] Numbers of the cores that this program may use, ascending.
[[nodiscard]] std::vector<int> usable_cores();

/// [setup] Lets the calling thread run on one core only. @return whether that was granted.
[[nodiscard]] bool pin_to_core(int core) noexcept;

/// [setup] Touches the calling thread's stack, so that no tick meets a page of it for the first time.
void touch_stack() noexcept;

/// Keeps the program's memory from being paged out while it lives, where that is allowed.
class MemoryLock final {
 public:
  /// [setup] @param remarks says in words when it is not allowed
  explicit MemoryLock(std::vector<std::string>& remarks);
  ~MemoryLock();
  MemoryLock(const MemoryLock&) = delete;
  MemoryLock& operator=(const MemoryLock&) = delete;

  [[nodiscard]] bool granted() const noexcept { return granted_; }

 private:
  bool granted_;
};

/// Signals from outside wait while this lives, and so in every thread started meanwhile: Ctrl-C is for the
/// main thread.
class SignalsHeld final {
 public:
  SignalsHeld() noexcept;
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

}  // namespace palpate::haptics
