#pragma once
#include <atomic>
#include <cmath>
#include <cstdint>

#include "core/base/spsc_queue.h"
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
  RowObserver() : ring_(kRoom) {}
  void on_row(const haptics::TickRow& row) noexcept override {
    if (!ring_.push(row)) left_out_.fetch_add(1, std::memory_order_relaxed);
  }

  /// [any] One thread. Takes the oldest row. @return false when no row is waiting
  [[nodiscard]] bool take(haptics::TickRow& row) noexcept { return ring_.pop(row); }
  /// [any] Number of rows dropped because the queue was full.
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kRoom = 1U << 14U;  // rows: 16 s of one hand at 1 kHz

  SpscQueue<haptics::TickRow> ring_;
  std::atomic<std::uint64_t> left_out_{0};
};

}  // namespace palpate::app
