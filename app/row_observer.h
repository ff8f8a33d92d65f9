#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/base/spsc_queue.h"
#include "palpate/parameter_updates.h"
#include "palpate/tick_observer.h"

namespace palpate::app {

/// Passes the rows of a running loop to another thread. When that is too slow, rows are dropped and counted;
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

}  // namespace palpate::app
