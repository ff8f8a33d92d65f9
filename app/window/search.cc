#include "app/window/search.h"

#include <algorithm>
#include <cmath>

#include "core/haptics/simulation.h"
#include "io/system/clock.h"
#include "view/report/palpation_report.h"

namespace palpate::app {

Search::Search(const Session& session)
    : session_(session), scorer_(session.setup(), session.world().contact) {}

void Search::end() {
  if (score_) return;
  score_ = scorer_.score();
  shows_map = true;
}

double Search::pointer_gain(const Traces& traces) const {
  constexpr double kLeastDepth = 1e-3;  // m
  constexpr double kLeastGain = 0.25;
  double gain = 1.0;
  for (std::uint32_t hand = 0; hand < session_.hands(); ++hand) {
    const haptics::TickRow& row = traces.newest(hand);
    if (static_cast<contact::Phase>(row.phase) != contact::Phase::kPress || row.depth < kLeastDepth) continue;
    const double uniform = session_.world().contact.press_law().force_at(row.depth).force;
    const double softness = uniform / std::max(palpation::normal_force(row), 1e-9);
    gain = std::min(gain, std::max(kLeastGain, softness * softness * softness));
  }
  return gain;
}

/// Widens the colours' range in few steps, because each new range assigns all colours again.
void Search::widen_range() {
  const report::FactorRange range = report::range_of(scorer_.map());
  while (range.high > high_ + 1e-9) high_ = 1.0 + 2.0 * (high_ - 1.0);
  while (range.low < low_ - 0.1) low_ -= 0.2;
}

void Search::draw_on(LivePicture& picture, bool now) {
  constexpr std::int64_t kPeriodNs = 200'000'000;
  if (!now && monotonic_ns() < next_ns_) return;
  next_ns_ = monotonic_ns() + kPeriodNs;
  if (shows_map) {
    widen_range();
    picture.show_values(scorer_.map().surface().vertices, report::felt_factors(scorer_.map()), low_, high_);
  } else {
    picture.show_values({}, {}, low_, high_);
  }
  if (score_) {
    picture.show_marks(report::marks_of(*score_));
    return;
  }
  palpation::Score hidden;  // during the search no mark shows whether it is right
  hidden.marks = scorer_.marks();
  for (palpation::Mark& mark : hidden.marks) mark.lump = 0;
  picture.show_marks(report::marks_of(hidden));
}

SearchStatus Search::status() const {
  SearchStatus status;
  status.score = score_;
  status.shows_map = shows_map;
  status.low = low_;
  status.high = high_;
  status.marks = scorer_.marks().size();
  const palpation::Score now = score_ ? *score_ : scorer_.score();
  status.lumps = now.lumps.size();
  status.coverage = now.coverage;
  return status;
}

}  // namespace palpate::app
