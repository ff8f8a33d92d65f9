#include "science/fit/validation_sets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "io/system/clock.h"
#include "palpate/spring_law.h"
#include "palpate/validation.h"

namespace palpate::fit {
namespace {

/// Processor time of one call [ns]: the least of several batches, each long enough for the clock.
template <typename Call>
double call_ns(const Call& call, double largest) {
  constexpr std::int64_t kLongEnough = 2'000'000;  // ns
  constexpr int kBatches = 5;
  double least = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (int batch = 0; batch < kBatches; ++batch) {
    std::int64_t spent = 0;
    int calls = 0;
    for (int more = 1; spent < kLongEnough; more *= 2) {
      const std::int64_t begun = thread_cpu_ns();
      for (int i = 0; i < more; ++i) sum += call(largest * (i % 101 + 1) / 101.0);
      spent += thread_cpu_ns() - begun;
      calls += more;
    }
    least = std::min(least, static_cast<double>(spent) / calls);
  }
  volatile double kept = sum;  // so that no call can be left out
  static_cast<void>(kept);
  return least;
}

double law_ns(const Law& law, double deepest) {
  if (law.tissue.law == model::LawKind::kSmooth) {
    const model::SmoothSpringLaw springs(law.tissue, law.direction, law.period);
    return call_ns([&springs](double depth) { return springs.force_at(depth).force; }, deepest);
  }
  const model::LayeredSpringLaw springs(law.tissue, law.direction, law.period);
  return call_ns([&springs](double depth) { return springs.force_at(depth).force; }, deepest);
}

void add(RivalFit fit, double largest, std::vector<RivalResult>& rivals) {
  RivalResult result;
  result.cost_ns = call_ns(fit.evaluate, largest);
  result.fit = std::move(fit);
  rivals.push_back(std::move(result));
}

/// The share of places where the model lies within what the pictures are uncertain by.
double within_uncertainty(const ImageSet& set) {
  std::vector<ImagePoint> points = set.measured.points;
  std::stable_sort(points.begin(), points.end(),
                   [](const ImagePoint& a, const ImagePoint& b) { return a.r < b.r; });
  std::size_t within = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double off = set.comparison.computed[i] - points[i].u;
    within += std::abs(off) <= points[i].uncertainty ? 1 : 0;
  }
  return static_cast<double>(within) / static_cast<double>(points.size());
}

}  // namespace

ForceSet compare_forces(const Specimen& specimen, const Law& law, const Zeros& given, bool fitted) {
  const ZerosFit best = fit_zeros(specimen, law);
  ForceComparison with_given = compare_force(specimen, law, given);
  ForceComparison with_best = compare_force(specimen, law, best.zeros);
  ForceSet set;
  set.zeros_fitted = fitted;
  set.given = {with_given.zeros, with_given.errors};
  set.fitted = {with_best.zeros, with_best.errors, best.at_limit};
  set.ours = std::move(fitted ? with_best : with_given);
  return set;
}

void compare_profiles(const std::vector<Deformation>& profiles, const std::vector<double>& depths,
                      double tip_radius, bool fit_first, Validation& validation, const SurfaceRule& rule) {
  model::ReachParameters& reach = validation.law.tissue.reach;
  std::vector<ReachSample> samples;
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    // Refuses what has no depth.
    const DeformationComparison comparison =
        compare_deformation(profiles[i], reach, depths[i], tip_radius, rule);
    samples.push_back({profiles[i], comparison.depth, tip_radius});
  }
  if (fit_first) {
    validation.reach = fit_reach(samples, rule, reach.depth_exponent);
    reach = validation.reach->reach;
  }
  for (const ReachSample& sample : samples) {
    ProfileSet set;
    set.ours = compare_deformation(sample.deformation, reach, sample.depth, tip_radius, rule);
    validation.profiles.push_back(std::move(set));
  }
}

ImageSet compare_photographs(const std::filesystem::path& before, const std::filesystem::path& after,
                             const ImageSettings& settings, const Law& law, double depth, double tip_radius) {
  ImageSet set;
  set.settings = settings;
  set.before = read_picture(before);
  set.after = read_picture(after);
  set.measured = measure_pictures(set.before, set.after, set.settings, before.string(), after.string());
  const Deformation deformation = deformation_of(set.measured, after.string());
  if (!(depth > 0.0)) depth = deformation.depth;
  if (!(depth > 0.0)) {
    depth = nearest_depth(deformation, law.tissue.reach, tip_radius);
    set.depth_fitted = true;
  }
  set.comparison = compare_deformation(deformation, law.tissue.reach, depth, tip_radius);
  set.within_uncertainty = within_uncertainty(set);
  return set;
}

void compare_with_rivals(const std::vector<RivalKind>& kinds, Validation& validation) {
  for (ForceSet& set : validation.forces) {
    const std::vector<double>& displacement = set.ours.measured.displacement;
    const double deepest =
        *std::max_element(displacement.begin(), displacement.end()) - set.ours.zeros.first_contact;
    for (const RivalKind kind : kinds) {
      add(fit_force_rival(kind, set.ours), deepest, set.rivals);
    }
    set.cost_ns = law_ns(validation.law, deepest);
  }
  for (ProfileSet& set : validation.profiles) {
    const double farthest = set.ours.measured.distance.back();
    for (const RivalKind kind : kinds) {
      add(fit_profile_rival(kind, set.ours), farthest, set.rivals);
    }
    const BallSurface surface(validation.law.tissue.reach, set.ours.depth, set.ours.tip_radius,
                              set.ours.rule);
    set.cost_ns = call_ns([&surface](double r) { return surface.at(r); }, farthest);
  }
}

}  // namespace palpate::fit
