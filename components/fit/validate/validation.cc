#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/system/clock.h"
#include "io/system/plausible.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"
#include "palpate/units.h"
#include "palpate/validate.h"

#include "fit/identify/least_squares.h"
#include "fit/validate/validation_sets.h"

namespace palpate::validate {
namespace {

/// Calls `ask` with the law that the tissue has.
template <typename Ask>
auto with_law(const Law& law, const Ask& ask) {
  if (law.tissue.law == model::LawKind::kSmooth) {
    return ask(model::SmoothSpringLaw(law.tissue, law.direction, law.period));
  }
  return ask(model::LayeredSpringLaw(law.tissue, law.direction, law.period));
}

constexpr double kQuarterTurn = 0.5 * std::numbers::pi;

/// Height of a ball's surface above its lowest point, at a distance from its axis.
double sag(double radius, double aside) noexcept {
  return radius - std::sqrt(std::max(0.0, radius * radius - aside * aside));
}

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
  return with_law(law, [deepest](const auto& springs) {
    return call_ns([&springs](double depth) { return springs.force_at(depth).force; }, deepest);
  });
}

void add(BaselineFit fit, double largest, std::vector<BaselineResult>& baselines) {
  BaselineResult result;
  result.cost_ns = call_ns(fit.evaluate, largest);
  result.fit = std::move(fit);
  baselines.push_back(std::move(result));
}

}  // namespace

Errors errors_of(const std::vector<double>& measured, const std::vector<double>& computed, double scale) {
  Errors errors;
  errors.scale = scale;
  double squares = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double error = computed[i] - measured[i];
    squares += error * error;
    errors.max = std::max(errors.max, std::abs(error));
  }
  errors.rms = std::sqrt(squares / static_cast<double>(measured.size()));
  errors.nrmse = errors.rms / scale;
  if (!std::isfinite(errors.nrmse) || !std::isfinite(errors.max)) {
    throw InputError("the comparison gives no number: look at the units of the data and of the tissue");
  }
  return errors;
}

std::vector<double> Law::forces_at(const std::vector<double>& depths, std::size_t& beyond) const {
  beyond = 0;
  return with_law(*this, [&](const auto& springs) {
    std::vector<double> forces;
    for (const double depth : depths) {
      const model::ContactResponse response = springs.force_at(depth);
      forces.push_back(response.force);
      beyond += response.saturated || response.extrapolated ? 1 : 0;
    }
    return forces;
  });
}

double Law::depth_under(double force) const {
  return with_law(*this, [&](const auto& springs) {
    const auto state = springs.deformation_under(force);
    if (state.saturated) {
      throw InputError(fmt::format(
          "a force of {} N: must be at most {} N, the largest that the layers of tissue {} can take",
          shortest(force), shortest(springs.max_force()), tissue.name));
    }
    if (state.depth > kDepthRange.possible.high) {
      throw InputError(fmt::format(
          "a force of {} N presses tissue {} by {}, must be at most {}: is it in mN?", shortest(force),
          tissue.name, in_unit(kDepthRange, state.depth), in_unit(kDepthRange, kDepthRange.possible.high)));
    }
    return state.depth;
  });
}

ForceComparison compare_force(const identify::Specimen& specimen, const Law& law, const Zeros& zeros) {
  ForceComparison comparison;
  comparison.measured = identify::thinned(specimen, kMaxPoints);
  comparison.rows = specimen.size();
  comparison.zeros = zeros;
  const identify::Specimen& measured = comparison.measured;
  std::vector<double> depths;
  for (const double displacement : measured.displacement)
    depths.push_back(displacement - zeros.first_contact);
  std::vector<double> force = law.forces_at(depths, comparison.beyond);
  if (!law.tissue.relaxation.empty() && measured.time.size() > 1) {
    identify::relax(law.tissue.relaxation, measured.time, force);
  }
  std::size_t within = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    force[i] = std::max(0.0, force[i]) + zeros.force;
    const double loaded = std::abs(measured.force[i] - zeros.force);
    within += std::abs(force[i] - measured.force[i]) <= kForceJnd * loaded ? 1 : 0;
  }
  const auto [least, most] = std::minmax_element(measured.force.begin(), measured.force.end());
  comparison.errors = errors_of(measured.force, force, *most - *least);
  comparison.within_jnd = static_cast<double>(within) / static_cast<double>(force.size());
  comparison.computed = std::move(force);
  return comparison;
}

DeformationComparison compare_deformation(const Deformation& deformation, const model::FalloffRatios& reach,
                                          double depth, double tip_radius, const SurfaceRule& rule) {
  DeformationComparison comparison;
  comparison.rule = rule;
  comparison.measured = deformation;
  comparison.depth = depth > 0.0 ? depth : deformation.depth;
  comparison.tip_radius = tip_radius;
  if (!(comparison.depth > 0.0)) {
    throw InputError(deformation.name +
                     ": the depth is missing: give --depth-mm or --force-N, or a column depth_mm");
  }
  const double largest = *std::max_element(deformation.displacement.begin(), deformation.displacement.end());
  if (largest > 2.0 * comparison.depth) {
    throw InputError(fmt::format("{}: u_mm goes to {}, must be at most twice the depth, {} mm",
                                 deformation.name, shortest(largest / kMillimetre),
                                 shortest(comparison.depth / kMillimetre)));
  }
  const BallSurface surface(reach, comparison.depth, tip_radius, rule);
  for (const double r : deformation.distance) comparison.computed.push_back(surface.at(r));
  comparison.errors = errors_of(deformation.displacement, comparison.computed, comparison.depth);
  return comparison;
}

BallSurface::BallSurface(const model::FalloffRatios& reach, double depth, double radius,
                         const SurfaceRule& rule) noexcept
    : profile_(reach, depth, radius, rule.as_drawn ? 0.0 : radius),
      depth_(depth),
      radius_(radius),
      rule_(rule) {}

double BallSurface::at(double r) const noexcept {
  const double u = profile_.at(r);
  if (!rule_.as_drawn || !(depth_ > 0.0)) return u;
  const double rest = rule_.rest_radius;
  // Beyond a quarter turn the rest surface faces away from the ball, which does not displace it there.
  if (rest > 0.0 && r >= kQuarterTurn * rest) return u;
  const double aside = rest > 0.0 ? rest * portable::sin_cos(r / rest).sine : r;  // r is an arc length
  if (!(aside < radius_)) return u;
  const double behind = rest > 0.0 ? sag(rest, aside) : 0.0;  // depth of the rest surface below its top
  return std::max(u, depth_ - sag(radius_, aside) - behind);
}

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
