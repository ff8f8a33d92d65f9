#include "app/window/overview.h"

#include <algorithm>

namespace palpate::app {
namespace {

/// Fills the columns up to `column` with the last one, because a short run has fewer ticks than columns.
void last_until(std::vector<PlotColumn>& depth, std::size_t column, double column_width) {
  while (!depth.empty() && depth.size() < column) {
    depth.push_back(
        {static_cast<double>(depth.size()) * column_width, depth.back().least, depth.back().most});
  }
}

HandOverview overview_of_hand(RecordedView& seen, std::uint32_t hand, double column_width) {
  HandOverview all;
  all.deepest = seen.frames().deepest(hand);
  std::uint32_t fault = 0;
  bool contact = false;
  for (std::uint64_t tick = 0; tick < seen.ticks(); ++tick) {
    const haptics::TickRow& row = seen.row(tick, hand);
    const double depth_mm = 1e3 * row.depth;
    all.deepest_mm = std::max(all.deepest_mm, depth_mm);
    const std::size_t column = static_cast<std::size_t>(tick * Overview::kColumns / seen.ticks());
    last_until(all.depth, column, column_width);
    if (all.depth.size() == column)
      all.depth.push_back({static_cast<double>(column) * column_width, depth_mm, depth_mm});
    all.depth.back().least = std::min(all.depth.back().least, depth_mm);
    all.depth.back().most = std::max(all.depth.back().most, depth_mm);
    if (row.phase != 0 && !contact) all.contacts.push_back({tick, tick});
    contact = row.phase != 0;
    if (contact) all.contacts.back().last = tick;
    if (row.fault != 0 && row.fault != fault) all.faults.push_back(tick);
    fault = row.fault;
  }
  last_until(all.depth, Overview::kColumns, column_width);
  return all;
}

}  // namespace

Overview overview_of(RecordedView& seen) {
  Overview all;
  all.column_width = seen.duration_s() / static_cast<double>(Overview::kColumns);
  for (std::uint32_t hand = 0; hand < seen.hands(); ++hand) {
    all.hands.push_back(overview_of_hand(seen, hand, all.column_width));
  }
  for (const haptics::ParameterUpdate& change : seen.recording().changes) all.changes.push_back(change.tick);
  return all;
}

std::optional<std::uint64_t> next_fault(const HandOverview& hand, std::uint64_t after) {
  if (hand.faults.empty()) return std::nullopt;
  const auto next = std::upper_bound(hand.faults.begin(), hand.faults.end(), after);
  return next == hand.faults.end() ? hand.faults.front() : *next;
}

ActiveParameters active_parameters(const record::Recording& recording, std::uint64_t tick) {
  const haptics::ParameterUpdate* last = nullptr;
  for (const haptics::ParameterUpdate& change : recording.changes) {
    if (change.tick <= tick) last = &change;
  }
  const noise::NoiseSettings& noise = recording.setup.noise;
  if (last == nullptr) return {recording.setup.tissue, {noise.enabled, noise.gain, noise.threshold}};
  return {haptics::tissue_of(*last), last->noise};
}

}  // namespace palpate::app
