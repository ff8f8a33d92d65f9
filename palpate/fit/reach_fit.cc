#include "palpate/fit/reach_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include <ceres/ceres.h>

#include "palpate/base/error.h"
#include "palpate/fit/validation.h"

namespace palpate::fit {
namespace {

constexpr int kParameters = 4;
using Shape = std::array<double, kParameters>;  // ln c, ln a, ln(s - 1), g

// Wider than any tissue known: a bar of 1/50 to 5 tool sizes, bars that hardly grow or grow fivefold.
const Shape kLow = {std::log(0.2), std::log(0.02), std::log(0.05), 0.02};
const Shape kHigh = {std::log(4.0), std::log(5.0), std::log(4.0), 0.98};

model::ReachParameters reach_of(const double* shape) {
  return {std::exp(shape[0]), std::exp(shape[1]), 1.0 + std::exp(shape[2]), shape[3]};
}

/// (u of the model - u of the sample)/D at every place, over the root of their number.
class SampleErrors final {
 public:
  SampleErrors(const ReachSample& sample, const SurfaceRule& rule) : sample_(sample), rule_(rule) {}

  bool operator()(double const* const* shape, double* errors) const {
    const BallSurface surface(reach_of(shape[0]), sample_.depth, sample_.tip_radius, rule_);
    const Deformation& measured = sample_.deformation;
    const double scale = sample_.depth * std::sqrt(static_cast<double>(measured.size()));
    for (std::size_t i = 0; i < measured.size(); ++i) {
      errors[i] = (surface.at(measured.distance[i]) - measured.displacement[i]) / scale;
    }
    return true;
  }

 private:
  const ReachSample& sample_;
  SurfaceRule rule_;
};

double solve_from(const std::vector<ReachSample>& samples, const SurfaceRule& rule, Shape& shape) {
  ceres::Problem problem;
  problem.AddParameterBlock(shape.data(), kParameters);
  for (int i = 0; i < kParameters; ++i) {
    const auto n = static_cast<std::size_t>(i);
    problem.SetParameterLowerBound(shape.data(), i, kLow[n]);
    problem.SetParameterUpperBound(shape.data(), i, kHigh[n]);
  }
  for (const ReachSample& sample : samples) {
    auto errors = std::make_unique<SampleErrors>(sample, rule);
    auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<SampleErrors, ceres::CENTRAL>>(
        errors.release());
    cost->AddParameterBlock(kParameters);
    cost->SetNumResiduals(static_cast<int>(sample.deformation.size()));
    problem.AddResidualBlock(cost.release(), nullptr, shape.data());  // the problem owns it
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable() ? summary.final_cost : std::numeric_limits<double>::infinity();
}

}  // namespace

ReachFit fit_reach(const std::vector<ReachSample>& samples, const SurfaceRule& rule) {
  if (samples.empty()) throw InputError("a reach needs at least one deformation");
  for (const ReachSample& sample : samples) {
    if (!(sample.depth > 0.0) || !(sample.tip_radius > 0.0)) {
      throw InputError(sample.deformation.name + ": a reach needs the tool's depth and radius, both > 0");
    }
  }
  double best_cost = std::numeric_limits<double>::infinity();
  Shape best = kLow;
  for (const double c : {0.8, 1.3}) {
    for (const double a : {0.2, 0.6}) {
      for (const double s : {1.4, 2.0}) {
        for (const double g : {0.4, 0.7}) {
          Shape shape = {std::log(c), std::log(a), std::log(s - 1.0), g};
          const double cost = solve_from(samples, rule, shape);
          if (cost < best_cost) {
            best_cost = cost;
            best = shape;
          }
        }
      }
    }
  }
  ReachFit fit;
  fit.reach = reach_of(best.data());
  for (std::size_t i = 0; i < kParameters; ++i) {
    const double margin = 1e-6 * (kHigh[i] - kLow[i]);
    fit.at_limit.push_back(best[i] < kLow[i] + margin || best[i] > kHigh[i] - margin);
  }
  for (const ReachSample& sample : samples) {
    fit.nrmse.push_back(
        compare_deformation(sample.deformation, fit.reach, sample.depth, sample.tip_radius, rule)
            .errors.nrmse);
  }
  return fit;
}

}  // namespace palpate::fit
