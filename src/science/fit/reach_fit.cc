#include "science/fit/reach_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include <ceres/ceres.h>

#include "palpate/error.h"
#include "palpate/validation.h"

namespace palpate::fit {
namespace {

constexpr std::size_t kParameters = 5;
constexpr std::size_t kExponent = 4;
using Shape = std::array<double, kParameters>;  // ln c, ln a, ln(s - 1), g, p

// Wider than any tissue known: a bar of 1/50 to 5 tool sizes, bars that hardly grow or grow fivefold.
const Shape kLow = {std::log(0.2), std::log(0.02), std::log(0.05), 0.02, 0.02};
const Shape kHigh = {std::log(4.0), std::log(5.0), std::log(4.0), 0.98, 1.0};

/// @param ratios ln c, ln a, ln(s - 1), g @param exponent p
model::ReachParameters reach_of(const double* ratios, double exponent) {
  return {std::exp(ratios[0]), std::exp(ratios[1]), 1.0 + std::exp(ratios[2]), ratios[3], exponent};
}

/// (u of the model - u of the sample)/D at every place, over the root of their number.
class SampleErrors final {
 public:
  SampleErrors(const ReachSample& sample, const SurfaceRule& rule) : sample_(sample), rule_(rule) {}

  /// @param blocks the four ratios, and p
  bool operator()(double const* const* blocks, double* errors) const {
    const BallSurface surface(reach_of(blocks[0], *blocks[1]), sample_.depth, sample_.tip_radius, rule_);
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

double solve_from(const std::vector<ReachSample>& samples, const SurfaceRule& rule, bool keep_exponent,
                  Shape& shape) {
  ceres::Problem problem;
  double* const ratios = shape.data();
  double* const exponent = &shape[kExponent];
  problem.AddParameterBlock(ratios, static_cast<int>(kExponent));
  for (std::size_t i = 0; i < kExponent; ++i) {
    problem.SetParameterLowerBound(ratios, static_cast<int>(i), kLow[i]);
    problem.SetParameterUpperBound(ratios, static_cast<int>(i), kHigh[i]);
  }
  problem.AddParameterBlock(exponent, 1);
  if (keep_exponent) {
    problem.SetParameterBlockConstant(exponent);
  } else {
    problem.SetParameterLowerBound(exponent, 0, kLow[kExponent]);
    problem.SetParameterUpperBound(exponent, 0, kHigh[kExponent]);
  }
  for (const ReachSample& sample : samples) {
    auto errors = std::make_unique<SampleErrors>(sample, rule);
    auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<SampleErrors, ceres::CENTRAL>>(
        errors.release());
    cost->AddParameterBlock(static_cast<int>(kExponent));
    cost->AddParameterBlock(1);
    cost->SetNumResiduals(static_cast<int>(sample.deformation.size()));
    problem.AddResidualBlock(cost.release(), nullptr, ratios, exponent);  // the problem owns it
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

/// Whether the samples say how the contact radius goes with depth.
bool depths_differ(const std::vector<ReachSample>& samples) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (const ReachSample& sample : samples) {
    least = std::min(least, sample.depth / sample.tip_radius);
    most = std::max(most, sample.depth / sample.tip_radius);
  }
  return most >= kLeastSpreadOfDepths * least;
}

/// The best of several starts.
Shape best_shape(const std::vector<ReachSample>& samples, const SurfaceRule& rule, bool keep_exponent,
                 double exponent) {
  double best_cost = std::numeric_limits<double>::infinity();
  Shape best = kLow;
  best[kExponent] = exponent;
  for (const double c : {0.8, 1.3}) {
    for (const double a : {0.2, 0.6}) {
      for (const double s : {1.4, 2.0}) {
        for (const double g : {0.4, 0.7}) {
          Shape shape = {std::log(c), std::log(a), std::log(s - 1.0), g, exponent};
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

ReachFit fit_reach(const std::vector<ReachSample>& samples, const SurfaceRule& rule, double exponent) {
  if (samples.empty()) throw InputError("a reach needs at least one deformation");
  for (const ReachSample& sample : samples) {
    if (!(sample.depth > 0.0) || !(sample.tip_radius > 0.0)) {
      throw InputError(sample.deformation.name + ": a reach needs the tool's depth and radius, both > 0");
    }
  }
  ReachFit fit;
  fit.exponent_kept = !depths_differ(samples);
  const double start = fit.exponent_kept ? exponent : model::ReachParameters{}.depth_exponent;
  const Shape best = best_shape(samples, rule, fit.exponent_kept, start);
  fit.reach = reach_of(best.data(), best[kExponent]);
  for (std::size_t i = 0; i < kParameters; ++i) {
    const double margin = 1e-6 * (kHigh[i] - kLow[i]);
    const bool at_bound = best[i] < kLow[i] + margin || best[i] > kHigh[i] - margin;
    fit.at_limit.push_back(at_bound && !(i == kExponent && fit.exponent_kept));
  }
  for (const ReachSample& sample : samples) {
    fit.nrmse.push_back(
        compare_deformation(sample.deformation, fit.reach, sample.depth, sample.tip_radius, rule)
            .errors.nrmse);
  }
  return fit;
}

}  // namespace palpate::fit
