#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate::realtime {

/// Threads of a run, by rising real-time priority.
enum class Urgency { kLoop, kWatchdog };

/// [setup] Requests SCHED_FIFO and the smallest timer slack for the calling thread; on Windows MMCSS's class
/// "Pro Audio" or the priority "time critical", and exact timers. @return why the priority was not granted;
/// none: granted.
[[nodiscard]] std::optional<std::string> request_priority(Urgency urgency);

/// [setup] Lets the calling thread, which serves clients or reads their files, never interrupt the haptic
/// loop on its core (SCHED_BATCH; on Windows a lower priority). Threads that it starts inherit that, except
/// the loop and the watchdog: where request_priority() is not granted, it restores the normal policy. So it
/// is no lower niceness, which a thread without privileges could not undo.
void yield_to_loop() noexcept;

/// Linux's real-time throttling: all real-time threads together may run for `runtime_us` in every period,
/// then are stopped until the next.
struct RealtimeBudget {
  long runtime_us = 0;  // below 0: no limit
  long period_us = 0;   // > 0
};

/// [setup] This machine's throttling; none when unreadable. @param root in place of /, for tests
[[nodiscard]] std::optional<RealtimeBudget> realtime_budget(const std::filesystem::path& root = "/");

/// [setup] Numbers of the cores that this program may use, ascending.
[[nodiscard]] std::vector<int> usable_cores();

/// [setup] Pins the calling thread to one core. @return whether that was granted.
[[nodiscard]] bool pin_to_core(int core) noexcept;

/// [setup] Touches the pages of the calling thread's stack, so that no tick causes a page fault there.
void prefault_stack() noexcept;

/// Locks the memory of the program (mlockall) during its lifetime, where permitted. Windows cannot.
class MemoryLock final {
 public:
  /// [setup] @param remarks gets the reason when it is not permitted
  explicit MemoryLock(std::vector<std::string>& remarks);
  ~MemoryLock();
  MemoryLock(const MemoryLock&) = delete;
  MemoryLock& operator=(const MemoryLock&) = delete;

  [[nodiscard]] bool granted() const noexcept { return granted_; }

 private:
  bool granted_;
};

/// Blocks external signals in the calling thread during its lifetime, and so in threads started meanwhile.
/// The main thread handles Ctrl-C. On Windows a thread of the system's does.
class BlockedSignals final {
 public:
  BlockedSignals();
  ~BlockedSignals();
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  struct Before;
  std::unique_ptr<Before> before_;
};

}  // namespace palpate::realtime
