#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "palpate/error.h"
#include "palpate/validate.h"

#include "fit/identify/least_squares.h"
#include "fit/validate/validation_sets.h"

namespace palpate::validate {
namespace {

constexpr std::size_t kParameters = 5;
constexpr std::size_t kExponent = 4;

// ln c, ln a, ln(s - 1), g, p. Wider than known tissues: radii of 1/50 to 5 tool radii, successive radii that
// hardly grow or grow fivefold.
const identify::Point kLow = {std::log(0.2), std::log(0.02), std::log(0.05), 0.02, 0.02};
const identify::Point kHigh = {std::log(4.0), std::log(5.0), std::log(4.0), 0.98, 1.0};

model::FalloffRatios reach_of(std::span<const double> shape) {
  return {std::exp(shape[0]), std::exp(shape[1]), 1.0 + std::exp(shape[2]), shape[3], shape[kExponent]};
}

/// (u of the model - u of the sample)/D at each point of each sample, divided by the square root of the
/// number of points.
void profile_errors(const std::vector<ProfileSample>& samples, const SurfaceRule& rule,
                    std::span<const double> shape, std::span<double> errors) {
  std::size_t at = 0;
  for (const ProfileSample& sample : samples) {
    const BallSurface surface(reach_of(shape), sample.depth, sample.tip_radius, rule);
    const Deformation& measured = sample.deformation;
    const double scale = sample.depth * std::sqrt(static_cast<double>(measured.size()));
    for (std::size_t i = 0; i < measured.size(); ++i, ++at) {
      errors[at] = (surface.at(measured.distance[i]) - measured.displacement[i]) / scale;
    }
  }
}

double solve_from(const std::vector<ProfileSample>& samples, const SurfaceRule& rule, bool keep_exponent,
                  identify::Point& shape) {
  identify::Bounds bounds{kLow, kHigh};
  bounds.low[kExponent] = std::min(kLow[kExponent], shape[kExponent]);  // a fixed p may be below the bound
  identify::RecordsProblem problem{bounds, {{}}, {0}, {}};
  problem.errors = [&](std::size_t, std::span<const double> at, std::span<const double>,
                       std::span<double> errors) {
    profile_errors(samples, rule, at, errors);
    return true;
  };
  for (const ProfileSample& sample : samples) problem.residuals[0] += sample.deformation.size();
  std::vector<identify::Point> none;
  return identify::minimise(problem, shape, none, 100, keep_exponent ? static_cast<int>(kExponent) : -1);
}

/// Whether the depths of the samples differ enough to determine p.
bool depths_differ(const std::vector<ProfileSample>& samples) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (const ProfileSample& sample : samples) {
    least = std::min(least, sample.depth / sample.tip_radius);
    most = std::max(most, sample.depth / sample.tip_radius);
  }
  return most >= kLeastSpreadOfDepths * least;
}

/// The best result of several starts.
identify::Point best_shape(const std::vector<ProfileSample>& samples, const SurfaceRule& rule,
                           bool keep_exponent, double exponent) {
  double best_cost = std::numeric_limits<double>::infinity();
  identify::Point best = kLow;
  best[kExponent] = exponent;
  for (const double c : {0.8, 1.3}) {
    for (const double a : {0.2, 0.6}) {
      for (const double s : {1.4, 2.0}) {
        for (const double g : {0.4, 0.7}) {
          identify::Point shape = {std::log(c), std::log(a), std::log(s - 1.0), g, exponent};
          const double cost = solve_from(samples, rule, keep_exponent, shape);
          if (cost < best_cost) {
            best_cost = cost;
            best = shape;
          }
        }
      }
    }
  }
  return best;
}

}  // namespace

FalloffFit fit_falloff(const std::vector<ProfileSample>& samples, const SurfaceRule& rule, double exponent) {
  if (samples.empty()) throw InputError("a reach needs at least one deformation");
  for (const ProfileSample& sample : samples) {
    if (!(sample.depth > 0.0) || !(sample.tip_radius > 0.0)) {
      throw InputError(sample.deformation.name + ": a reach needs the tool's depth and radius, both > 0");
    }
  }
  FalloffFit fit;
  fit.exponent_kept = !depths_differ(samples);
  const double start = fit.exponent_kept ? exponent : model::FalloffRatios{}.depth_exponent;
  const identify::Point best = best_shape(samples, rule, fit.exponent_kept, start);
  fit.reach = reach_of(best);
  for (std::size_t i = 0; i < kParameters; ++i) {
    const double margin = 1e-6 * (kHigh[i] - kLow[i]);
    const bool at_bound = best[i] < kLow[i] + margin || best[i] > kHigh[i] - margin;
    fit.at_limit.push_back(at_bound && !(i == kExponent && fit.exponent_kept));
  }
  for (const ProfileSample& sample : samples) {
    fit.nrmse.push_back(
        compare_deformation(sample.deformation, fit.reach, sample.depth, sample.tip_radius, rule)
            .errors.nrmse);
  }
  return fit;
}

}  // namespace palpate::validate
