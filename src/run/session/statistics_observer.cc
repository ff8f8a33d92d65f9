#include "run/session/statistics_observer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/haptics/gate.h"

namespace palpate::session {
namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint32_t kGateBits =
    haptics::kForceClamped | haptics::kForceSlewed | haptics::kTorqueClamped | haptics::kTorqueSlewed;

double norm(const std::array<double, 3>& v) noexcept {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace

StatisticsObserver::StatisticsObserver(const scene::Scene& scene)
    : period_(1.0 / scene.rate_Hz),
      last_contact_tick_(kNever),
      last_limited_tick_(kNever),
      open_span_(scene.tools.size(), -1),
      last_phase_(scene.tools.size(), -1),
      last_row_(scene.tools.size()) {
  statistics_.phases.reserve(RunStatistics::kMaxSpans);
}

void StatisticsObserver::on_update(const haptics::ParameterUpdate& /*update*/) noexcept {
  ++statistics_.changes;
}

void StatisticsObserver::on_row(const haptics::TickRow& row) noexcept {
  statistics_.peak_force = std::max(statistics_.peak_force, norm(row.force));
  if (row.tissue_force > statistics_.peak_tissue) {
    statistics_.peak_tissue = row.tissue_force;
    statistics_.depth_at_peak = row.depth;
  }
  if (row.depth > statistics_.peak_depth) {
    statistics_.peak_depth = row.depth;
    statistics_.deepest_tick = row.tick;
    statistics_.deepest_hand = row.hand;
  }
  if (row.phase == 0 && row.fault == 0) statistics_.nearest = std::min(statistics_.nearest, row.distance);
  if (row.phase != 0 && row.tick != last_contact_tick_) {
    ++statistics_.contact_ticks;
    last_contact_tick_ = row.tick;
  }
  if ((row.status & kGateBits) != 0 && row.tick != last_limited_tick_) {
    ++statistics_.limited_ticks;
    last_limited_tick_ = row.tick;
  }
  statistics_.status |= row.status;
  follow_phase(row);
  follow_force(row);
}

void StatisticsObserver::follow_force(const haptics::TickRow& row) noexcept {
  LastRow& last = last_row_[row.hand];
  if (last.seen) {
    statistics_.fastest_rise =
        std::max(statistics_.fastest_rise, (row.tissue_force - last.tissue_force) / period_);
    for (std::size_t i = 0; i < 3; ++i) {  // force on the hand; the work on the organ has the opposite sign
      statistics_.dissipated -= 0.5 * (last.force[i] + row.force[i]) * (row.tool[i] - last.tool[i]);
    }
    statistics_.loading_work = std::max(statistics_.loading_work, statistics_.dissipated);
  }
  last = {true, row.tissue_force, row.force, row.tool};
}

void StatisticsObserver::follow_phase(const haptics::TickRow& row) noexcept {
  if (last_phase_[row.hand] != static_cast<std::int64_t>(row.phase)) {
    last_phase_[row.hand] = static_cast<std::int64_t>(row.phase);
    open_span_[row.hand] = -1;
    if (statistics_.phases.size() < RunStatistics::kMaxSpans) {
      open_span_[row.hand] = static_cast<std::int64_t>(statistics_.phases.size());
      statistics_.phases.push_back({row.hand, row.phase, row.time, row.time});  // capacity is reserved
    } else {
      ++statistics_.phases_left_out;
    }
  }
  const std::int64_t open = open_span_[row.hand];
  if (open >= 0) statistics_.phases[static_cast<std::size_t>(open)].to = row.time + period_;
}

}  // namespace palpate::session
