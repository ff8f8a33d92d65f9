#include "net/live_observer.h"

#include <algorithm>

namespace palpate::net {

LiveObserver::LiveObserver(std::size_t hands, double rate_Hz)
    : hands_(static_cast<std::uint32_t>(std::min(hands, kMaxHands))), period_ns_(1e9 / rate_Hz) {}

void LiveObserver::on_update(const haptics::ParameterUpdate& change) noexcept { change_ = change.number; }

void LiveObserver::on_row(const haptics::TickRow& row) noexcept {
  if (row.hand >= hands_) return;
  if (row.fault != faults_[row.hand]) {
    faults_[row.hand] = row.fault;
    (void)transitions_.push({row.tick, row.hand, static_cast<haptics::Fault>(row.fault)});
  }
  LiveTick& tick = ticks_.writable();
  tick.rows[row.hand] = row;
  if (row.hand + 1 < hands_) return;
  tick.tick = row.tick;
  tick.change = change_;
  if (static_cast<double>(row.late_ns) >= period_ns_) ++missed_;  // all rows of a tick carry its times
  tick.missed = missed_;
  tick.hands = hands_;
  ticks_.publish();
}

const LiveTick* LiveObserver::newest() noexcept {
  seen_ = ticks_.refresh() || seen_;
  return seen_ ? &ticks_.value() : nullptr;
}

std::optional<FaultTransition> LiveObserver::take_fault() noexcept {
  FaultTransition turn;
  return transitions_.pop(turn) ? std::optional(turn) : std::nullopt;
}

}  // namespace palpate::net
