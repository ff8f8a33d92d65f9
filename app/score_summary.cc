#include "app/score_summary.h"

#include <cmath>
#include <ostream>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/make_world.h"
#include "palpate/units.h"

#include "app/preparation.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

std::string plural(std::size_t count, const std::string& thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// How far the first mark of a lump is from it [m].
double distance_of(const palpation::Score& score, std::size_t lump) {
  for (const palpation::Mark& mark : score.marks) {
    if (mark.first && mark.lump == lump) return mark.distance;
  }
  return 0.0;
}

}  // namespace

palpation::Scorer score_of(const record::Recording& recording, bool no_cache,
                           std::unique_ptr<haptics::SimulationWorld>& world) {
  const OrganPreparation preparation(no_cache);
  world = std::make_unique<haptics::SimulationWorld>(scene::make_world(recording.setup, preparation.how()));
  Progress bar("score");
  return palpation::score_recording(recording, world->contact,
                                    [&bar](double share) { bar.update(share, "scoring"); });
}

void print_score(std::ostream& out, const palpation::Score& score) {
  const auto percent = [](double share) { return fmt::format("{:.0f} %", 100.0 * share); };
  const auto mm = [](double length) { return fmt::format("{:.1f} mm", length / kMillimetre); };
  out << fmt::format("Found {} of {}, missed {}, {}", score.found, plural(score.lumps.size(), "lump"),
                     score.missed, plural(score.wrong, "false mark"));
  if (score.repeated > 0) out << ", " << plural(score.repeated, "repeated mark");
  out << '\n';
  for (std::size_t i = 0; i < score.lumps.size(); ++i) {
    const palpation::Lump& lump = score.lumps[i];
    out << fmt::format("  {:<16}{}\n", lump.name,
                       lump.found     ? "found, its mark is " + mm(distance_of(score, i)) + " away"
                       : lump.covered ? "missed, though it was touched"
                                      : "missed, never touched");
  }
  out << fmt::format("  coverage        {} of the organ's upper side\n", percent(score.coverage))
      << fmt::format("  time            {:.1f} s from the first contact, {:.1f} s of it in contact\n",
                     score.time, score.contact_time)
      << fmt::format("  path            {:.2f} m\n", score.path)
      << fmt::format("  force           mean {:.3f} N, largest {:.3f} N, variation {}\n", score.mean_force,
                     score.largest_force, percent(score.force_variation))
      << fmt::format("  force rate      {:.2f} N/s (low: smooth)\n", score.force_rate);
}

}  // namespace palpate::app
