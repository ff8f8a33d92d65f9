#pragma once
#include <cstdint>
#include <optional>

#include "palpate/run_control.h"
#include "run/realtime/realtime.h"

namespace palpate::haptics {

/// [any] The share of the time that a polling thread must leave to others, 0..1, so that the kernel never
/// stops it for having used up its budget. @param budget none: Linux's own, 95 %
[[nodiscard]] double polling_rest_share(const std::optional<RealtimeBudget>& budget) noexcept;

/// When a polling thread rests: it sleeps a while right after a tick, well before the next one is due, so
/// that over time it sleeps its share. What a late tick leaves no room for is made up for after later ones.
class PollingRest final {
 public:
  /// [setup] @param share of the time to sleep, 0..1
  PollingRest(double rate_Hz, double share) noexcept;

  /// [rt] Once a tick: how long to sleep at `now` when the next tick is due at `due` [ns]; 0: not at all.
  std::int64_t next(std::int64_t now, std::int64_t due) noexcept;

 private:
  double share_ns_;        // of a period
  double most_owed_;       // ns
  double owed_ = 0.0;      // ns
  std::int64_t shortest_;  // ns; less is not worth a sleep
  std::int64_t margin_;    // ns between a rest's end and the next tick: sleeps end late
};

/// How a loop's thread gets from one tick to the next.
class TickWait final {
 public:
  /// [setup]
  TickWait(Waiting waiting, double rate_Hz);

  /// [rt] Returns when monotonic_ns() has reached `due`, the time of the next tick; once a tick.
  void until(std::int64_t due) noexcept;

 private:
  Waiting waiting_;
  PollingRest rest_;
};

}  // namespace palpate::haptics
