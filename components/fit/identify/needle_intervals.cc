#include "fit/identify/needle_intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Dense>

#include "core/base/infinity.h"
#include "core/base/portable_math.h"
#include "core/base/statistics.h"
#include "palpate/units.h"

#include "fit/identify/intervals.h"

namespace palpate::identify {
namespace {

constexpr double kNeedleStep = 1e-4;  // of a parameter in the solver's form, for derivatives

/// Name, unit and layer of each value, and whether its interval is symmetric in the logarithm.
struct NeedleLabel {
  NeedleValue value;
  bool by_logarithm = false;
  bool is_puncture = false;
};

std::vector<NeedleLabel> needle_labels(const NeedleProblem& problem) {
  std::vector<NeedleLabel> all;
  for (const ParameterLabel& label : labels(problem.terms())) {
    if (label.shared) all.push_back({{label.name, label.unit, 0, {}}, true});
    if (label.name == "limit_mm") all.push_back({{"pull_limit_mm", kMillimetre, 0, {}}, true});
  }
  for (std::size_t k = 0; k < problem.layers(); ++k) {
    const int layer = static_cast<int>(k) + 1;
    if (k + 1 < problem.layers()) all.push_back({{"thickness_mm", kMillimetre, layer, {}}, true});
    all.push_back({{"puncture_force_N", 1.0, layer, {}}, false, true});
    all.push_back({{"cutting_force_N", 1.0, layer, {}}});
    all.push_back({{"friction_N", 1.0, layer, {}}});
    all.push_back({{"friction_N_per_mm", 1.0 / kMillimetre, layer, {}}});
  }
  return all;
}

/// Values in the order of needle_labels(). @param punctures mean force of each layer
std::vector<double> needle_values_at(const NeedleProblem& problem, const Point& shared,
                                     const std::vector<double>& punctures) {
  const model::TissueParameters tissue = problem.tissue(shared);
  std::vector<double> values = {tissue.k1, tissue.beta, tissue.q,
                                tissue.first_limit(model::Direction::kPress),
                                tissue.first_limit(model::Direction::kPull)};
  for (const model::RelaxationTerm& term : tissue.relaxation) values.insert(values.end(), {term.g, term.tau});
  for (std::size_t k = 0; k < tissue.layers.size(); ++k) {
    const model::TissueLayer& layer = tissue.layers[k];
    if (k + 1 < tissue.layers.size()) values.push_back(layer.thickness);
    values.insert(values.end(),
                  {punctures[k], layer.cutting_force, layer.friction, layer.friction_per_length});
  }
  return values;
}

std::vector<double> punctures_of(const NeedleProblem& problem, const NeedleRun& run) {
  std::vector<double> forces(problem.layers(), 0.0);
  for (std::size_t k = 0; k < std::min(forces.size(), run.punctures.size()); ++k)
    forces[k] = run.punctures[k].tip;
  return forces;
}

/// Sums for the covariance: of the parameters' normal equations, and the derivatives of the values.
struct Sums {
  Eigen::MatrixXd normal;
  Eigen::MatrixXd slopes;  // one row a value
};

Sums sums_of(const NeedleProblem& problem, const NeedlePoint& solution,
             const std::vector<NeedleLabel>& label) {
  const std::size_t shared = solution.shared.size();
  std::size_t all = shared;
  for (const Point& own : solution.own) all += own.size();
  const auto size = static_cast<Eigen::Index>(all);
  Sums sums{Eigen::MatrixXd::Zero(size, size),
            Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(label.size()), size)};
  const std::vector<double> no_punctures(problem.layers(), 0.0);
  for (std::size_t i = 0; i < shared; ++i) {
    Point up = solution.shared;
    Point down = solution.shared;
    up[i] += kNeedleStep;
    down[i] -= kNeedleStep;
    const std::vector<double> high = needle_values_at(problem, up, no_punctures);
    const std::vector<double> low = needle_values_at(problem, down, no_punctures);
    for (std::size_t v = 0; v < label.size(); ++v)
      sums.slopes(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(i)) =
          (high[v] - low[v]) / (2 * kNeedleStep);
  }
  std::size_t begin = shared;  // of the record's own parameters
  for (std::size_t r = 0; r < problem.records(); ++r) {
    const std::size_t own = solution.own[r].size();
    const auto rows = static_cast<Eigen::Index>(problem.record(r).thinned.size() + problem.priors());
    Eigen::MatrixXd jacobian(rows, static_cast<Eigen::Index>(shared + own));
    for (std::size_t i = 0; i < shared + own; ++i) {
      const auto run_at = [&](double step) {
        Point point = solution.shared;
        Point mine = solution.own[r];
        (i < shared ? point[i] : mine[i - shared]) += step;
        return problem.at(r, point, mine);
      };
      const NeedleProblem::Result high = run_at(kNeedleStep);
      const NeedleProblem::Result low = run_at(-kNeedleStep);
      const auto column = static_cast<Eigen::Index>(i);
      const auto place = static_cast<Eigen::Index>(i < shared ? i : begin + i - shared);
      for (Eigen::Index row = 0; row < rows; ++row) {
        const auto at = static_cast<std::size_t>(row);
        const bool valid = high.residuals.size() == low.residuals.size() && at < high.residuals.size();
        jacobian(row, column) = valid ? (high.residuals[at] - low.residuals[at]) / (2 * kNeedleStep) : 0.0;
      }
      const std::vector<double> more = punctures_of(problem, high.run);
      const std::vector<double> less = punctures_of(problem, low.run);
      std::size_t layer = 0;
      for (std::size_t v = 0; v < label.size(); ++v) {
        if (!label[v].is_puncture) continue;
        sums.slopes(static_cast<Eigen::Index>(v), place) +=
            (more[layer] - less[layer]) / (2 * kNeedleStep) / static_cast<double>(problem.records());
        ++layer;
      }
    }
    const Eigen::MatrixXd product = jacobian.transpose() * jacobian;
    for (std::size_t i = 0; i < shared + own; ++i) {
      for (std::size_t j = 0; j < shared + own; ++j) {
        sums.normal(static_cast<Eigen::Index>(i < shared ? i : begin + i - shared),
                    static_cast<Eigen::Index>(j < shared ? j : begin + j - shared)) +=
            product(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
    begin += own;
  }
  return sums;
}

/// Standard deviation of each value for residuals of variance 1. Directions that the residuals do not depend
/// on get a large variance.
Eigen::VectorXd spreads_of(const Sums& sums) {
  constexpr double kFlat = 1e-10;  // of the largest, with each parameter's diagonal at 1
  const Eigen::VectorXd scale =
      sums.normal.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * sums.normal * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  const double least = kFlat * solver.eigenvalues().maxCoeff();
  const Eigen::VectorXd lengths = solver.eigenvalues().cwiseMax(least).cwiseSqrt().cwiseInverse();
  // By rows of half the product: the product itself may be negative by rounding, or infinity times zero.
  const Eigen::MatrixXd slopes = sums.slopes * scale.asDiagonal();
  return (slopes * solver.eigenvectors() * lengths.asDiagonal()).rowwise().norm();
}

/// Sets the interval, and whether the value is determined: to half of itself, or a force to 2 % of the range.
void set_interval(Estimate& estimate, double error, bool by_logarithm, double negligible) {
  constexpr double kWidest = 0.5;      // half width of an interval, of its value
  constexpr double kLargestLog = 7.0;  // beyond a factor 1000 no interval says more
  if (by_logarithm) {
    const double factor = portable::exp(std::min(kLargestLog, error / std::abs(estimate.value)));
    estimate.interval = {estimate.value / factor, estimate.value * factor};
  } else {
    estimate.interval = {std::max(0.0, estimate.value - error), estimate.value + error};
  }
  const double half = 0.5 * (estimate.interval.high - estimate.interval.low);
  estimate.determined = half < std::max(kWidest * std::abs(estimate.value), negligible);
}

}  // namespace

std::vector<double> needle_numbers(const NeedleProblem& problem, const NeedlePoint& solution) {
  std::vector<double> punctures(problem.layers(), 0.0);
  for (std::size_t r = 0; r < problem.records(); ++r) {
    const std::vector<double> one =
        punctures_of(problem, problem.at(r, solution.shared, solution.own[r]).run);
    for (std::size_t k = 0; k < one.size(); ++k)
      punctures[k] += one[k] / static_cast<double>(problem.records());
  }
  return needle_values_at(problem, solution.shared, punctures);
}

model::TissueParameters needle_tissue(const NeedleProblem& problem, const NeedlePoint& solution) {
  model::TissueParameters tissue = problem.tissue(solution.shared);
  const std::vector<double> numbers = needle_numbers(problem, solution);
  const std::vector<NeedleLabel> labels = needle_labels(problem);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    if (!labels[v].is_puncture) continue;
    tissue.layers[static_cast<std::size_t>(labels[v].value.layer - 1)].puncture_force = numbers[v];
  }
  return tissue;
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
                                       const std::vector<std::vector<double>>& each) {
  constexpr double kNegligible = 0.02;  // of the range of force
  // Least squares knows one optimum; a needle's fit has others beside it, as numbers of the law compensate
  // for one another. With this factor the intervals hold the truth about as often as they say
  // (docs/needle.md).
  constexpr double kOtherOptima = 2.3;
  const std::vector<NeedleLabel> labels = needle_labels(problem);
  const std::vector<double> numbers = needle_numbers(problem, solution);
  const Sums sums = sums_of(problem, solution, labels);
  const Eigen::VectorXd spreads = spreads_of(sums);
  double points = 0.0;
  for (std::size_t r = 0; r < problem.records(); ++r)
    points += static_cast<double>(problem.record(r).thinned.size());
  const auto parameters = static_cast<double>(sums.normal.rows());
  const double effective =
      limited_sample_size(effective_rows(problem, solution), static_cast<std::size_t>(points),
                          static_cast<std::size_t>(sums.normal.rows()));
  const double variance = solution.squares / std::max(1.0, points - parameters) * points / effective;
  const double quantile = student_t_quantile(effective - parameters);
  const Insertion& first = problem.record(0);
  std::vector<NeedleValue> values;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    NeedleValue made = labels[v].value;
    made.estimate.value = numbers[v];
    double error = kOtherOptima * quantile * std::sqrt(variance) * spreads(static_cast<Eigen::Index>(v));
    std::vector<double> others;
    for (const std::vector<double>& one : each) others.push_back(one[v]);
    if (others.size() > 1) {
      const auto count = static_cast<double>(others.size());
      error =
          std::max(error, student_t_quantile(count - 1.0) * standard_deviation(others) / std::sqrt(count));
    }
    const bool per_length = made.name == "friction_N_per_mm";
    const double negligible = made.layer == 0 || labels[v].by_logarithm
                                  ? 0.0
                                  : kNegligible * first.range / (per_length ? first.deepest : 1.0);
    set_interval(made.estimate, error, labels[v].by_logarithm, negligible);
    if (made.name.ends_with("share"))
      made.estimate.interval.high = std::min(1.0, made.estimate.interval.high);
    values.push_back(std::move(made));
  }
  return values;
}

}  // namespace palpate::identify
