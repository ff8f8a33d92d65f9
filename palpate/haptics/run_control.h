#pragma once
#include <atomic>
#include <cstdint>
#include <limits>

#include "palpate/haptics/live_changes.h"

namespace palpate::haptics {

/// What any thread may ask of a run. The loop looks at it once a tick and never waits for the caller.
class RunControl final {
 public:
  static constexpr std::uint32_t kAllHands = std::numeric_limits<std::uint32_t>::max();

  /// [setup] @param updates takes new tissue and noise parameters; null: the run has none; outlives this
  explicit RunControl(LiveChanges* updates = nullptr) noexcept : updates_(updates) {}

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
  [[nodiscard]] LiveChanges* updates() noexcept { return updates_; }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<bool> pause_{false};
  std::atomic<std::uint32_t> resets_{0};
  LiveChanges* updates_;
};

}  // namespace palpate::haptics
