#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "core/base/spsc_queue.h"
#include "palpate/tick_observer.h"
#include "palpate/triple_buffer.h"

namespace palpate::net {

/// All rows of one tick, published together.
struct LiveTick {
  std::uint64_t tick = 0;
  std::uint64_t change = 0;  // number of the newest parameter update in effect; 0: none
  std::uint64_t missed = 0;  // ticks so far that began a full period or more late
  std::uint32_t hands = 0;
  std::array<haptics::TickRow, kMaxHands> rows{};
};

/// A hand's fault was latched or reset.
struct FaultTransition {
  std::uint64_t tick = 0;
  std::uint32_t hand = 0;
  haptics::Fault fault = haptics::Fault::kNone;  // kNone: reset
};

/// Observes the rows of a run for a stream: the newest tick, and every latched or reset fault. The loop never
/// waits.
class LiveObserver final : public haptics::TickObserver {
 public:
  /// [setup] @param hands of the scene @param rate_Hz of its ticks
  LiveObserver(std::size_t hands, double rate_Hz);
  void on_update(const haptics::ParameterUpdate& change) noexcept override;
  void on_row(const haptics::TickRow& row) noexcept override;

  /// [any] The newest tick; null before the first. Call from one thread.
  [[nodiscard]] const LiveTick* newest() noexcept;
  /// [any] The oldest fault change not yet taken. Call from the thread of newest().
  [[nodiscard]] std::optional<FaultTransition> take_fault() noexcept;

 private:
  static constexpr std::size_t kMaxTransitions = 256;  // more between two calls are dropped

  std::uint32_t hands_;
  double period_ns_;
  std::uint64_t change_ = 0;
  std::uint64_t missed_ = 0;
  std::array<std::uint32_t, kMaxHands> faults_{};
  TripleBuffer<LiveTick> ticks_;
  SpscQueue<FaultTransition> transitions_{kMaxTransitions};
  bool seen_ = false;  // a tick was read
};

}  // namespace palpate::net
