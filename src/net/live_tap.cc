#include "net/live_tap.h"

#include <algorithm>

namespace palpate::net {

LiveTap::LiveTap(std::size_t hands)
    : hands_(static_cast<std::uint32_t>(std::min(hands, haptics::Snapshot::kMaxHands))) {}

void LiveTap::on_update(const haptics::ParameterUpdate& change) noexcept { change_ = change.number; }

void LiveTap::on_row(const haptics::TickRow& row) noexcept {
  if (row.hand >= hands_) return;
  if (row.fault != faults_[row.hand]) {
    faults_[row.hand] = row.fault;
    (void)turns_.push({row.tick, row.hand, static_cast<haptics::Fault>(row.fault)});
  }
  LiveTick& tick = ticks_.writable();
  tick.rows[row.hand] = row;
  if (row.hand + 1 < hands_) return;
  tick.tick = row.tick;
  tick.change = change_;
  tick.hands = hands_;
  ticks_.publish();
}

const LiveTick* LiveTap::newest() noexcept {
  seen_ = ticks_.refresh() || seen_;
  return seen_ ? &ticks_.value() : nullptr;
}

std::optional<FaultTurn> LiveTap::take_fault() noexcept {
  FaultTurn turn;
  return turns_.pop(turn) ? std::optional(turn) : std::nullopt;
}

}  // namespace palpate::net
