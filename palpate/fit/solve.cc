#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <ceres/ceres.h>
#include <glog/logging.h>

#include "palpate/fit/least_squares.h"

namespace palpate::fit {
namespace {

bool all_finite(const double* values, std::size_t count) {
  return std::all_of(values, values + count, [](double value) { return std::isfinite(value); });
}

/// A part's residuals and derivatives, as Ceres asks for them: blocks of shared and of own parameters.
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
    const std::size_t rows = residual_count(part_);
    residuals(problem_, part_, shared, own, {values, rows});
    if (!all_finite(values, rows)) return false;
    if (derivatives == nullptr) return true;
    const std::vector<double> all = jacobian(problem_, part_, shared, own);
    const std::size_t columns = shared.size() + own.size();
    for (std::size_t r = 0; r < rows; ++r) {
      const double* const row = all.data() + r * columns;
      if (derivatives[0] != nullptr) std::copy_n(row, shared.size(), derivatives[0] + r * shared.size());
      if (derivatives[1] != nullptr) {
        std::copy_n(row + shared.size(), own.size(), derivatives[1] + r * own.size());
      }
    }
    return all_finite(all.data(), all.size());
  }

 private:
  const Problem& problem_;
  const Part& part_;
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

/// Keeps one parameter as it is: a shared one, or one of the first part's own; none when negative.
void hold(ceres::Problem& problem, Solution& solution, int held) {
  if (held < 0) return;
  const auto shared = static_cast<int>(solution.shared.size());
  std::vector<double>& block = held < shared ? solution.shared : solution.own.front();
  const int within = held < shared ? held : held - shared;
  auto manifold =
      std::make_unique<ceres::SubsetManifold>(static_cast<int>(block.size()), std::vector<int>{within});
  problem.SetManifold(block.data(), manifold.release());  // the problem owns it
}

/// Keeps from users what Ceres writes of a step that led to no number; cost_of() tells it too.
void quiet_library() noexcept { FLAGS_minloglevel = google::GLOG_FATAL; }

}  // namespace

Solution solve(const Problem& problem, const Solution& start, int most_iterations, int held) {
  quiet_library();
  Solution found = start;
  clamp_into(found.shared, problem.bounds);
  ceres::Problem::Options ownership;
  ownership.enable_fast_removal = false;
  ceres::Problem all(ownership);
  all.AddParameterBlock(found.shared.data(), static_cast<int>(found.shared.size()));
  set_bounds(all, found.shared.data(), problem.bounds);
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    const Bounds bounds = own_bounds(problem.parts[p].prior);
    clamp_into(found.own[p], bounds);
    auto cost = std::make_unique<PartCost>(problem, problem.parts[p]);
    all.AddResidualBlock(cost.release(), nullptr, found.shared.data(), found.own[p].data());
    set_bounds(all, found.own[p].data(), bounds);
  }
  hold(all, found, held);
  const Solution clamped = found;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = most_iterations;
  options.function_tolerance = 1e-9;
  options.parameter_tolerance = 1e-9;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &all, &summary);
  found.cost = cost_of(problem, found.shared, found.own);
  if (std::isfinite(found.cost)) return found;
  Solution as_it_was = clamped;
  as_it_was.cost = cost_of(problem, as_it_was.shared, as_it_was.own);
  return as_it_was;
}

}  // namespace palpate::fit
