#include "study/psychophysics/fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "palpate/error.h"

#include "study/psychophysics/nelder_mead.h"
#include "study/psychophysics/normal.h"

namespace palpate::psychophysics {
namespace {

constexpr double kInfiniteCost = std::numeric_limits<double>::infinity();
constexpr double kPi = 3.14159265358979323846;

// Falls from 1 at 0 to 0 at 1 by half a cosine.
double cosine_fall(double x) { return 0.5 + 0.5 * std::cos(kPi * std::clamp(x, 0.0, 1.0)); }

// 1 within the levels, 0 half their range outside.
double threshold_prior(double threshold, double first, double last) {
  const double outside = std::max({first - threshold, threshold - last, 0.0});
  return cosine_fall(outside / (0.5 * (last - first)));
}

// 1 from twice the smallest distance of two levels to their range, 0 at this distance and three ranges.
double width_prior(double width, double distance, double range) {
  if (width <= range) return cosine_fall(2.0 - width / distance);
  return cosine_fall((width - range) / (2.0 * range));
}

// Logarithm of a Beta(1, 10) density up to a constant, for guess, lapse and overdispersion.
double log_small_prior(double x) { return 9.0 * std::log1p(-x); }

// Logarithm of the beta-binomial likelihood of one level without its binomial coefficient.
double log_likelihood(const Count& count, double correct, double overdispersion) {
  constexpr double kBinomialBelow = 1e-4;
  const double yes = count.counted;
  const double no = count.trials - count.counted;
  if (overdispersion < kBinomialBelow) {
    return (yes > 0.0 ? yes * std::log(correct) : 0.0) + (no > 0.0 ? no * std::log1p(-correct) : 0.0);
  }
  const double size = 1.0 / (overdispersion * overdispersion) - 1.0;
  const double a = size * correct;
  const double b = size * (1.0 - correct);
  return std::lgamma(yes + a) + std::lgamma(no + b) - std::lgamma(yes + no + size) - std::lgamma(a) -
         std::lgamma(b) + std::lgamma(size);
}

double smallest_distance(std::span<const double> levels) {
  double distance = kInfiniteCost;
  for (std::size_t i = 1; i < levels.size(); ++i) distance = std::min(distance, levels[i] - levels[i - 1]);
  return distance;
}

double cost_of(const FunctionFit& fit, std::span<const double> levels, std::span<const Count> counts,
               Sigmoid sigmoid, double distance) {
  const bool valid = fit.width > distance && fit.guess + fit.lapse < 1.0;
  if (!valid || !(fit.overdispersion < 1.0)) return kInfiniteCost;
  const double range = levels.back() - levels.front();
  double sum = std::log(threshold_prior(fit.threshold, levels.front(), levels.back())) +
               std::log(width_prior(fit.width, distance, range)) + log_small_prior(fit.lapse) +
               log_small_prior(fit.guess) + log_small_prior(fit.overdispersion);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    sum += log_likelihood(counts[i], fit.correct(levels[i], sigmoid), fit.overdispersion);
  }
  return std::isfinite(sum) ? -sum : kInfiniteCost;
}

}  // namespace

double FunctionFit::correct(double level, Sigmoid sigmoid) const {
  constexpr double kNormalWidth = 3.2897072539029444;    // z(0.95) - z(0.05)
  constexpr double kLogisticWidth = 5.8888779583328805;  // 2 ln 19
  const double x = (level - threshold) / width;
  const double share = sigmoid == Sigmoid::kNormal ? normal_cdf(kNormalWidth * x)
                                                   : 1.0 / (1.0 + std::exp(-kLogisticWidth * x));
  return guess + (1.0 - guess - lapse) * share;
}

FunctionFit fit_function(std::span<const double> levels, std::span<const Count> counts, Sigmoid sigmoid,
                         int intervals) {
  if (counts.size() != levels.size() || levels.size() < 2) {
    throw ParameterError("counts", static_cast<double>(counts.size()), "one for each of 2 or more levels");
  }
  const double distance = smallest_distance(levels);
  if (!(distance > 0.0)) throw ParameterError("levels", distance, "in ascending order");
  // Squares keep lapse, guess and overdispersion from becoming negative. No Jacobian: the mode of the density
  // of the parameters themselves is wanted.
  const auto fit_at = [&](const std::vector<double>& x) {
    FunctionFit fit{x[0], std::exp(x[1]), x[2] * x[2], 0.0, x[3] * x[3]};
    fit.guess = intervals > 0 ? 1.0 / intervals : x[4] * x[4];
    return fit;
  };
  const auto cost = [&](const std::vector<double>& x) {
    return cost_of(fit_at(x), levels, counts, sigmoid, distance);
  };
  const double range = levels.back() - levels.front();
  Minimum best{{}, kInfiniteCost};
  for (const double where : {0.3, 0.5, 0.7}) {  // starts, because the posterior may have several modes
    std::vector<double> start{levels.front() + where * range, std::log(std::max(0.7 * range, 1.5 * distance)),
                              0.1, 0.2};
    std::vector<double> steps{0.1 * range, 0.3, 0.1, 0.1};
    if (intervals == 0) {
      start.push_back(0.1);
      steps.push_back(0.1);
    }
    const Minimum found = minimize(cost, start, steps);
    if (found.value < best.value) best = found;
  }
  return fit_at(best.at);
}

}  // namespace palpate::psychophysics
