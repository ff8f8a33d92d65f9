#include "app/window/search.h"

#include <algorithm>
#include <cmath>

#include "core/haptics/simulation.h"

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
    const double normal =
        std::sqrt(std::max(0.0, row.tissue_force * row.tissue_force - row.friction * row.friction));
    const double uniform = session_.world().contact.press_law().force_at(row.depth).force;
    const double softness = uniform / std::max(normal, 1e-9);
    gain = std::min(gain, std::max(kLeastGain, softness * softness * softness));
  }
  return gain;
}

SearchStatus Search::status() const {
  SearchStatus status;
  status.score = score_;
  status.shows_map = shows_map;
  status.marks = scorer_.marks().size();
  const palpation::Score now = score_ ? *score_ : scorer_.score();
  status.lumps = now.lumps.size();
  status.coverage = now.coverage;
  return status;
}

}  // namespace palpate::app
