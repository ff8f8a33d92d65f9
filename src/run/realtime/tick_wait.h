#pragma once
#include <cstdint>
#include <optional>

#include "palpate/run_control.h"
#include "run/realtime/realtime.h"

namespace palpate::realtime {

/// [any] Fraction of the time, 0..1, that a polling thread must sleep so that real-time throttling never
/// stops it.
/// @param budget none: Linux's default, 95 %
[[nodiscard]] double polling_sleep_fraction(const std::optional<RealtimeBudget>& budget) noexcept;

/// Sleeps of a polling thread: short sleeps right after ticks, well before the next deadline, give the
/// required fraction on average. Sleep that a late tick leaves no time for is made up after later ticks.
class PollingSleep final {
 public:
  /// [setup] @param share of the time to sleep, 0..1
  PollingSleep(double rate_Hz, double share) noexcept;

  /// [rt] Once per tick: time to sleep at `now` when the next tick is due at `due` [ns]; 0: no sleep.
  std::int64_t next(std::int64_t now, std::int64_t due) noexcept;

 private:
  double share_ns_;        // of a period
  double most_owed_;       // ns
  double owed_ = 0.0;      // ns
  std::int64_t shortest_;  // ns, shortest sleep
  std::int64_t margin_;    // ns between the end of a sleep and the next tick, because sleeps end late
};

/// Waits for the next tick by sleeping or polling.
class TickWait final {
 public:
  /// [setup]
  TickWait(haptics::Waiting waiting, double rate_Hz);

  /// [rt] Returns when monotonic_ns() has reached `due`, the time of the next tick; once a tick.
  void until(std::int64_t due) noexcept;

 private:
  haptics::Waiting waiting_;
  PollingSleep rest_;
};

}  // namespace palpate::realtime
