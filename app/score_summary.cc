#include "app/score_summary.h"

#include <ostream>

#include <fmt/core.h>

#include "palpate/units.h"

#include "app/progress.h"

namespace palpate::app {
namespace {

/// How far the first mark of a lump is from it [m].
double distance_of(const palpation::Score& score, std::size_t lump) {
  for (const palpation::Mark& mark : score.marks) {
    if (mark.first && mark.lump == lump) return mark.distance;
  }
  return 0.0;
}

}  // namespace

palpation::ScoredRecording score_of(const record::Recording& recording, bool no_cache) {
  const OrganPreparation preparation(no_cache);
  Progress bar("score");
  return {recording, preparation.how(), [&bar](double share) { bar.update(share, "scoring"); }};
}

void print_score(std::ostream& out, const palpation::Score& score) {
  for (const palpation::Measure& one : palpation::measures(score)) {
    out << fmt::format("{:<20}{}\n", one.name, one.value);
  }
  for (std::size_t i = 0; i < score.lumps.size(); ++i) {
    const palpation::Lump& lump = score.lumps[i];
    out << fmt::format(
        "{:<20}{}\n", lump.name,
        lump.found     ? fmt::format("found, its mark is {:.1f} mm away", distance_of(score, i) / kMillimetre)
        : lump.covered ? "missed, though it was touched"
                       : "missed, never touched");
  }
}

}  // namespace palpate::app
