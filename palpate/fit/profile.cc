#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "palpate/fit/ensemble.h"
#include "palpate/fit/intervals.h"

namespace palpate::fit {
namespace {

constexpr int kIterations = 20;  // of each fit along the way

Point joined(const Solution& solution) {
  Point point = solution.shared;
  point.insert(point.end(), solution.own.front().begin(), solution.own.front().end());
  return point;
}

/// How the other parameters go with one, to first order, when they are fitted again: 1 for that one.
Point tangent(const Problem& problem, const Solution& at, std::size_t index) {
  const Part& part = problem.parts.front();
  const std::vector<double> derivatives = jacobian(problem, part, at.shared, at.own.front());
  const auto rows = static_cast<Eigen::Index>(residual_count(part));
  const auto columns = static_cast<Eigen::Index>(at.shared.size() + kOwnParameters);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::MatrixXd others = Eigen::Map<const RowMajor>(derivatives.data(), rows, columns);
  const auto moved = static_cast<Eigen::Index>(index);
  const Eigen::VectorXd right = -others.col(moved);
  others.col(moved).setZero();
  const Eigen::VectorXd along = others.colPivHouseholderQr().solve(right);
  Point way(along.data(), along.data() + along.size());
  for (double& value : way) value = std::isfinite(value) ? value : 0.0;
  way[index] = 1.0;
  return way;
}

/// `at` moved by `step` times `way`, within the bounds.
Solution moved_by(const Problem& problem, const Solution& at, const Point& way, double step) {
  Solution next = at;
  const Bounds own = own_bounds(problem.parts.front().prior);
  const std::size_t shared = at.shared.size();
  for (std::size_t i = 0; i < way.size(); ++i) {
    const bool is_shared = i < shared;
    double& value = is_shared ? next.shared[i] : next.own.front()[i - shared];
    const double low = is_shared ? problem.bounds.low[i] : own.low[i - shared];
    const double high = is_shared ? problem.bounds.high[i] : own.high[i - shared];
    value = std::clamp(value + step * way[i], low, high);
  }
  return next;
}

/// Walks one parameter from `from` in one direction as long as `floor` is not passed, adding every point on
/// the way.
void walk(const Problem& problem, const Solution& from, std::size_t index, double direction, double effective,
          double floor, std::vector<Point>& points) {
  constexpr int kMostSteps = 40;
  constexpr double kFirst = 0.1;  // of a logarithm; of a range a tenth of it
  constexpr double kLongest = 0.6;
  constexpr double kShortest = 1e-5;
  constexpr double kEnd = 0.1;  // of the way so far: the end of the interval is found well enough
  const double unit = index < from.shared.size() ? 1.0 : 0.1;
  Solution at = from;
  double step = kFirst;
  double gone = 0.0;
  for (int n = 0; n < kMostSteps && step >= std::clamp(kEnd * gone, kShortest, 0.03); ++n) {
    const Point way = tangent(problem, at, index);
    Solution next = moved_by(problem, at, way, direction * step * unit);
    const double before = joined(at)[index];
    if (joined(next)[index] == before) return;
    next = solve(problem, next, kIterations, static_cast<int>(index));
    const Point point = joined(next);
    if (log_posterior_of(problem, point, effective) >= floor) {
      points.push_back(point);
      at = std::move(next);
      gone += step;
      step = std::min(1.6 * step, kLongest);
    } else {
      step *= 0.4;
    }
  }
}

}  // namespace

std::vector<Point> profile_points(const Minima& minima, double effective) {
  const Problem& problem = minima.problem;
  const double best = log_posterior_of(problem, joined(minima.all.front()), effective);
  const double t = student(effective - static_cast<double>(problem.bounds.low.size() + kOwnParameters));
  const double floor = best - 0.5 * t * t;
  const std::size_t relaxation = problem.bounds.low.size();  // which is not walked
  std::vector<Point> points;
  for (const Solution& minimum : minima.all) {
    if (!(log_posterior_of(problem, joined(minimum), effective) >= floor)) continue;
    points.push_back(joined(minimum));
    for (std::size_t i = 0; i < relaxation + kOwnParameters; ++i) {
      if (i >= kLawParameters && i < relaxation) continue;
      for (const double direction : {-1.0, 1.0}) {
        walk(problem, minimum, i, direction, effective, floor, points);
      }
    }
  }
  return points;
}

}  // namespace palpate::fit
