#pragma once
#include <atomic>
#include <cstdint>

#include "core/base/ring.h"
#include "palpate/tick_observer.h"

namespace palpate::app {

/// What the window's plots and accounts need of a row. SI.
struct RowSample {
  double time = 0.0;
  std::uint64_t tick = 0;
  std::uint32_t hand = 0;
  std::uint32_t phase = 0;
  double distance = 0.0;
  double depth = 0.0;
  double force = 0.0;         // norm of what went to the device
  double tissue_force = 0.0;  // before the gate
  double noise_force = 0.0;
  double engagement = 1.0;
  std::int64_t tick_ns = 0;
  std::int64_t late_ns = 0;
  std::uint32_t status = 0;
  std::uint32_t fault = 0;
};

/// [any] What of a row the window needs.
[[nodiscard]] RowSample sample_of_row(const haptics::TickRow& row) noexcept;

/// Lets a window see the rows of a running loop. When the window does not keep up, rows are left out and
/// counted: the loop never waits.
class RowTap final : public haptics::TickObserver {
 public:
  /// [setup]
  RowTap() : ring_(kRoom) {}
  void on_row(const haptics::TickRow& row) noexcept override;

  /// [any] One thread. The oldest row not yet taken. @return false when there is none
  [[nodiscard]] bool take(RowSample& sample) noexcept { return ring_.pop(sample); }
  /// [any] Rows that found no room.
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kRoom = 1U << 15U;  // rows: 32 s of one hand at 1 kHz

  Ring<RowSample> ring_;
  std::atomic<std::uint64_t> left_out_{0};
};

}  // namespace palpate::app
