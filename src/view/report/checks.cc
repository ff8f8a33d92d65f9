// Results of an experiment in sentences, each marked as met or not.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "view/report/page.h"
#include "view/report/sections.h"

namespace palpate::report {
namespace {

constexpr double kPaperForceNs = 1e6;  // "under 1 ms a force" [Zhang 2011, section 3.2]

Mark mark_of(bool met) { return met ? Mark::kMet : Mark::kMissed; }

Check noise_check_of(const NormalCheck& check) {
  const double count = static_cast<double>(check.count);
  const double mean_bound = 4.0 / std::sqrt(count);
  const double deviation_bound = 4.0 / std::sqrt(2.0 * count);
  const double ks_bound = 1.95 / std::sqrt(count);  // bound of the Kolmogorov-Smirnov statistic that 999 of
                                                    // 1000 normal samples pass
  const bool met = std::abs(check.mean) <= mean_bound &&
                   std::abs(check.standard_deviation - 1.0) <= deviation_bound &&
                   check.ks_distance <= ks_bound;
  return {mark_of(met),
          fmt::format("Noise over its set standard deviation, {} samples: mean {} (bound ±{}), "
                      "standard deviation {} (1 ± {}), Kolmogorov-Smirnov distance {} (bound {}).",
                      grouped(check.count), fixed(check.mean, 4), fixed(mean_bound, 4),
                      fixed(check.standard_deviation, 4), fixed(deviation_bound, 4),
                      fixed(check.ks_distance, 4), fixed(ks_bound, 4))};
}

/// The faults of all hands in one paragraph; empty: none.
std::string all_faults(const Analysis& analysis) {
  constexpr std::size_t kMaxListed = 8;
  std::string text;
  std::size_t listed = 0;
  for (const HandAnalysis& hand : analysis.hands) {
    for (const std::string& fault : faults_text(hand.rows)) {
      if (++listed > kMaxListed) continue;
      text += fmt::format("{}{}: {}", text.empty() ? "Hand " : "; hand ", hand.hand, fault);
    }
  }
  if (listed > kMaxListed) text += fmt::format("; and {} more", listed - kMaxListed);
  return text.empty() ? text : escaped(text + ".");
}

Check depth_check(const ExperimentResults& worked) {
  const double depth = main_hand(worked).peak_depth;
  const double goal = worked.experiment->goal_depth;
  const std::string reached = fmt::format("{} to {} mm",
                                          is_pull(worked)              ? "Pulled"
                                          : went_in(main_hand(worked)) ? "Inserted"
                                                                       : "Pressed",
                                          fixed(depth * kMilli, 2));
  if (!(goal > 0.0)) return {Mark::kInformation, reached + "."};
  return {mark_of(depth >= goal), fmt::format("{}; the goal is {} mm.", reached, fixed(goal * kMilli, 0))};
}

Check law_check(const HandAnalysis& hand, const scene::Scene& scene) {
  const bool uniform = scene.inclusions.empty() && scene.stiffness.empty();
  return {Mark::kInformation,
          fmt::format("Normal force beside the law of {}, over {} ticks: half within {} mN, 95\u00a0% within "
                      "{} mN; the law's largest is {} N.",
                      uniform ? "one contact" : "the uniform tissue", grouped(hand.law.rows),
                      fixed(hand.law.median * kMilli, 2), fixed(hand.law.p95 * kMilli, 2),
                      fixed(hand.law.peak, 3))};
}

}  // namespace

Check deadline_check(std::uint64_t missed, std::uint64_t ticks) {
  std::string text = fmt::format("Missed deadlines: {} of {} ticks began a full period or more late",
                                 grouped(missed), grouped(ticks));
  if (missed == 0) return {Mark::kMet, text + "."};
  const double share = static_cast<double>(missed) / static_cast<double>(ticks);
  text += fmt::format(" ({}). ", percent(share, 2));
  if (share <= kUsualLateShare) {
    return {
        Mark::kLate,
        text + fmt::format("Up to {} is usual where a machine shares its processor with other work, as a "
                           "virtual machine does. Late ticks are computed all the same, none is left out. "
                           "<code>palpate doctor</code> names what this machine lacks for real time.",
                           percent(kUsualLateShare, 1))};
  }
  return {Mark::kMissed, text + fmt::format("That is more than the {} that is usual on a shared machine: a "
                                            "hand can feel it. <code>palpate doctor</code> names what this "
                                            "machine lacks for real time.",
                                            percent(kUsualLateShare, 1))};
}

std::vector<Check> checks_of(const ExperimentResults& worked) {
  const Analysis& analysis = worked.analysis;
  const HandAnalysis& hand = main_hand(worked);
  const record::Recording& recording = *worked.experiment->recording;
  std::vector<Check> checks = {depth_check(worked)};
  if (hand.law.rows > 0) checks.push_back(law_check(hand, recording.scene));
  if (hand.noise_check.count > 1) checks.push_back(noise_check_of(hand.noise_check));
  if (is_timed(analysis)) {
    const bool fast = static_cast<double>(analysis.tick_time.figures.p99) < kPaperForceNs;
    checks.push_back({mark_of(fast),
                      fmt::format("A tick took {} µs (p50), {} µs (p99); the paper's force took under 1 ms.",
                                  microseconds(analysis.tick_time.figures.p50),
                                  microseconds(analysis.tick_time.figures.p99))});
  }
  if (!recording.facts.offline) checks.push_back(deadline_check(analysis.missed, analysis.ticks));
  const std::string faults = all_faults(analysis);
  checks.push_back({mark_of(faults.empty()), faults.empty() ? "No fault was latched." : faults});
  if (recording.facts.watchdog_stops > 0) {
    checks.push_back({Mark::kMissed, "The watchdog stopped the devices, as no tick began for too long: " +
                                         grouped(recording.facts.watchdog_stops) + " times."});
  }
  return checks;
}

}  // namespace palpate::report
