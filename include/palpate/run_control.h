#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "palpate/device.h"
#include "palpate/histogram.h"

namespace palpate::haptics {

class ParameterUpdates;

/// How a loop waits for its next tick.
enum class Waiting {
  kSleep,  // sleeps; the core is free meanwhile. The loop wakes some tens of microseconds late, with cold
           // caches
  kPoll,   // polls the clock: ticks begin within some microseconds, and the core is fully used
};

/// Settings of the loop's thread.
struct LoopThread {
  std::optional<int> core = std::nullopt;  // index of the core that it runs on; empty: any core
  Waiting waiting = Waiting::kSleep;
};

/// Commands from any thread to a run. The loop reads them once per tick and never waits for the caller.
class RunControl final {
 public:
  static constexpr std::uint32_t kAllHands = std::numeric_limits<std::uint32_t>::max();

  /// [setup] @param updates of tissue and noise parameters; must outlive this object; null: no updates
  explicit RunControl(ParameterUpdates* updates = nullptr) noexcept : updates_(updates) {}

  /// [any] Ends the run before its next tick, with zero force. Returns at once.
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }
  /// [any] Pauses or resumes the run. During a pause no tick begins, the devices are stopped and the
  /// simulated time does not advance. It works only in real time and only when no hand holds a device
  /// (docs/decisions/0011-pause). Otherwise it is ignored.
  void pause(bool on) noexcept { pause_.store(on, std::memory_order_relaxed); }
  /// [any] Clears the latched faults of these hands at the next tick. @param hands one bit per hand
  void reset_faults(std::uint32_t hands = kAllHands) noexcept {
    resets_.fetch_or(hands, std::memory_order_relaxed);
  }

  [[nodiscard]] bool stopping() const noexcept { return stop_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool pausing() const noexcept { return pause_.load(std::memory_order_relaxed); }
  /// [rt] For the loop: the resets requested since the last call, one bit per hand.
  [[nodiscard]] std::uint32_t take_resets() noexcept {
    if (resets_.load(std::memory_order_relaxed) == 0) return 0;
    return resets_.exchange(0, std::memory_order_relaxed);
  }
  /// [rt] For the loop: the parameter updates, or null.
  [[nodiscard]] ParameterUpdates* updates() noexcept { return updates_; }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<bool> pause_{false};
  std::atomic<std::uint32_t> resets_{0};
  ParameterUpdates* updates_;
};

/// A fault that was latched on one hand.
struct FaultSeen {
  static constexpr std::uint64_t kNotReset = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t tick = 0;
  std::uint32_t hand = 0;
  Fault fault = Fault::kNone;
  std::uint64_t reset_tick = kNotReset;  // first tick without the fault
};

/// One stop of the devices by the watchdog.
struct WatchdogStop {
  static constexpr std::size_t kMaxKept = 64;  // the report lists at most this many stops

  std::uint64_t tick = 0;     // last tick that had begun
  std::int64_t after_ns = 0;  // time since the start of the first tick
};

/// Report of a finished run.
struct LoopReport {
  static constexpr std::size_t kMaxFaults = 64;

  std::uint64_t ticks = 0;
  bool stopped_early = false;
  Fault fault = Fault::kNone;          // the first fault
  std::vector<FaultSeen> faults;       // the first kMaxFaults faults
  std::uint64_t further_faults = 0;    // number of faults that `faults` omits
  Histogram tick_time;                 // ns, computing time of a tick; also measured offline
  Histogram lateness;                  // ns, delay of the start of a tick; empty offline
  std::uint64_t missed_deadlines = 0;  // ticks that began a full period or more late
  std::int64_t longest_gap_ns = 0;     // between the starts of two ticks
  bool realtime_priority = false;      // SCHED_FIFO granted
  bool memory_locked = false;          // mlockall granted
  bool polled = false;                 // the loop polled the clock between ticks; false: it slept
  std::uint64_t pauses = 0;            // number of pauses
  std::int64_t paused_ns = 0;          // total duration of the pauses
  std::uint64_t watchdog_stops = 0;    // number of stops by the watchdog
  std::vector<WatchdogStop> stops;     // the first WatchdogStop::kMaxKept stops
  std::vector<std::string> remarks;  // readable: requests that the system refused, and stops by the watchdog
};

}  // namespace palpate::haptics
