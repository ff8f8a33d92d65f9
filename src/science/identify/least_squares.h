#pragma once
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "palpate/identify.h"

namespace palpate::identify {

/// Of the range of force: no sensor tells more digits, so residuals below say nothing.
inline constexpr double kSmallestSigma = 1e-5;

/// One specimen's part of a least-squares problem.
struct Part {
  const Specimen* specimen = nullptr;
  Ranges ranges;
  OwnPrior prior;
  std::vector<double> weight;  // of each point's square, >= 0
};

/// Find the shared parameters, and each specimen's own, with the least sum of squares. Residuals are in
/// shares of a specimen's range of force.
struct Problem {
  Settings settings;
  std::size_t terms = 0;  // of relaxation
  Bounds bounds;          // of the shared parameters
  std::vector<Part> parts;
  /// Cauchy's loss: a residual r counts c^2 ln(1 + (r/c)^2) with this c, r^2 when it is infinite.
  double loss_scale = std::numeric_limits<double>::infinity();
  /// Standard deviation of the residuals, against which the priors of the own parameters are weighed.
  double sigma = 0.01;
};

/// [setup] One part, every point of weight 1. The specimen must outlive it. @throws as ranges_of().
[[nodiscard]] Part make_part(const Specimen& specimen);

/// [setup] The problem of these parts, with bounds for all of them.
[[nodiscard]] Problem make_problem(const Settings& settings, std::size_t terms, std::vector<Part> parts);

struct Solution {
  Point shared;
  std::vector<Point> own;                                 // one a part
  double cost = std::numeric_limits<double>::infinity();  // sum of squares, priors included
};

/// [setup] Number of residuals of a part: its points and its two priors.
[[nodiscard]] std::size_t residual_count(const Part& part) noexcept;

/// [setup] The residuals of a part, after the loss and times the root of their weights, then the priors'.
void residuals(const Problem& problem, const Part& part, std::span<const double> shared,
               std::span<const double> own, std::span<double> out);

/// [setup] Sum of squares of all residuals, infinite where the parameters make no law.
[[nodiscard]] double cost_of(const Problem& problem, const Point& shared, const std::vector<Point>& own);

/// [setup] Levenberg and Marquardt's method within the bounds, from `start` (clamped into them), by Ceres in
/// one thread: the same input gives the same bits.
/// @param held index of a parameter that stays as it is, shared ones first, then the first part's own; none
/// when negative @param tolerance ends the descent when a step gains less of the sum of squares
[[nodiscard]] Solution solve(const Problem& problem, const Solution& start, int most_iterations = 60,
                             int held = -1, double tolerance = 1e-9);

/// [setup] Derivatives of a part's residuals: one row a residual, shared parameters first, row by row. Exact
/// for k_1 and the offset, by central differences for the others.
[[nodiscard]] std::vector<double> jacobian(const Problem& problem, const Part& part,
                                           std::span<const double> shared, std::span<const double> own);

/// The sum of squares of a few parameters whose derivatives are found by central differences.
struct SmallProblem {
  Bounds bounds;
  std::size_t residuals = 0;
  std::function<void(std::span<const double>, std::span<double>)> errors;  // of parameters, to residuals
};

/// [setup] Levenberg and Marquardt's method from `point`, which must lie within the bounds, as solve().
/// @param held index of a parameter that stays as it is; none when negative
/// @return half the sum of squares that is left; infinite when no step led to numbers
double minimise(const SmallProblem& problem, Point& point, int most_iterations, int held = -1);

}  // namespace palpate::identify
