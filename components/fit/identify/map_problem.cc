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

/// Residuals and their derivatives for Ceres, by all values but the one that is held.
class MapCost final : public ceres::CostFunction {
 public:
  Values low, high;  // bounds of the values that are not held

  MapCost(const MapProblem& map, Values start, const MapBounds& bounds, std::size_t held)
      : map_(map), start_(std::move(start)), held_(held) {
    low = without_held(bounds.low);
    high = without_held(bounds.high);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(without_held(start_).size()));
    set_num_residuals(static_cast<int>(map.rows().size()));
  }

  [[nodiscard]] Values without_held(Values values) const {
    if (held_ < values.size()) values.erase(values.begin() + static_cast<std::ptrdiff_t>(held_));
    return values;
  }
  [[nodiscard]] Values with_held(const double* free) const {
    Values values = start_;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (k != held_) values[k] = *free++;
    }
    return values;
  }

  bool Evaluate(double const* const* blocks, double* out, double** derivatives) const override {
    const auto finite = [](double value) { return std::isfinite(value); };
    const Values values = with_held(blocks[0]);
    if (derivatives == nullptr || derivatives[0] == nullptr) {
      if (values != last_) {  // Ceres takes the step that its line search ends at once more
        last_residuals_ = map_.residuals(values);
        last_ = values;
      }
      std::copy(last_residuals_.begin(), last_residuals_.end(), out);
      return std::all_of(last_residuals_.begin(), last_residuals_.end(), finite);
    }
    const Values slopes = map_.slopes(values);
    double* derivative = derivatives[0];
    for (std::size_t i = 0; i < map_.rows().size(); ++i) {
      const double* line = slopes.data() + i * values.size();
      out[i] = line[0] - map_.weighted_force(i);  // the force is proportional to K, whose logarithm is first
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (k != held_) *derivative++ = line[k];
      }
    }
    if (!std::all_of(slopes.begin(), slopes.end(), finite)) return false;
    hold_at_bounds(blocks[0], out, derivatives[0]);
    return true;
  }

  /// A value at a bound that the data would have beyond it takes no part in a step.
  void hold_at_bounds(const double* free, const double* residuals, double* derivatives) const {
    const std::size_t columns = low.size();
    for (std::size_t k = 0; k < columns; ++k) {
      if (free[k] > low[k] && free[k] < high[k]) continue;
      double gradient = 0.0;
      for (std::size_t i = 0; i < map_.rows().size(); ++i)
        gradient += derivatives[i * columns + k] * residuals[i];
      if (free[k] <= low[k] ? gradient < 0.0 : gradient > 0.0) continue;
      for (std::size_t i = 0; i < map_.rows().size(); ++i) derivatives[i * columns + k] = 0.0;
    }
  }

 private:
  const MapProblem& map_;
  Values start_;
  std::size_t held_;
  mutable Values last_, last_residuals_;
};

/// Ends a search whose sum of squares is small enough, or does not become so at ten times the pace of its
/// last step.
class Enough final : public ceres::IterationCallback {
 public:
  Enough(double sum, int iterations) : sum_(sum), iterations_(iterations) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    constexpr int kFirstSteps = 15;  // which bounds may cut short
    const double above = 2.0 * step.cost - sum_;
    const bool is_slow = sum_ > 0.0 && step.iteration > kFirstSteps && step.step_is_successful &&
                         20.0 * step.cost_change * (iterations_ - step.iteration) < above;
    return above <= 0.0 || is_slow ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  double sum_;
  int iterations_;
};

}  // namespace

Values solve_map(const MapProblem& map, Values values, std::optional<std::size_t> held, int iterations,
                 double enough) {
  const MapBounds bounds = map.bounds(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::clamp(values[i], bounds.low[i], bounds.high[i]);
  }
  auto owned = std::make_unique<MapCost>(map, values, bounds, held.value_or(values.size()));
  const MapCost& cost = *owned;
  Values free = cost.without_held(values);
  ceres::Problem problem;
  problem.AddResidualBlock(owned.release(), nullptr, free.data());
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (std::isfinite(cost.low[i])) {
      problem.SetParameterLowerBound(free.data(), static_cast<int>(i), cost.low[i]);
      problem.SetParameterUpperBound(free.data(), static_cast<int>(i), cost.high[i]);
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = iterations;
  options.function_tolerance = 1e-9;
  options.line_search_interpolation_type = ceres::QUADRATIC;  // CUBIC takes a Jacobian at every trial
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  Enough callback(enough, iterations);
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return cost.with_held(free.data());
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
