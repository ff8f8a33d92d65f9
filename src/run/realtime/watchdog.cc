#include "run/realtime/watchdog.h"

#include <algorithm>

#include "io/system/clock.h"
#include "run/realtime/realtime.h"

namespace palpate::realtime {
namespace {

constexpr std::int64_t kLongestNap = 20'000'000;         // ns, so that finish() does not wait longer
constexpr std::int64_t kNapWithNothingToDo = 2'000'000;  // ns; before the first tick or after a stop

}  // namespace

Watchdog::Watchdog(std::span<haptics::Device* const> devices, std::int64_t stalled_after_ns)
    : devices_(devices), stalled_after_ns_(stalled_after_ns) {
  kept_.reserve(haptics::WatchdogStop::kMaxKept);
  const BlockedSignals signals;
  thread_ = std::thread([this] { watch(); });
}

Watchdog::~Watchdog() { (void)finish(); }

std::vector<haptics::WatchdogStop> Watchdog::finish() {
  ending_.store(true);
  if (thread_.joinable()) thread_.join();
  return kept_;
}

void Watchdog::watch() noexcept {
  (void)request_priority(Urgency::kWatchdog);
  std::int64_t first_begin = kResting;
  std::int64_t stopped_at = kResting;  // begin of the tick after which the devices were stopped [ns]
  while (!ending_.load()) {
    const std::int64_t last = last_begin_.load();
    const std::int64_t now = monotonic_ns();
    if (last == kResting || last == stopped_at) {
      sleep_until_ns(now + kNapWithNothingToDo);
      continue;
    }
    if (first_begin == kResting) first_begin = last;
    const std::int64_t due = last + stalled_after_ns_;
    if (now < due) {
      sleep_until_ns(std::min(due, now + kLongestNap));
      continue;
    }
    stopped_at = last;
    stop_devices(last, first_begin);
  }
}

void Watchdog::stop_devices(std::int64_t last_begin, std::int64_t first_begin) noexcept {
  stops_.fetch_add(1);  // before the stop, so that a loop that wakes sees it
  for (haptics::Device* device : devices_) device->stop();
  if (kept_.size() < haptics::WatchdogStop::kMaxKept) {
    kept_.push_back({tick_.load(std::memory_order_relaxed), last_begin + stalled_after_ns_ - first_begin});
  }
}

}  // namespace palpate::realtime
