#include "fit/identify/profile_path.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "fit/identify/intervals.h"
#include "fit/identify/test/springs.h"

namespace palpate::identify {
namespace {

/// Change of the residuals of part `p` along `way`, and the Jacobian it is computed from.
std::vector<double> change_along(const Point& way, std::span<const double> derivatives, std::size_t shared,
                                 std::size_t p) {
  const std::size_t columns = shared + kOwnParameters;
  std::vector<double> change(derivatives.size() / columns, 0.0);
  for (std::size_t r = 0; r < change.size(); ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t at = c < shared ? c : c + kOwnParameters * p;
      change[r] += derivatives[r * columns + c] * way[at];
    }
  }
  return change;
}

// Least squares: the change along the tangent is orthogonal to the derivatives by all other parameters.
TEST(Tangent, LeavesNothingThatAnyOtherParameterCouldTakeUp) {
  const std::vector<Specimen> specimens = {springs({}, 1), springs({.first = 25.0}, 2),
                                           springs({.knot = 5e-3}, 3)};
  std::vector<Part> parts;
  for (const Specimen& specimen : specimens) parts.push_back(make_part(specimen));
  Settings settings;
  settings.law = model::LawKind::kSmooth;
  const Problem problem = make_problem(settings, 0, parts);
  const Solution at{{std::log(25.0), std::log(1.8), std::log(0.8), std::log(4e-3)},
                    {{0.01, 0.0}, {-0.02, 0.01}, {0.0, -0.01}}};
  const std::size_t shared = at.shared.size();
  for (std::size_t index = 0; index < shared + kOwnParameters; ++index) {
    const Point way = profile_tangent(problem, at, index);
    ASSERT_EQ(way.size(), shared + kOwnParameters * parts.size());
    EXPECT_EQ(way[index], 1.0);
    std::vector<double> along(way.size(), 0.0);
    double size = 0.0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const std::vector<double> derivatives = jacobian(problem, parts[p], at.shared, at.own[p]);
      const std::vector<double> change = change_along(way, derivatives, shared, p);
      for (std::size_t r = 0; r < change.size(); ++r) {
        size += change[r] * change[r];
        for (std::size_t c = 0; c < shared + kOwnParameters; ++c) {
          along[c < shared ? c : c + kOwnParameters * p] +=
              derivatives[r * (shared + kOwnParameters) + c] * change[r];
        }
      }
    }
    EXPECT_GT(size, 0.0) << index;
    for (std::size_t i = 0; i < along.size(); ++i) {
      EXPECT_NEAR(along[i], i == index ? size : 0.0, 1e-9) << index << ' ' << i;
    }
  }
}

// An interval comes from the values at a path's end, and the uncertainty of the force from the whole point.
// Paths bend: halfway between two solutions the cost can be 100 times theirs.
TEST(ProfilePoints, AllLieInTheConfidenceSet) {
  Settings settings;
  settings.law = model::LawKind::kSmooth;
  for (const std::uint32_t number : {0U, 3U}) {
    const Specimen specimen = springs(random_springs(number), number);
    const LocalOptima optima = find_local_optima(make_problem(settings, 0, {make_part(specimen)}));
    const double best = log_posterior_of(optima.problem, optima.all.front(), optima.effective);
    const double limit =
        likelihood_limit(optima.effective, optima.all.front().shared.size() + kOwnParameters);
    const std::vector<Point> points = profile_points(optima, optima.effective, {});
    EXPECT_GT(points.size(), 12U);
    for (const Point& point : points) {
      const Solution at = solution_at(optima.problem, point);
      const double worse = best - log_posterior_of(optima.problem, at, optima.effective);
      EXPECT_LE(worse, 0.5 * 1.1 * 1.1 * limit * limit) << number;
    }
  }
}

}  // namespace
}  // namespace palpate::identify
