#include "fit/validate/validation_sets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "io/system/clock.h"
#include "palpate/spring_law.h"
#include "palpate/validate.h"

namespace palpate::validate {
namespace {

/// CPU time of a call [ns]: the shortest of several batches, each long enough for the clock.
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
  volatile double kept = sum;  // keeps the compiler from removing the calls
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

void add(BaselineFit fit, double largest, std::vector<BaselineResult>& baselines) {
  BaselineResult result;
  result.cost_ns = call_ns(fit.evaluate, largest);
  result.fit = std::move(fit);
  baselines.push_back(std::move(result));
}

}  // namespace

ForceSet compare_forces(const identify::Specimen& specimen, const Law& law, const Zeros& given, bool fitted) {
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
  model::FalloffRatios& reach = validation.law.tissue.reach;
  std::vector<ProfileSample> samples;
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    // Rejects a profile without depth.
    const DeformationComparison comparison =
        compare_deformation(profiles[i], reach, depths[i], tip_radius, rule);
    samples.push_back({profiles[i], comparison.depth, tip_radius});
  }
  if (fit_first) {
    validation.reach = fit_falloff(samples, rule, reach.depth_exponent);
    reach = validation.reach->reach;
  }
  for (const ProfileSample& sample : samples) {
    ProfileSet set;
    set.ours = compare_deformation(sample.deformation, reach, sample.depth, tip_radius, rule);
    validation.profiles.push_back(std::move(set));
  }
}

void compare_with_baselines(const std::vector<BaselineKind>& kinds, Validation& validation) {
  for (ForceSet& set : validation.forces) {
    const std::vector<double>& displacement = set.ours.measured.displacement;
    const double deepest =
        *std::max_element(displacement.begin(), displacement.end()) - set.ours.zeros.first_contact;
    for (const BaselineKind kind : kinds) {
      add(fit_force_baseline(kind, set.ours), deepest, set.baselines);
    }
    set.cost_ns = law_ns(validation.law, deepest);
  }
  for (ProfileSet& set : validation.profiles) {
    const double farthest = set.ours.measured.distance.back();
    for (const BaselineKind kind : kinds) {
      add(fit_profile_baseline(kind, set.ours), farthest, set.baselines);
    }
    const BallSurface surface(validation.law.tissue.reach, set.ours.depth, set.ours.tip_radius,
                              set.ours.rule);
    set.cost_ns = call_ns([&surface](double r) { return surface.at(r); }, farthest);
  }
}

}  // namespace palpate::validate
