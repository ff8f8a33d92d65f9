#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Dense>

#include "core/base/parallel.h"
#include "palpate/units.h"

#include "fit/identify/map_problem.h"

namespace palpate::identify {
namespace {

constexpr double kNormalQuantile = 1.96;  // of the normal distribution, two-sided 95 %
constexpr double kChiSquared = 3.84;      // of one degree of freedom, 95 %

/// Estimate of a function of the parameters, by its gradient. @param function of the values
template <typename Function>
Estimate derived(const Values& values, const Eigen::MatrixXd& covariance, std::size_t from,
                 Function function) {
  Estimate made;
  made.value = function(values);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(covariance.rows());
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k >= kMapTissue && k < from) continue;  // the background map and other inclusions have no effect
    const double step = 1e-4 * std::max(1.0, std::abs(values[k]));
    Values low = values;
    Values high = values;
    low[k] -= step;
    high[k] += step;
    slope[static_cast<Eigen::Index>(k)] = (function(high) - function(low)) / (2.0 * step);
  }
  const double half = kNormalQuantile * std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
  made.interval = {made.value - half, made.value + half};
  return made;
}

/// The largest sum of squares that the data allow beside the least, that of `values` (95 %).
double allowed_sum(const MapProblem& map, const Values& values) {
  const double least = map.sum_of_squares(values);
  return least + kChiSquared * least / static_cast<double>(map.rows().size() - values.size());
}

/// The values of one parameter that the data allow, by profile likelihood: outwards from where the covariance
/// expects the end, and then halfway between a value that is allowed and one that is not.
Interval profile_of(const MapProblem& map, const Values& values, const Eigen::MatrixXd& covariance,
                    std::size_t k) {
  constexpr double kFirst = 0.8;    // of the expected distance
  constexpr double kGrowth = 1.5;   // of the next
  constexpr double kPrecise = 0.1;  // of the distance
  constexpr double kBlind = 0.1;    // of the way to the bound, without a covariance
  constexpr int kHalvings = 10;     // at most
  const MapBounds bounds = map.bounds(values.size());
  const double enough = allowed_sum(map, values);
  const auto column = static_cast<Eigen::Index>(k);
  const double variance = covariance(column, column);
  // How the others follow when this parameter moves.
  const Eigen::VectorXd follow = variance > 0.0
                                     ? Eigen::VectorXd(covariance.col(column) / variance)
                                     : Eigen::VectorXd(Eigen::VectorXd::Unit(covariance.rows(), column));
  const auto end = [&](double bound) {
    Values nearest = values;  // that is allowed
    const auto allows = [&](double value) {
      Values trial = nearest;
      for (std::size_t i = 0; i < trial.size(); ++i)
        trial[i] += follow[static_cast<Eigen::Index>(i)] * (value - nearest[k]);
      trial[k] = value;
      constexpr int kIterations = 60;
      trial = solve_map(map, trial, k, kIterations, enough);
      if (!(map.sum_of_squares(trial) <= enough)) return false;
      nearest = std::move(trial);
      return true;
    };
    const double way = bound - values[k];
    const double expected = variance > 0.0 ? kNormalQuantile * std::sqrt(variance) / std::abs(way) : kBlind;
    double inside = 0.0;  // of the way
    double outside = std::min(1.0, kFirst * expected);
    while (allows(values[k] + outside * way)) {
      if (outside == 1.0) return bound;
      inside = outside;
      outside = std::min(1.0, kGrowth * outside);
    }
    for (int i = 0; i < kHalvings && outside - inside > kPrecise * outside; ++i) {
      const double middle = 0.5 * (inside + outside);
      (allows(values[k] + middle * way) ? inside : outside) = middle;
    }
    return values[k] + 0.5 * (inside + outside) * way;
  };
  Interval found;
  for_ranges(2, 1, [&](std::size_t i, std::size_t) {
    (i == 0 ? found.low : found.high) = end(i == 0 ? bounds.low[k] : bounds.high[k]);
  });
  return found;
}

/// The end of an interval that reaches a bound of the search: the search does not know how far it goes on.
Interval opened(const Interval& interval, double low_bound, double high_bound) {
  return {interval.low > low_bound ? std::exp(interval.low) : 0.0,
          interval.high < high_bound ? std::exp(interval.high) : std::numeric_limits<double>::infinity()};
}

const char* key_of(MapParameter parameter) {
  if (parameter == kDepthBelow) return "depth_mm";
  if (parameter == kLogThickness) return "radius_mm";
  return parameter == kLogRatio ? "stiffness_ratio" : "place";
}

}  // namespace

std::vector<MapParameter> bounds_reached(const MapProblem& map, const Values& values, std::size_t from) {
  constexpr double kMargin = 0.02;  // mm, and of a logarithm: the solver ends this near to a bound
  const MapBounds bounds = map.bounds(values.size());
  std::vector<MapParameter> reached;
  for (std::size_t i = 0; i < kMapInclusion; ++i) {
    const std::size_t k = from + i;
    if (values[k] - bounds.low[k] > kMargin && bounds.high[k] - values[k] > kMargin) continue;
    reached.push_back(static_cast<MapParameter>(i));
  }
  return reached;
}

Values moved_off_bounds(const MapProblem& map, Values values) {
  constexpr double kInside = 0.1;  // of a logarithm, from the bound
  for (std::size_t from = map.model().first_inclusion(); from < values.size(); from += kMapInclusion) {
    for (const MapParameter parameter : bounds_reached(map, values, from)) {
      if (parameter != kLogThickness && parameter != kLogRatio) continue;
      const MapBounds bounds = map.bounds(values.size());
      const std::size_t k = from + parameter;
      Values moved = values;
      moved[k] = std::clamp(values[k], bounds.low[k] + kInside, bounds.high[k] - kInside);
      moved = solve_map(map, moved, k);
      if (map.sum_of_squares(moved) <= allowed_sum(map, values)) values = std::move(moved);
    }
  }
  return values;
}

Eigen::MatrixXd covariance_of(const MapProblem& map, const Values& values) {
  const auto n = static_cast<Eigen::Index>(values.size());
  const auto rows = static_cast<Eigen::Index>(map.rows().size());
  Eigen::MatrixXd jacobian(rows, n);
  const MapBounds bounds = map.bounds(values.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double step = 1e-4 * std::max(1.0, std::abs(values[k]));
    const bool at_bound = values[k] - step < bounds.low[k] || values[k] + step > bounds.high[k];
    if (at_bound) {
      jacobian.col(i).setZero();
      continue;
    }
    Values low = values;
    Values high = values;
    low[k] -= step;
    high[k] += step;
    const Values a = map.residuals(low);
    const Values b = map.residuals(high);
    for (Eigen::Index r = 0; r < rows; ++r) {
      const auto at = static_cast<std::size_t>(r);
      jacobian(r, i) = (b[at] - a[at]) / (2.0 * step);
    }
  }
  const double variance =
      map.sum_of_squares(values) / static_cast<double>(std::max<Eigen::Index>(1, rows - n));
  return variance * (jacobian.transpose() * jacobian).completeOrthogonalDecomposition().pseudoInverse();
}

FoundInclusion describe_inclusion(const MapProblem& map, const Values& values,
                                  const Eigen::MatrixXd& covariance, std::size_t from, double deepest,
                                  bool profiles) {
  const auto inclusion = [from](const Values& all) { return std::span(all).subspan(from, kMapInclusion); };
  const auto rise = [&](const Values& all) {
    Values alone(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(map.model().first_inclusion()));
    const auto own = inclusion(all);
    alone.insert(alone.end(), own.begin(), own.end());
    MapRow above;
    above.depth = deepest;
    above.point = map.model().above(own);
    return map.model().forces(alone, {&above, 1})[0] / map.model().background(alone, above) - 1.0;
  };
  FoundInclusion found;
  const double h = values[from + kDepthBelow] * kMillimetre;
  found.radius.value = h * std::exp(values[from + kLogThickness]);
  found.ratio.value = std::exp(values[from + kLogRatio]);
  for (const MapParameter parameter : bounds_reached(map, values, from)) {
    const std::string key = key_of(parameter);
    if (found.at_bounds.empty() || found.at_bounds.back() != key) found.at_bounds.push_back(key);
  }
  if (!found.at_bounds.empty()) {
    const Vec3 centre = map.model().centre(inclusion(values));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      found.centre[axis].value = centre[static_cast<Eigen::Index>(axis)];
    }
    found.depth.value = h;
    found.rise.value = rise(values);
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    for (Estimate* one : {&found.centre[0], &found.centre[1], &found.centre[2], &found.depth, &found.rise,
                          &found.radius, &found.ratio}) {
      one->interval = {-kInfinite, kInfinite};
      one->determined = false;
    }
    return found;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    found.centre[axis] = derived(values, covariance, from, [&](const Values& all) {
      return map.model().centre(inclusion(all))[static_cast<Eigen::Index>(axis)];
    });
  }
  found.depth =
      derived(values, covariance, from, [&](const Values& all) { return all[from + 2] * kMillimetre; });
  found.rise = derived(values, covariance, from, rise);
  if (!profiles) return found;
  const Interval share = profile_of(map, values, covariance, from + kLogThickness);
  const Interval ratio = profile_of(map, values, covariance, from + kLogRatio);
  const MapBounds bounds = map.bounds(values.size());
  const std::size_t thickness = from + kLogThickness;
  found.radius.interval = opened(share, bounds.low[thickness], bounds.high[thickness]);
  found.radius.interval = {h * found.radius.interval.low, h * std::min(1.0, found.radius.interval.high)};
  found.ratio.interval = opened(ratio, bounds.low[from + kLogRatio], bounds.high[from + kLogRatio]);
  const auto determined = [&](const Interval& interval, std::size_t k) {
    return interval.high - interval.low < std::log(2.0) && interval.low > bounds.low[k] &&
           interval.high < bounds.high[k];
  };
  found.radius.determined = determined(share, thickness);
  found.ratio.determined = determined(ratio, from + kLogRatio);
  return found;
}

}  // namespace palpate::identify
