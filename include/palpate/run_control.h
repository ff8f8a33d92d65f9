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
  kSleep,  // its core is free for others meanwhile; it wakes some tens of microseconds late, to cold caches
  kPoll,   // it asks for the time until it is: ticks begin within some microseconds, and the core is taken
};

/// What a loop's thread is asked to be.
struct LoopThread {
  std::optional<int> core = std::nullopt;  // the one core that it runs on
  Waiting waiting = Waiting::kSleep;
};

/// What any thread may ask of a run. The loop looks at it once a tick and never waits for the caller.
class RunControl final {
 public:
  static constexpr std::uint32_t kAllHands = std::numeric_limits<std::uint32_t>::max();

  /// [setup] @param updates takes new tissue and noise parameters; null: the run has none; outlives this
  explicit RunControl(ParameterUpdates* updates = nullptr) noexcept : updates_(updates) {}

  /// [any] Ends the run before its next tick, with zero force. Does not wait.
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }
  /// [any] While a run is paused no tick begins, its devices are stopped and its time stands still. Only in
  /// real time, and only where no hand holds a device (docs/decisions/0011-pause); ignored otherwise.
  void pause(bool on) noexcept { pause_.store(on, std::memory_order_relaxed); }
  /// [any] Clears the latched faults of these hands, a bit a hand, at the next tick.
  void reset_faults(std::uint32_t hands = kAllHands) noexcept {
    resets_.fetch_or(hands, std::memory_order_relaxed);
  }

  [[nodiscard]] bool stopping() const noexcept { return stop_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool pausing() const noexcept { return pause_.load(std::memory_order_relaxed); }
  /// [rt] For the loop: the resets asked for since the last call.
  [[nodiscard]] std::uint32_t take_resets() noexcept {
    if (resets_.load(std::memory_order_relaxed) == 0) return 0;
    return resets_.exchange(0, std::memory_order_relaxed);
  }
  /// [rt] For the loop.
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
  std::uint64_t reset_tick = kNotReset;  // the first tick without it
};

/// One time that the watchdog stopped the devices.
struct WatchdogStop {
  static constexpr std::size_t kMaxKept = 64;  // further ones are counted only

  std::uint64_t tick = 0;     // the last tick that had begun
  std::int64_t after_ns = 0;  // since the first tick began
};

/// How a run went.
struct LoopReport {
  static constexpr std::size_t kMaxFaults = 64;

  std::uint64_t ticks = 0;
  bool stopped_early = false;
  Fault fault = Fault::kNone;          // the first
  std::vector<FaultSeen> faults;       // the first kMaxFaults
  std::uint64_t further_faults = 0;    // beyond those
  Histogram tick_time;                 // ns; also measured offline
  Histogram lateness;                  // ns; empty offline
  std::uint64_t missed_deadlines = 0;  // ticks that began a full period or more late
  std::int64_t longest_gap_ns = 0;     // between two tick starts
  bool realtime_priority = false;      // SCHED_FIFO granted
  bool memory_locked = false;          // mlockall granted
  bool polled = false;                 // between ticks; else the loop slept
  std::uint64_t pauses = 0;            // how often it was paused
  std::int64_t paused_ns = 0;          // for how long, in all
  std::uint64_t watchdog_stops = 0;    // how often the watchdog stopped the devices
  std::vector<WatchdogStop> stops;     // the first WatchdogStop::kMaxKept
  std::vector<std::string> remarks;    // what was not granted, what the watchdog did, in words
};

}  // namespace palpate::haptics
