#include "fit/identify/needle_intervals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Dense>

#include "core/base/portable_math.h"
#include "core/base/statistics.h"
#include "palpate/units.h"

#include "fit/identify/intervals.h"

namespace palpate::identify {
namespace {

/// The parameters of a tissue's law, relaxation and layers.
std::vector<NeedleValue> tissue_values(const model::TissueParameters& tissue) {
  std::vector<NeedleValue> all;
  int layer = 0;
  const auto add = [&](std::string name, double value, double unit = 1.0) {
    all.push_back({std::move(name), unit, layer, {}});
    all.back().estimate.value = value;
  };
  add("k1_N_per_m", tissue.k1);
  add("beta", tissue.beta);
  add("q", tissue.q);
  add("limit_mm", tissue.first_limit(model::Direction::kPress), kMillimetre);
  add("pull_limit_mm", tissue.first_limit(model::Direction::kPull), kMillimetre);
  for (std::size_t i = 0; i < tissue.relaxation.size(); ++i) {
    const std::string term = "relaxation " + std::to_string(i + 1);
    add(term + " share", tissue.relaxation[i].g);
    add(term + " time_s", tissue.relaxation[i].tau);
  }
  for (const model::TissueLayer& one : tissue.layers) {
    ++layer;
    if (&one != &tissue.layers.back()) add("thickness_mm", one.thickness, kMillimetre);
    add("puncture_force_N", one.puncture_force);
    add("cutting_force_N", one.cutting_force);
    add("friction_N", one.friction);
    add("friction_N_per_mm", one.friction_per_length, 1.0 / kMillimetre);
  }
  return all;
}

/// Whether a value's interval is symmetric in the logarithm.
bool by_logarithm(const NeedleValue& value) { return value.layer == 0 || value.name == "thickness_mm"; }

constexpr double kThinnestLayer = 10e-6;  // m

/// Residuals of all records, and the tissue with the means of their puncture forces and thicknesses.
struct Outcome {
  std::vector<double> residuals;
  model::TissueParameters tissue;
};

Outcome outcome_at(const NeedleProblem& problem, const NeedlePoint& point) {
  Outcome outcome{{}, problem.tissue(point.shared)};
  std::vector<model::TissueLayer>& layers = outcome.tissue.layers;
  const auto records = static_cast<double>(problem.records());
  for (std::size_t k = 0; k + 1 < layers.size(); ++k) layers[k].thickness = kThinnestLayer;
  for (std::size_t r = 0; r < problem.records(); ++r) {
    const NeedleProblem::Result one = problem.at(r, point.shared, point.own[r]);
    outcome.residuals.insert(outcome.residuals.end(), one.residuals.begin(), one.residuals.end());
    const std::vector<Puncture>& punctures = one.run.punctures;
    for (std::size_t k = 0; k < punctures.size(); ++k) {
      layers[k].puncture_force += punctures[k].tip / records;
      if (k > 0) layers[k - 1].thickness += (punctures[k].length - punctures[k - 1].length) / records;
    }
  }
  return outcome;
}

/// Derivatives by all parameters, shared ones first: of the residuals, and of the values.
struct Slopes {
  Eigen::MatrixXd residuals;
  Eigen::MatrixXd values;
};

Slopes slopes_at(const NeedleProblem& problem, NeedlePoint point) {
  std::vector<double*> parameters;
  for (double& one : point.shared) parameters.push_back(&one);
  for (Point& own : point.own) {
    for (double& one : own) parameters.push_back(&one);
  }
  const Outcome middle = outcome_at(problem, point);
  const auto columns = static_cast<Eigen::Index>(parameters.size());
  const auto rows = static_cast<Eigen::Index>(middle.residuals.size());
  const auto values = static_cast<Eigen::Index>(tissue_values(middle.tissue).size());
  Slopes slopes{Eigen::MatrixXd::Zero(rows, columns), Eigen::MatrixXd::Zero(values, columns)};
  for (Eigen::Index i = 0; i < columns; ++i) {
    double& parameter = *parameters[static_cast<std::size_t>(i)];
    const double here = parameter;
    std::array<Outcome, 4> at;
    for (std::size_t k = 0; k < at.size(); ++k) {
      parameter = here + (2.0 * static_cast<double>(k) - 3.0) * kNeedleStep;
      at.at(k) = outcome_at(problem, point);
    }
    parameter = here;
    if (std::any_of(at.begin(), at.end(),
                    [&](const Outcome& one) { return one.residuals.size() != middle.residuals.size(); })) {
      continue;  // no valid law
    }
    // Where a parameter moves an event into another tick, the force has a small jump. It is in one of the
    // three steps at most: their median is without it.
    const auto slope = [](double a, double b, double c, double d) {
      const double low = std::min(b - a, c - b);
      const double high = std::max(b - a, c - b);
      return std::clamp(d - c, low, high) / (2 * kNeedleStep);
    };
    std::array<std::vector<NeedleValue>, 4> all;
    std::transform(at.begin(), at.end(), all.begin(),
                   [](const Outcome& one) { return tissue_values(one.tissue); });
    for (std::size_t v = 0; v < all[0].size(); ++v) {
      slopes.values(static_cast<Eigen::Index>(v), i) =
          slope(all[0][v].estimate.value, all[1][v].estimate.value, all[2][v].estimate.value,
                all[3][v].estimate.value);
    }
    for (std::size_t row = 0; row < middle.residuals.size(); ++row) {
      slopes.residuals(static_cast<Eigen::Index>(row), i) =
          slope(at[0].residuals[row], at[1].residuals[row], at[2].residuals[row], at[3].residuals[row]);
    }
  }
  return slopes;
}

/// Standard deviation of each value for residuals of variance 1. Directions that the residuals do not depend
/// on get a large variance.
Eigen::VectorXd spreads_of(const Slopes& slopes) {
  constexpr double kFlat = 1e-10;  // of the largest, with each parameter's diagonal at 1
  const Eigen::MatrixXd normal = slopes.residuals.transpose() * slopes.residuals;
  const Eigen::VectorXd scale =
      normal.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  const double least = kFlat * solver.eigenvalues().maxCoeff();
  const Eigen::VectorXd lengths = solver.eigenvalues().cwiseMax(least).cwiseSqrt().cwiseInverse();
  // By rows of half the product: the product itself may be negative by rounding, or infinity times zero.
  return (slopes.values * scale.asDiagonal() * solver.eigenvectors() * lengths.asDiagonal()).rowwise().norm();
}

/// Sets the interval, and whether the value is determined: to half of itself, or a force to `negligible`.
void set_interval(NeedleValue& value, double error, double negligible) {
  constexpr double kWidest = 0.5;      // half width of an interval, of its value
  constexpr double kLargestLog = 7.0;  // beyond a factor 1000 no interval says more
  Estimate& estimate = value.estimate;
  if (by_logarithm(value)) {
    const double factor = portable::exp(std::min(kLargestLog, error / std::abs(estimate.value)));
    estimate.interval = {estimate.value / factor, estimate.value * factor};
    negligible = 0.0;
  } else {
    estimate.interval = {std::max(0.0, estimate.value - error), estimate.value + error};
  }
  if (value.name.ends_with("share")) estimate.interval.high = std::min(1.0, estimate.interval.high);
  const double half = 0.5 * (estimate.interval.high - estimate.interval.low);
  estimate.determined = half < std::max(kWidest * std::abs(estimate.value), negligible);
}

}  // namespace

model::TissueParameters needle_tissue(const NeedleProblem& problem, const NeedlePoint& solution) {
  return outcome_at(problem, solution).tissue;
}

double effective_rows(const NeedleProblem& problem, const NeedlePoint& solution) {
  double sum = 0.0;
  for (std::size_t r = 0; r < problem.records(); ++r) {
    std::vector<double> residuals = problem.at(r, solution.shared, solution.own[r]).residuals;
    residuals.resize(problem.record(r).thinned.size());
    sum += effective_sample_size(residuals);
  }
  return sum;
}

std::vector<NeedleValue> needle_values(const NeedleProblem& problem, const NeedlePoint& solution,
                                       const std::vector<model::TissueParameters>& each) {
  constexpr double kNegligible = 0.02;  // of the range of force
  // Without it intervals hold the truth of synthetic records in 88 % (docs/needle.md): a fit's ticks are
  // long.
  constexpr double kUnseen = 1.4;
  const Slopes slopes = slopes_at(problem, solution);
  const Eigen::VectorXd spreads = spreads_of(slopes);
  std::size_t rows = 0;
  for (std::size_t r = 0; r < problem.records(); ++r) rows += problem.record(r).thinned.size();
  const auto parameters = static_cast<std::size_t>(slopes.residuals.cols());
  const auto points = static_cast<double>(rows);
  const auto count = static_cast<double>(parameters);
  const double effective = limited_sample_size(effective_rows(problem, solution), rows, parameters);
  const double variance = solution.squares / std::max(1.0, points - count) * points / effective;
  const double factor = kUnseen * student_t_quantile(effective - count) * std::sqrt(variance);
  std::vector<NeedleValue> values = tissue_values(needle_tissue(problem, solution));
  const auto fits = static_cast<double>(each.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    double error = factor * spreads(static_cast<Eigen::Index>(v));
    std::vector<double> others;
    for (const model::TissueParameters& one : each) others.push_back(tissue_values(one)[v].estimate.value);
    if (others.size() > 1)
      error = std::max(error, student_t_quantile(fits - 1.0) * standard_deviation(others) / std::sqrt(fits));
    const double length = values[v].name == "friction_N_per_mm" ? problem.record(0).deepest : 1.0;
    set_interval(values[v], error, kNegligible * problem.record(0).range / length);
  }
  return values;
}

}  // namespace palpate::identify
