#include <algorithm>
#include <cmath>

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

/// Walks one parameter from `from` in one direction as long as `floor` is not passed, adding every point on
/// the way.
void walk(const Problem& problem, const Solution& from, std::size_t index, double direction, double effective,
          double floor, std::vector<Point>& points) {
  constexpr int kMostSteps = 25;
  constexpr double kFirst = 0.1;  // of a logarithm
  constexpr double kLongest = 0.6;
  constexpr double kShortest = 0.03;
  Solution at = from;
  double step = kFirst;
  for (int n = 0; n < kMostSteps && step >= kShortest; ++n) {
    Solution next = at;
    next.shared[index] = std::clamp(at.shared[index] + direction * step, problem.bounds.low[index],
                                    problem.bounds.high[index]);
    if (next.shared[index] == at.shared[index]) return;
    next = solve(problem, next, kIterations, static_cast<int>(index));
    const Point point = joined(next);
    if (log_posterior_of(problem, point, effective) >= floor) {
      points.push_back(point);
      at = std::move(next);
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
  std::vector<Point> points;
  for (const Solution& minimum : minima.all) {
    if (!(log_posterior_of(problem, joined(minimum), effective) >= floor)) continue;
    points.push_back(joined(minimum));
    for (std::size_t i = 0; i < kLawParameters; ++i) {
      for (const double direction : {-1.0, 1.0}) {
        walk(problem, minimum, i, direction, effective, floor, points);
      }
    }
  }
  return points;
}

}  // namespace palpate::fit
