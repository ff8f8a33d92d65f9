#pragma once
#include <cmath>
#include <cstdint>

namespace palpate::realtime {

/// Deadlines of ticks: an anchor plus whole periods, so that rounding does not accumulate. A tick that begins
/// a full period or more late moves the anchor to its begin: missed time is not made up by a burst, and no
/// tick number is skipped.
class Schedule final {
 public:
  /// [setup] @param first_due monotonic time of the first tick [ns]
  Schedule(double rate_Hz, std::int64_t first_due) noexcept : period_ns_(1e9 / rate_Hz), anchor_(first_due) {}

  /// [rt] When the next tick is due [ns].
  [[nodiscard]] std::int64_t due() const noexcept {
    return anchor_ + std::llround(static_cast<double>(since_anchor_) * period_ns_);
  }

  struct Begin {
    std::int64_t late_ns = 0;  // never negative
    bool missed = false;       // a full period or more late
  };

  /// [rt] The tick due begins at `now` [ns]; due() then gives the next deadline.
  Begin begin(std::int64_t now) noexcept {
    const std::int64_t late = now - due();
    const bool missed = static_cast<double>(late) >= period_ns_;
    if (missed) {
      anchor_ = now;
      since_anchor_ = 0;
    }
    ++since_anchor_;
    return {late > 0 ? late : 0, missed};
  }

 private:
  double period_ns_;
  std::int64_t anchor_;
  std::int64_t since_anchor_ = 0;
};

}  // namespace palpate::realtime
