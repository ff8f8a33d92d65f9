#include "fit/identify/map_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include <ceres/ceres.h>

#include "palpate/inclusion.h"
#include "palpate/units.h"

namespace palpate::identify {

Values MapProblem::residuals(std::span<const double> values) const {
  Values forces = model_.forces(values, rows_);
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = weights_[i] * (forces[i] - rows_[i].force);
  return forces;
}

Values MapProblem::slopes(std::span<const double> values) const {
  Values all = model_.slopes(values, rows_);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (std::size_t k = 0; k < values.size(); ++k) all[i * values.size() + k] *= weights_[i];
  }
  return all;
}

double MapProblem::sum_of_squares(std::span<const double> values) const {
  const Values all = residuals(values);
  return std::inner_product(all.begin(), all.end(), all.begin(), 0.0);
}

double MapProblem::criterion(std::span<const double> values) const {
  const auto n = static_cast<double>(rows_.size());
  return n * std::log(sum_of_squares(values) / n) + static_cast<double>(values.size()) * std::log(n);
}

MapBounds MapProblem::bounds(std::size_t size) const {
  const double infinite = std::numeric_limits<double>::infinity();
  MapBounds made{Values(size, -infinite), Values(size, infinite)};
  made.low[1] = 0.5;
  made.high[1] = 4.0;
  made.low[2] = 0.0;
  made.high[2] = 5.0;
  const double extent = model_.frame().extent / kMillimetre;
  for (std::size_t i = model_.first_inclusion(); i < size; i += kMapInclusion) {
    const double low[] = {-extent, -extent, kShallowestInclusion, std::log(kThinnestInclusion),
                          std::log(model::kSoftestInclusion)};
    const double high[] = {extent, extent, kDeepestInclusion, std::log(kThickestInclusion),
                           std::log(model::kStiffestInclusion)};
    std::copy(std::begin(low), std::end(low), made.low.begin() + static_cast<std::ptrdiff_t>(i));
    std::copy(std::begin(high), std::end(high), made.high.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return made;
}

namespace {

/// Residuals and their derivatives for Ceres.
class MapCost final : public ceres::CostFunction {
 public:
  MapCost(const MapProblem& map, std::size_t size) : map_(map), size_(size) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(size));
    set_num_residuals(static_cast<int>(map.rows().size()));
  }

  bool Evaluate(double const* const* blocks, double* out, double** derivatives) const override {
    const auto finite = [](double value) { return std::isfinite(value); };
    const std::span<const double> values(blocks[0], size_);
    if (derivatives == nullptr || derivatives[0] == nullptr) {
      const Values all = map_.residuals(values);
      std::copy(all.begin(), all.end(), out);
      return std::all_of(all.begin(), all.end(), finite);
    }
    const Values slopes = map_.slopes(values);
    std::copy(slopes.begin(), slopes.end(), derivatives[0]);
    for (std::size_t i = 0; i < map_.rows().size(); ++i) {
      const double force = slopes[i * size_];  // the force is proportional to K, whose logarithm is first
      out[i] = force - map_.weighted_force(i);
    }
    return std::all_of(slopes.begin(), slopes.end(), finite);
  }

 private:
  const MapProblem& map_;
  std::size_t size_;
};

}  // namespace

Values solve_map(const MapProblem& map, Values values, std::optional<std::size_t> held, int iterations) {
  const MapBounds bounds = map.bounds(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::clamp(values[i], bounds.low[i], bounds.high[i]);
  }
  auto cost = std::make_unique<MapCost>(map, values.size());
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
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = iterations;
  options.function_tolerance = 1e-9;
  options.line_search_interpolation_type = ceres::QUADRATIC;  // CUBIC takes a Jacobian at every trial
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return values;
}

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

}  // namespace palpate::identify
