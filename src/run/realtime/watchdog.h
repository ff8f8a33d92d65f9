#pragma once
#include <atomic>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "palpate/device.h"
#include "palpate/run_control.h"

namespace palpate::realtime {

/// A second thread that calls Device::stop() on all devices when no tick begins for too long, so that a loop
/// that hangs leaves no force. It runs at a higher priority than the loop where permitted. Both share only
/// atomics, so it never delays the loop.
class Watchdog final {
 public:
  /// [setup] Starts the thread; it does nothing before the first beat(). @param devices outlive it
  /// @param stalled_after_ns between two ticks' begins, > 0
  Watchdog(std::span<haptics::Device* const> devices, std::int64_t stalled_after_ns);
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// [rt] A tick begins at `now_ns` (monotonic).
  void beat(std::uint64_t tick, std::int64_t now_ns) noexcept {
    tick_.store(tick, std::memory_order_relaxed);
    last_begin_.store(now_ns);
  }
  /// [rt] No further tick follows: it starts no stop from now on. A stop in progress goes on.
  void rest() noexcept { last_begin_.store(kResting); }
  /// [rt] Number of stops; counted before each stop begins.
  [[nodiscard]] std::uint64_t stops() const noexcept { return stops_.load(); }

  /// [setup] Ends the thread (within 20 ms). @return the first WatchdogStop::kMaxKept stops.
  std::vector<haptics::WatchdogStop> finish();

 private:
  static constexpr std::int64_t kResting = -1;

  void watch() noexcept;
  void stop_devices(std::int64_t last_begin, std::int64_t first_begin) noexcept;

  std::span<haptics::Device* const> devices_;
  std::int64_t stalled_after_ns_;
  std::vector<haptics::WatchdogStop> kept_;  // used by the thread until it has ended
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> stops_{0};
  alignas(64) std::atomic<std::int64_t> last_begin_{kResting};
  std::atomic<std::uint64_t> tick_{0};
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate::realtime
