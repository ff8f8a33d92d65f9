#include "science/fit/distributions.h"
#include "science/fit/ensemble.h"
#include "science/fit/intervals.h"
#include "science/fit/valley.h"

namespace palpate::fit {
namespace {

Point profile_point(const Solution& solution) {
  Point point = solution.shared;
  point.insert(point.end(), solution.own.front().begin(), solution.own.front().end());
  return point;
}

}  // namespace

std::vector<Point> profile_points(const Minima& minima, double effective,
                                  const std::function<void(double)>& progress) {
  const Problem& problem = minima.problem;
  const double best = log_posterior_of(problem, profile_point(minima.all.front()), effective);
  const double t = student(effective - static_cast<double>(problem.bounds.low.size() + kOwnParameters));
  const double floor = best - 0.5 * t * t;
  const std::size_t relaxation = problem.bounds.low.size();  // which is not walked
  std::vector<Point> points;
  for (std::size_t m = 0; m < minima.all.size(); ++m) {
    const Solution& minimum = minima.all[m];
    if (progress) progress(static_cast<double>(m) / static_cast<double>(minima.all.size()));
    if (!(log_posterior_of(problem, profile_point(minimum), effective) >= floor)) continue;
    points.push_back(profile_point(minimum));
    for (std::size_t i = 0; i < relaxation + kOwnParameters; ++i) {
      if (i >= kLawParameters && i < relaxation) continue;
      for (const double direction : {-1.0, 1.0}) {
        walk_valley(
            problem, minimum, i, direction,
            [&](const Solution& at) {
              return log_posterior_of(problem, profile_point(at), effective) >= floor;
            },
            [&](const Solution& at) { points.push_back(profile_point(at)); });
      }
    }
  }
  return points;
}

}  // namespace palpate::fit
