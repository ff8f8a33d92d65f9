#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <ceres/ceres.h>

#include "fit/identify/least_squares.h"
#include "fit/identify/quiet_library.h"

namespace palpate::identify {
namespace {

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// Residuals and Jacobian of a part for Ceres, with two parameter blocks: shared and own.
class PartCost final : public ceres::CostFunction {
 public:
  PartCost(const Problem& problem, const Part& part) : problem_(problem), part_(part) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(shared_count(problem.terms)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(kOwnParameters));
    set_num_residuals(static_cast<int>(residual_count(part)));
  }

  bool Evaluate(double const* const* blocks, double* values, double** derivatives) const override {
    const std::span<const double> shared(blocks[0], shared_count(problem_.terms));
    const std::span<const double> own(blocks[1], kOwnParameters);
    move_to(shared, own);
    std::copy(values_.begin(), values_.end(), values);
    if (!all_finite(values_)) return false;
    if (derivatives == nullptr) return true;
    if (derivatives_.empty()) derivatives_ = jacobian(problem_, part_, shared, own);
    const std::size_t columns = shared.size() + own.size();
    for (std::size_t r = 0; r < values_.size(); ++r) {
      const double* const row = derivatives_.data() + r * columns;
      if (derivatives[0] != nullptr) std::copy_n(row, shared.size(), derivatives[0] + r * shared.size());
      if (derivatives[1] != nullptr) {
        std::copy_n(row + shared.size(), own.size(), derivatives[1] + r * own.size());
      }
    }
    return all_finite(derivatives_);
  }

 private:
  /// Computes the residuals where the parameters differ from those of the last evaluation: Ceres evaluates
  /// the point of each accepted step three times, in the line search, for the cost and for the next step.
  void move_to(std::span<const double> shared, std::span<const double> own) const {
    Point at(shared.begin(), shared.end());
    at.insert(at.end(), own.begin(), own.end());
    if (at == at_) return;
    at_ = std::move(at);
    values_.resize(residual_count(part_));
    residuals(problem_, part_, shared, own, values_);
    derivatives_.clear();
  }

  const Problem& problem_;
  const Part& part_;
  mutable Point at_;                         // of the last evaluation: shared parameters, then own
  mutable std::vector<double> values_;       // residuals there
  mutable std::vector<double> derivatives_;  // Jacobian there; empty until it is asked for
};

/// Residuals of a record for Ceres, with central differences. Ceres's own have a step in proportion to the
/// parameter: for one near zero it is so small that rounding and kinks drown the derivative.
class RecordCost final : public ceres::CostFunction {
 public:
  RecordCost(const RecordsProblem& problem, std::size_t record) : problem_(problem), record_(record) {
    for (const std::size_t count : {problem.shared.low.size(), problem.own[record].low.size()}) {
      if (count > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(count));
    }
    set_num_residuals(static_cast<int>(problem.residuals[record]));
  }

  bool Evaluate(double const* const* blocks, double* values, double** derivatives) const override {
    std::vector<Point> points;
    for (std::size_t b = 0; b < parameter_block_sizes().size(); ++b)
      points.emplace_back(blocks[b], blocks[b] + parameter_block_sizes()[b]);
    points.resize(2);
    const auto rows = static_cast<std::size_t>(num_residuals());
    const auto errors = [&](double* out) {
      return problem_.errors(record_, points[0], points[1], {out, rows});
    };
    if (points != at_) {  // Ceres evaluates the point of an accepted step three times, as for PartCost
      at_ = points;
      values_.resize(rows);
      valid_ = errors(values_.data());
    }
    if (!valid_) return false;
    std::copy(values_.begin(), values_.end(), values);
    if (derivatives == nullptr) return true;
    std::vector<double> up(rows);
    std::vector<double> down(rows);
    for (std::size_t b = 0; b < parameter_block_sizes().size(); ++b) {
      if (derivatives[b] == nullptr) continue;
      const std::size_t columns = points[b].size();
      for (std::size_t i = 0; i < columns; ++i) {
        double& parameter = points[b][i];
        const double here = parameter;
        parameter = here + problem_.step;
        if (!errors(up.data())) return false;
        parameter = here - problem_.step;
        if (!errors(down.data())) return false;
        parameter = here;
        for (std::size_t row = 0; row < rows; ++row)
          derivatives[b][row * columns + i] = (up[row] - down[row]) / (2.0 * problem_.step);
      }
    }
    return true;
  }

 private:
  const RecordsProblem& problem_;
  std::size_t record_;
  mutable std::vector<Point> at_;       // of the last evaluation
  mutable std::vector<double> values_;  // residuals there
  mutable bool valid_ = false;          // whether those parameters are
};

void clamp_into(Point& point, const Bounds& bounds) {
  for (std::size_t i = 0; i < point.size(); ++i) {
    point[i] = std::clamp(point[i], bounds.low[i], bounds.high[i]);
  }
}

void set_bounds(ceres::Problem& problem, double* block, const Bounds& bounds) {
  for (std::size_t i = 0; i < bounds.low.size(); ++i) {
    problem.SetParameterLowerBound(block, static_cast<int>(i), bounds.low[i]);
    problem.SetParameterUpperBound(block, static_cast<int>(i), bounds.high[i]);
  }
}

/// Holds one parameter of a block constant.
void hold(ceres::Problem& problem, double* block, std::size_t size, std::size_t index) {
  auto manifold = std::make_unique<ceres::SubsetManifold>(static_cast<int>(size),
                                                          std::vector<int>{static_cast<int>(index)});
  problem.SetManifold(block, manifold.release());  // the problem owns it
}

/// Eliminates the own parameters of each part first. Ceres orders blocks by memory address; all lie in one
/// array, so that sums have the same order in every run.
std::shared_ptr<ceres::ParameterBlockOrdering> own_before_shared(std::vector<double>& own, double* shared) {
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t i = 0; i < own.size(); i += kOwnParameters) ordering->AddElementToGroup(&own[i], 0);
  ordering->AddElementToGroup(shared, 1);
  return ordering;
}

/// A step that bounds cut short is shortened by values of the cost alone: Ceres's default takes a whole
/// Jacobian at every step that it tries, also at the full step, which is nearly always right.
void use_few_jacobians(ceres::Solver::Options& options) {
  options.line_search_interpolation_type = ceres::QUADRATIC;
}

/// @return half the sum of squares; infinite if it fails
double solve_dense(ceres::Problem& all, int most_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = most_iterations;
  use_few_jacobians(options);
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &all, &summary);
  return summary.IsSolutionUsable() ? summary.final_cost : std::numeric_limits<double>::infinity();
}

}  // namespace

double minimise(const RecordsProblem& problem, Point& shared, std::vector<Point>& own, int most_iterations,
                int held) {
  const QuietLibrary quiet;
  Point flat;  // one array: Ceres orders blocks by their address
  for (const Point& one : own) flat.insert(flat.end(), one.begin(), one.end());
  ceres::Problem all;
  all.AddParameterBlock(shared.data(), static_cast<int>(shared.size()));
  set_bounds(all, shared.data(), problem.shared);
  if (held >= 0) hold(all, shared.data(), shared.size(), static_cast<std::size_t>(held));
  double* block = flat.data();
  for (std::size_t i = 0; i < problem.own.size(); ++i) {
    const std::size_t count = problem.own[i].low.size();
    auto cost = std::make_unique<RecordCost>(problem, i);
    std::vector<double*> blocks = {shared.data()};
    if (count > 0) blocks.push_back(block);
    all.AddResidualBlock(cost.release(), nullptr, blocks);  // the problem owns it
    if (count > 0) set_bounds(all, block, problem.own[i]);
    block += count;
  }
  const double cost = solve_dense(all, most_iterations);
  block = flat.data();
  for (Point& one : own) {
    std::copy_n(block, one.size(), one.begin());
    block += one.size();
  }
  return 2.0 * cost;
}

Solution solve(const Problem& problem, const Solution& start, int most_iterations, int held,
               double tolerance) {
  const QuietLibrary quiet;
  Solution found = start;
  clamp_into(found.shared, problem.bounds);
  std::vector<double> all_own;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    clamp_into(found.own[p], own_bounds(problem.parts[p].prior));
    all_own.insert(all_own.end(), found.own[p].begin(), found.own[p].end());
  }
  const Solution clamped = found;
  ceres::Problem::Options ownership;
  ownership.enable_fast_removal = false;
  ceres::Problem all(ownership);
  double* const shared = found.shared.data();
  all.AddParameterBlock(shared, static_cast<int>(found.shared.size()));
  set_bounds(all, shared, problem.bounds);
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    double* const own = &all_own[kOwnParameters * p];
    auto cost = std::make_unique<PartCost>(problem, problem.parts[p]);
    all.AddResidualBlock(cost.release(), nullptr, shared, own);
    set_bounds(all, own, own_bounds(problem.parts[p].prior));
  }
  if (held >= 0) {
    const auto index = static_cast<std::size_t>(held);
    const std::size_t count = found.shared.size();
    if (index < count) hold(all, shared, count, index);
    if (index >= count) hold(all, all_own.data(), kOwnParameters, index - count);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  if (problem.parts.size() > 1) {  // otherwise the own parameters of all parts would form one large matrix
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = own_before_shared(all_own, shared);
  }
  options.num_threads = 1;
  options.max_num_iterations = most_iterations;
  options.function_tolerance = tolerance;
  options.parameter_tolerance = 1e-9;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &all, &summary);
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    std::copy_n(&all_own[kOwnParameters * p], kOwnParameters, found.own[p].begin());
  }
  found.cost = cost_of(problem, found.shared, found.own);
  if (std::isfinite(found.cost)) return found;
  Solution as_it_was = clamped;
  as_it_was.cost = cost_of(problem, as_it_was.shared, as_it_was.own);
  return as_it_was;
}

}  // namespace palpate::identify
