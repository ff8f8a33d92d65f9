#include "fit/identify/map_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Dense>
#include <ceres/ceres.h>
#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/units.h"

#include "fit/identify/map_model.h"

namespace palpate::identify {
namespace {

constexpr double kEvidence = 10.0;        // least fall of the information criterion for an inclusion
constexpr double kNormalQuantile = 1.96;  // of the normal distribution, two-sided 95 %
constexpr double kChiSquared = 3.84;      // of one degree of freedom, 95 %
constexpr double kDeepest = 40.0;         // mm, of an inclusion
constexpr double kThinnest = 0.05;        // radius over depth
constexpr std::size_t kFewestProbes = 8;
constexpr std::size_t kFewestMapRows = 30;

using Values = std::vector<double>;

struct MapBounds {
  Values low, high;
};

/// The rows with their weights, and a model of them.
class MapProblem final {
 public:
  MapProblem(const std::vector<MapRow>& rows, const MapSettings& settings, std::size_t terms,
             const Values& weights)
      : rows_(rows), weights_(weights), model_(rows, settings.tip_radius, terms) {}

  [[nodiscard]] const MapModel& model() const { return model_; }
  [[nodiscard]] const std::vector<MapRow>& rows() const { return rows_; }

  [[nodiscard]] Values residuals(std::span<const double> values) const {
    Values forces = model_.forces(values, rows_);
    for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = weights_[i] * (forces[i] - rows_[i].force);
    return forces;
  }
  [[nodiscard]] double sum_of_squares(std::span<const double> values) const {
    const Values all = residuals(values);
    return std::inner_product(all.begin(), all.end(), all.begin(), 0.0);
  }
  /// The Bayesian information criterion.
  [[nodiscard]] double criterion(std::span<const double> values) const {
    const auto n = static_cast<double>(rows_.size());
    return n * std::log(sum_of_squares(values) / n) + static_cast<double>(values.size()) * std::log(n);
  }
  [[nodiscard]] MapBounds bounds(std::size_t size) const {
    const double infinite = std::numeric_limits<double>::infinity();
    MapBounds made{Values(size, -infinite), Values(size, infinite)};
    made.low[1] = 0.5;
    made.high[1] = 4.0;
    made.low[2] = 0.0;
    made.high[2] = 5.0;
    const double extent = model_.frame().extent / kMillimetre;
    for (std::size_t i = model_.first_inclusion(); i < size; i += kMapInclusion) {
      const double low[] = {-extent, -extent, 1.0, std::log(kThinnest), std::log(model::kSoftestInclusion)};
      const double high[] = {extent, extent, kDeepest, std::log(0.97), std::log(model::kStiffestInclusion)};
      std::copy(std::begin(low), std::end(low), made.low.begin() + static_cast<std::ptrdiff_t>(i));
      std::copy(std::begin(high), std::end(high), made.high.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return made;
  }

 private:
  const std::vector<MapRow>& rows_;
  const Values& weights_;
  MapModel model_;
};

struct MapCost {
  const MapProblem* problem;
  std::size_t size;
  bool operator()(double const* const* blocks, double* out) const {
    const Values all = problem->residuals({blocks[0], size});
    std::copy(all.begin(), all.end(), out);
    return std::all_of(all.begin(), all.end(), [](double value) { return std::isfinite(value); });
  }
};

/// Least squares from `values`. @param held a parameter that stays as it is
Values solve_map(const MapProblem& map, Values values, std::optional<std::size_t> held = std::nullopt,
                 int iterations = 60) {
  const MapBounds bounds = map.bounds(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::clamp(values[i], bounds.low[i], bounds.high[i]);
  }
  auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<MapCost, ceres::CENTRAL>>(
      new MapCost{&map, values.size()});
  cost->AddParameterBlock(static_cast<int>(values.size()));
  cost->SetNumResiduals(static_cast<int>(map.rows().size()));
  ceres::Problem problem;
  problem.AddResidualBlock(cost.release(), nullptr, values.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(bounds.low[i])) {
      problem.SetParameterLowerBound(values.data(), static_cast<int>(i), bounds.low[i]);
      problem.SetParameterUpperBound(values.data(), static_cast<int>(i), bounds.high[i]);
    }
  }
  if (held) {
    auto manifold = std::make_unique<ceres::SubsetManifold>(static_cast<int>(values.size()),
                                                            std::vector<int>{static_cast<int>(*held)});
    problem.SetManifold(values.data(), manifold.release());  // the problem owns it
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = iterations;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return values;
}

/// Where the residuals ask most for another inclusion: the probe with the largest sum over its neighbourhood,
/// each residual relative to the background. @return the point in the map's frame [mm], and the sign
std::pair<Vec3, double> most_wanted(const MapProblem& map, std::span<const double> values) {
  const Values forces = map.model().forces(values, map.rows());
  std::map<int, std::pair<double, double>> by_probe;  // sums of the residual and of the force
  std::map<int, Vec3> place;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const MapRow& row = map.rows()[i];
    by_probe[row.probe].first += row.force - forces[i];
    by_probe[row.probe].second += forces[i];
    place[row.probe] = map.model().frame().local(row.point) / kMillimetre;
  }
  const double area = std::pow(2.0 * map.model().frame().extent / kMillimetre, 2);
  const double near = 1.5 * area / static_cast<double>(by_probe.size());  // mm^2, about the next probes
  std::pair<Vec3, double> best{Vec3::Zero(), 0.0};
  for (const auto& [probe, at] : place) {
    double sum = 0.0;
    double total = 0.0;
    for (const auto& [other, sums] : by_probe) {
      const double weight = std::exp(-(place[other] - at).squaredNorm() / near);
      sum += weight * sums.first / sums.second;
      total += weight;
    }
    const double wanted = sum / std::sqrt(total);
    if (std::abs(wanted) > std::abs(best.second)) best = {at, wanted};
  }
  return best;
}

/// The values with one inclusion more, from several depths; the best of them.
Values with_one_more(const MapProblem& map, const Values& values) {
  const auto [at, wanted] = most_wanted(map, values);
  constexpr int kTrial = 12;  // iterations before the best start is chosen
  Values best;
  double least = std::numeric_limits<double>::infinity();
  for (const double h : {3.0, 6.0, 12.0}) {
    Values start = values;
    const double ratio = wanted > 0.0 ? 10.0 : 0.3;
    for (const double value : {at.x(), at.y(), h, std::log(0.6), std::log(ratio)}) start.push_back(value);
    const Values found = solve_map(map, start, std::nullopt, kTrial);
    const double sum = map.sum_of_squares(found);
    if (sum >= least) continue;
    least = sum;
    best = found;
  }
  return solve_map(map, best);
}

/// Whether the last inclusion is clear of the others: two spheres cannot overlap.
bool is_apart(const MapProblem& map, const Values& values) {
  constexpr double kTouching = 0.7;  // of the sum of the radii; the law is fitted to spheres that are apart
  const auto inclusion = [&](std::size_t i) { return std::span(values).subspan(i, kMapInclusion); };
  const auto radius = [&](std::size_t i) { return values[i + 2] * kMillimetre * std::exp(values[i + 3]); };
  const std::size_t last = values.size() - kMapInclusion;
  for (std::size_t i = map.model().first_inclusion(); i < last; i += kMapInclusion) {
    const double distance = (map.model().centre(inclusion(i)) - map.model().centre(inclusion(last))).norm();
    if (distance < kTouching * (radius(i) + radius(last))) return false;
  }
  return true;
}

Values start_values(const std::vector<MapRow>& rows, std::size_t terms) {
  double deepest = 0.0;
  double force = 0.0;
  for (const MapRow& row : rows) {
    deepest = std::max(deepest, row.depth);
    force = std::max(force, row.force);
  }
  Values values(kMapTissue + terms - 1, 0.0);
  values[1] = 1.3;
  values[2] = 0.2;
  values[0] = std::log(0.5 * force) - values[1] * std::log(deepest / kMillimetre + values[2]);
  return values;
}

struct Chosen {
  std::size_t terms = 1;
  Values values;
};

/// Adds terms of the background map and inclusions while the criterion falls by more than kEvidence.
Chosen choose(const std::vector<MapRow>& rows, const MapSettings& settings, const Values& weights,
              const MapProgress& progress) {
  std::vector<MapProblem> problems;
  for (const std::size_t terms : {1U, 3U, 6U}) problems.emplace_back(rows, settings, terms, weights);
  std::size_t level = 0;
  Chosen now{1, solve_map(problems[0], start_values(rows, 1))};
  double criterion = problems[0].criterion(now.values);
  for (;;) {
    const std::size_t count = (now.values.size() - problems[level].model().size(0)) / kMapInclusion;
    if (progress) {
      progress(static_cast<double>(count) / static_cast<double>(settings.max_inclusions + 1),
               fmt::format("{} inclusions", count));
    }
    std::optional<Chosen> better;
    double least = criterion - kEvidence;
    std::size_t next_level = level;
    if (count < settings.max_inclusions) {
      Values more = with_one_more(problems[level], now.values);
      if (const double at = problems[level].criterion(more); at < least && is_apart(problems[level], more)) {
        least = at;
        better = Chosen{now.terms, std::move(more)};
      }
    }
    if (level + 1 < problems.size()) {
      Values wider = now.values;
      const std::size_t terms = level == 0 ? 3 : 6;
      const std::size_t added = terms - now.terms;
      wider.insert(wider.begin() + static_cast<std::ptrdiff_t>(problems[level].model().size(0)), added, 0.0);
      wider = solve_map(problems[level + 1], wider);
      if (const double at = problems[level + 1].criterion(wider); at < least) {
        least = at;
        better = Chosen{terms, std::move(wider)};
        next_level = level + 1;
      }
    }
    if (!better) return now;
    now = std::move(*better);
    criterion = least;
    level = next_level;
  }
}

/// Weights of the rows, 1 / sigma with sigma^2 = s^2 + (c F)^2. The noise is that of the third differences
/// along each probe, which a smooth force over depth hardly has; the residuals of a fit would also have its
/// faults.
Values weights_of(const std::vector<MapRow>& rows) {
  constexpr double kThirdDifference = 20.0;                      // variance of 1, -3, 3, -1 times equal noise
  std::map<int, std::vector<std::pair<double, double>>> curves;  // depth and force
  for (const MapRow& row : rows) curves[row.probe].emplace_back(row.depth, row.force);
  // Least squares of the squares over 1 and F^2, both not negative.
  double n = 0.0;
  double x = 0.0;
  double xx = 0.0;
  double y = 0.0;
  double xy = 0.0;
  for (auto& [probe, curve] : curves) {
    std::sort(curve.begin(), curve.end());
    for (std::size_t i = 3; i < curve.size(); ++i) {
      const double difference =
          curve[i].second - 3.0 * curve[i - 1].second + 3.0 * curve[i - 2].second - curve[i - 3].second;
      const double mean = 0.5 * (curve[i - 1].second + curve[i - 2].second);
      const double square = mean * mean;
      const double variance = difference * difference / kThirdDifference;
      n += 1.0;
      x += square;
      xx += square * square;
      y += variance;
      xy += square * variance;
    }
  }
  if (!(n > 0.0 && y > 0.0)) return Values(rows.size(), 1.0);
  const double spread = n * xx - x * x;
  double slope = spread > 0.0 ? std::max(0.0, (n * xy - x * y) / spread) : 0.0;
  double constant = (y - slope * x) / n;
  if (constant < 0.0) {
    constant = 0.0;
    slope = xy / xx;
  }
  Values weights;
  const double least = 0.1 * std::sqrt(y / n);
  for (const MapRow& row : rows) {
    weights.push_back(1.0 / std::max(least, std::sqrt(constant + slope * row.force * row.force)));
  }
  return weights;
}

/// The covariance of the parameters; those at a bound, or without effect, have none.
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

/// The values of one parameter that the data allow, by profile likelihood.
Interval profile_of(const MapProblem& map, const Values& values, std::size_t k) {
  const MapBounds bounds = map.bounds(values.size());
  const double least = map.sum_of_squares(values);
  const double variance = least / static_cast<double>(map.rows().size() - values.size());
  const auto allowed = [&](double value, Values& start) {
    start[k] = value;
    start = solve_map(map, start, k);
    return map.sum_of_squares(start) <= least + kChiSquared * variance;
  };
  const auto end = [&](double bound) {
    Values start = values;
    if (allowed(bound, start)) return bound;
    double inside = values[k];
    double outside = bound;
    constexpr int kHalvings = 5;
    start = values;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (inside + outside);
      Values trial = start;
      if (allowed(middle, trial)) {
        inside = middle;
        start = trial;
      } else {
        outside = middle;
      }
    }
    return 0.5 * (inside + outside);
  };
  return {end(bounds.low[k]), end(bounds.high[k])};
}

FoundInclusion describe(const MapProblem& map, const Values& values, const Eigen::MatrixXd& covariance,
                        std::size_t from, double deepest, bool profiles) {
  const auto inclusion = [from](const Values& all) { return std::span(all).subspan(from, kMapInclusion); };
  FoundInclusion found;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    found.centre[axis] = derived(values, covariance, from, [&](const Values& all) {
      return map.model().centre(inclusion(all))[static_cast<Eigen::Index>(axis)];
    });
  }
  found.depth =
      derived(values, covariance, from, [&](const Values& all) { return all[from + 2] * kMillimetre; });
  found.rise = derived(values, covariance, from, [&](const Values& all) {
    Values alone(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(map.model().first_inclusion()));
    const auto own = inclusion(all);
    alone.insert(alone.end(), own.begin(), own.end());
    MapRow above;
    above.depth = deepest;
    above.point = map.model().above(own);
    return map.model().forces(alone, {&above, 1})[0] / map.model().background(alone, above) - 1.0;
  });
  const double h = values[from + 2] * kMillimetre;
  found.radius.value = h * std::exp(values[from + 3]);
  found.ratio.value = std::exp(values[from + 4]);
  if (!profiles) return found;
  const Interval share = profile_of(map, values, from + 3);
  const Interval ratio = profile_of(map, values, from + 4);
  found.radius.interval = {h * std::exp(share.low), h * std::exp(share.high)};
  found.ratio.interval = {std::exp(ratio.low), std::exp(ratio.high)};
  const MapBounds bounds = map.bounds(values.size());
  const auto determined = [&](const Interval& interval, std::size_t k) {
    return interval.high - interval.low < std::log(2.0) && interval.low > bounds.low[k] &&
           interval.high < bounds.high[k];
  };
  found.radius.determined = determined(share, from + 3);
  found.ratio.determined = determined(ratio, from + 4);
  return found;
}

double rms(const Values& forces, const std::vector<MapRow>& rows) {
  double sum = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    sum += (forces[i] - rows[i].force) * (forces[i] - rows[i].force);
  }
  return std::sqrt(sum / static_cast<double>(rows.size()));
}

/// One factor a probe: its forces over those of the uniform background tissue, by least squares.
std::vector<model::StiffnessPoint> stiffness_points(const MapModel& model, const Values& values,
                                                    const std::vector<MapRow>& rows) {
  Values tissue(values.begin(), values.begin() + kMapTissue);
  tissue.resize(model.first_inclusion(), 0.0);
  std::map<int, std::pair<double, double>> sums;
  std::map<int, Vec3> place;
  for (const MapRow& row : rows) {
    const double uniform = model.background(tissue, row);
    sums[row.probe].first += uniform * row.force;
    sums[row.probe].second += uniform * uniform;
    place[row.probe] = row.point;
  }
  std::vector<model::StiffnessPoint> points;
  for (const auto& [probe, both] : sums) {
    points.push_back(
        {place[probe], std::clamp(both.first / both.second, model::kSmallestFactor, model::kLargestFactor)});
  }
  return points;
}

}  // namespace

MapFit fit_map(const std::vector<MapRow>& rows, const MapSettings& settings, const MapProgress& progress) {
  std::set<int> probes;
  MapFit fit;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double deepest = 0.0;
  for (const MapRow& row : rows) {
    probes.insert(row.probe);
    low = std::min(low, row.force);
    high = std::max(high, row.force);
    deepest = std::max(deepest, row.depth);
  }
  if (probes.size() < kFewestProbes || rows.size() < kFewestMapRows) {
    throw InputError(fmt::format("the map has {} probes and {} rows: must have at least {} and {}",
                                 probes.size(), rows.size(), kFewestProbes, kFewestMapRows));
  }
  if (!(high > 0.0 && deepest > 0.0)) throw InputError("the map has no row with a depth and a force above 0");
  fit.rows = rows.size();
  fit.probes = probes.size();
  fit.range = high - low;

  const Values equal(rows.size(), 1.0);
  const Values weights = weights_of(rows);
  const Chosen chosen = choose(rows, settings, weights, progress);
  const MapProblem map(rows, settings, chosen.terms, weights);

  const Values& values = chosen.values;
  fit.values = values;
  fit.map_terms = chosen.terms;
  fit.exponent = values[1];
  fit.first_depth = values[2] * kMillimetre;
  fit.stiffness = std::exp(values[0]) * std::pow(1.0 / kMillimetre, values[1]);
  fit.error = rms(map.model().forces(values, rows), rows);
  const MapProblem alone(rows, settings, 1, equal);
  fit.uniform_error = rms(alone.model().forces(solve_map(alone, start_values(rows, 1)), rows), rows);
  const Eigen::MatrixXd covariance = covariance_of(map, values);
  for (std::size_t i = map.model().first_inclusion(); i < values.size(); i += kMapInclusion) {
    if (progress) progress(0.9, "intervals");
    fit.inclusions.push_back(describe(map, values, covariance, i, deepest, settings.profiles));
  }
  fit.stiffness_map = stiffness_points(map.model(), values, rows);
  return fit;
}

}  // namespace palpate::identify
