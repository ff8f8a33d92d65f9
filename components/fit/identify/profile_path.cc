#include "fit/identify/profile_path.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Dense>

#include "fit/identify/intervals.h"

namespace palpate::identify {
namespace {

constexpr int kIterations = 20;  // of each fit along the path

/// Length of a unit step: 1 in a logarithm, 0.1 of a range.
double unit_of(const Solution& at, std::size_t index) { return index < at.shared.size() ? 1.0 : 0.1; }

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using OnePart = Eigen::Matrix<double, Eigen::Dynamic, static_cast<int>(kOwnParameters)>;

/// Elimination of a part's own parameters by linear least squares.
struct Eliminated {
  OnePart own;
  Eigen::MatrixXd rest;   // Jacobian by the shared parameters, and the right-hand side
  Eigen::MatrixXd taken;  // own parameters that best fit each column of `rest`

  [[nodiscard]] Eigen::MatrixXd left() const { return rest - own * taken; }
};

/// `at` plus `step` times `way`, clamped to the bounds.
Solution moved_by(const Problem& problem, const Solution& at, const Point& way, double step) {
  Solution next = at;
  const std::size_t shared = at.shared.size();
  for (std::size_t i = 0; i < shared; ++i) {
    next.shared[i] = std::clamp(at.shared[i] + step * way[i], problem.bounds.low[i], problem.bounds.high[i]);
  }
  for (std::size_t p = 0; p < at.own.size(); ++p) {
    const Bounds own = own_bounds(problem.parts[p].prior);
    for (std::size_t i = 0; i < kOwnParameters; ++i) {
      const double by = step * way[shared + kOwnParameters * p + i];
      next.own[p][i] = std::clamp(at.own[p][i] + by, own.low[i], own.high[i]);
    }
  }
  return next;
}

}  // namespace

Point profile_tangent(const Problem& problem, const Solution& at, std::size_t index) {
  const auto shared = static_cast<Eigen::Index>(at.shared.size());
  const auto moved = static_cast<Eigen::Index>(index);
  std::vector<Eliminated> parts;
  Eigen::Index rows = 0;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    const Part& part = problem.parts[p];
    const std::vector<double> derivatives = jacobian(problem, part, at.shared, at.own[p]);
    const auto count = static_cast<Eigen::Index>(residual_count(part));
    RowMajor all = Eigen::Map<const RowMajor>(derivatives.data(), count,
                                              shared + static_cast<Eigen::Index>(kOwnParameters));
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    if (moved < shared || p == 0) {
      right = -all.col(moved);
      all.col(moved).setZero();
    }
    Eliminated& made = parts.emplace_back();
    made.own = all.rightCols<static_cast<int>(kOwnParameters)>();
    made.rest.resize(count, shared + 1);
    made.rest << all.leftCols(shared), right;
    made.taken = made.own.colPivHouseholderQr().solve(made.rest);
    rows += count;
  }
  Eigen::MatrixXd left(rows, shared + 1);
  Eigen::Index row = 0;
  for (const Eliminated& part : parts) {
    left.middleRows(row, part.rest.rows()) = part.left();
    row += part.rest.rows();
  }
  const Eigen::VectorXd along = left.leftCols(shared).colPivHouseholderQr().solve(left.col(shared));
  Point way(along.data(), along.data() + along.size());
  for (const Eliminated& part : parts) {
    const Eigen::VectorXd own = part.taken.col(shared) - part.taken.leftCols(shared) * along;
    way.insert(way.end(), own.data(), own.data() + own.size());
  }
  for (double& value : way) value = std::isfinite(value) ? value : 0.0;
  way[index] = 1.0;
  return way;
}

double parameter_of(const Solution& solution, std::size_t index) {
  const std::size_t shared = solution.shared.size();
  return index < shared ? solution.shared[index] : solution.own.front()[index - shared];
}

Solution profile_step(const Problem& problem, const Solution& at, std::size_t index, double step) {
  const Solution next = moved_by(problem, at, profile_tangent(problem, at, index), step);
  return solve(problem, next, kIterations, static_cast<int>(index));
}

Solution profile_at(const Problem& problem, Solution at, std::size_t index, double value) {
  constexpr double kLongest = 0.4;
  const double longest = kLongest * unit_of(at, index);
  const double way = value - parameter_of(at, index);
  const auto steps = static_cast<int>(std::max(1.0, std::ceil(std::abs(way) / longest)));
  for (int n = 0; n < steps; ++n) {
    const double left = value - parameter_of(at, index);
    at = profile_step(problem, at, index, left / (steps - n));
  }
  return at;
}

void follow_profile_path(const Problem& problem, const Solution& from, std::size_t index, double direction,
                         const std::function<double(const Solution&)>& excess,
                         const std::function<void(const Solution&)>& visit) {
  constexpr int kMaxSteps = 40;
  constexpr double kFirst = 0.1;
  constexpr double kLongest = 0.6;
  constexpr double kShortest = 1e-5;
  constexpr double kEnd = 0.1;         // of the path so far: accuracy of the interval's end
  constexpr double kStraight = 1.5;    // largest excess from which the interval's end is interpolated
  constexpr double kAtEnd = 1.1;       // largest excess there
  constexpr double kTolerance = 1e-7;  // relative, of the sum of squares: enough for an interval
  const double unit = unit_of(from, index);
  Solution at = from;
  double here = excess(at);
  double step = kFirst;
  double gone = 0.0;
  for (int n = 0; n < kMaxSteps && step >= std::clamp(kEnd * gone, kShortest, 0.03); ++n) {
    const Solution start =
        moved_by(problem, at, profile_tangent(problem, at, index), direction * step * unit);
    if (parameter_of(start, index) == parameter_of(at, index)) return;
    Solution next = solve(problem, start, kIterations, static_cast<int>(index), kTolerance);
    const double there = excess(next);
    if (there <= 1.0) {
      visit(next);
      gone += step;
      const double left = there > here ? 1.1 * step * (1.0 - there) / (there - here) : kLongest;
      step = std::clamp(left, 0.5 * step, std::min(2.0 * step, kLongest));
      at = std::move(next);
      here = there;
    } else if (there <= kStraight) {
      const double way = parameter_of(next, index) - parameter_of(at, index);
      const Solution end = profile_step(problem, at, index, way * (1.0 - here) / (there - here));
      if (excess(end) <= kAtEnd) visit(end);
      return;
    } else {
      step *= 0.4;
    }
  }
}

std::vector<double> part_costs(const Problem& problem, const Solution& solution) {
  std::vector<double> costs;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    std::vector<double> values(residual_count(problem.parts[p]));
    residuals(problem, problem.parts[p], solution.shared, solution.own[p], values);
    costs.push_back(std::inner_product(values.begin(), values.end(), values.begin(), 0.0));
  }
  return costs;
}

bool in_confidence_set(const std::vector<double>& best, const std::vector<double>& other) {
  constexpr double kNoWorse = 1e-3;  // of the sum of squares: not distinguishable
  const auto count = static_cast<double>(best.size());
  double all = 0.0;
  double worse = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < best.size(); ++i) {
    const double by = other[i] - best[i];
    all += best[i];
    worse += by;
    squares += by * by;
  }
  if (!std::isfinite(worse)) return false;
  if (worse <= kNoWorse * all) return true;
  if (best.size() < 2) return false;
  const double variance = std::max(0.0, squares - worse * worse / count) / (count - 1.0);
  // factor 0.5: the cost is quadratic, so its increase is half of its slope at the interval's end times the
  // step
  return worse <= 0.5 * student_t_quantile(count - 1.0) * std::sqrt(count * variance);
}

}  // namespace palpate::identify
