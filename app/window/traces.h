#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>

#include "palpate/histogram.h"
#include "palpate/tick_row.h"

#include "app/row_observer.h"

namespace palpate::app {

/// [any] Norm of the device's force [N].
[[nodiscard]] inline double device_force(const haptics::TickRow& row) noexcept {
  return std::hypot(row.force[0], row.force[1], row.force[2]);
}

/// The window's copy of a run's rows: the last seconds, each hand's newest row, and statistics of the timing.
/// All members: [setup], the window's thread.
class Traces final {
 public:
  static constexpr double kKept = 8.0;  // s

  explicit Traces(double rate_Hz) : period_ns_(1e9 / rate_Hz) {}

  /// Takes all new rows. @param keep false while the picture is held: then only the statistics are updated
  /// @param each is called with every row; may be empty
  void take(RowObserver& observer, bool keep, const std::function<void(const haptics::TickRow&)>& each = {});

  /// Rows of one hand in the last kKept seconds, oldest first.
  [[nodiscard]] const std::deque<haptics::TickRow>& of_hand(std::uint32_t hand) const { return kept_[hand]; }
  [[nodiscard]] const haptics::TickRow& newest(std::uint32_t hand) const { return newest_[hand]; }
  [[nodiscard]] double newest_time() const noexcept { return newest_time_; }
  /// Since the last call: root mean square of the noise [N] and largest tissue force [N].
  struct NoiseStatistics {
    double noise = 0.0;
    double tissue = 0.0;
  };
  [[nodiscard]] NoiseStatistics take_noise_statistics();

  [[nodiscard]] const haptics::Histogram& tick_time() const noexcept { return tick_time_; }
  [[nodiscard]] const haptics::Histogram& lateness() const noexcept { return lateness_; }
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  double period_ns_;
  std::array<std::deque<haptics::TickRow>, kMaxHands> kept_;
  std::array<haptics::TickRow, kMaxHands> newest_{};
  double newest_time_ = 0.0;
  haptics::Histogram tick_time_;
  haptics::Histogram lateness_;
  std::uint64_t missed_ = 0;
  double noise_squares_ = 0.0;
  double largest_tissue_ = 0.0;
  std::uint64_t statistics_rows_ = 0;
};

}  // namespace palpate::app
