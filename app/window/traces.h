#pragma once
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "core/base/spsc_queue.h"
#include "palpate/histogram.h"
#include "palpate/parameter_updates.h"
#include "palpate/tick_observer.h"

namespace palpate::app {

/// [any] Norm of the device's force [N].
[[nodiscard]] inline double device_force(const haptics::TickRow& row) noexcept {
  return std::hypot(row.force[0], row.force[1], row.force[2]);
}

/// Passes the rows of a running loop to a window. When the window is too slow, rows are dropped and counted;
/// the loop never waits.
class RowObserver final : public haptics::TickObserver {
 public:
  /// [setup]
  RowObserver() : ring_(kRoom), updates_(kUpdateRoom) {}
  void on_start(std::int64_t started_unix_ns) noexcept override {
    started_unix_ns_.store(started_unix_ns, std::memory_order_relaxed);
  }
  void on_update(const haptics::ParameterUpdate& update) noexcept override {
    if (!updates_.push(update)) left_out_.fetch_add(1, std::memory_order_relaxed);
  }
  void on_row(const haptics::TickRow& row) noexcept override {
    if (!ring_.push(row)) left_out_.fetch_add(1, std::memory_order_relaxed);
  }

  /// [any] One thread. Takes the oldest row. @return false when no row is waiting
  [[nodiscard]] bool take(haptics::TickRow& row) noexcept { return ring_.pop(row); }
  /// [any] One thread. Takes the oldest parameter update. It waits before the rows of its tick do.
  [[nodiscard]] bool take(haptics::ParameterUpdate& update) noexcept { return updates_.pop(update); }
  /// [any] Wall time of tick 0; 0 before it.
  [[nodiscard]] std::int64_t started_unix_ns() const noexcept {
    return started_unix_ns_.load(std::memory_order_relaxed);
  }
  /// [any] Number of rows and updates dropped because a queue was full.
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kRoom = 1U << 14U;  // rows: 16 s of one hand at 1 kHz

  static constexpr std::size_t kUpdateRoom = 4096;  // updates: at most one a tick

  SpscQueue<haptics::TickRow> ring_;
  SpscQueue<haptics::ParameterUpdate> updates_;
  std::atomic<std::int64_t> started_unix_ns_{0};
  std::atomic<std::uint64_t> left_out_{0};
};

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
