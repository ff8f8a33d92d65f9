#include "fit/identify/local_optima.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/identify.h"

#include "fit/identify/test/springs.h"

namespace palpate::identify {
namespace {

constexpr double kSame = 1e-12;

TEST(LocalOptima, ThoseOfTwoSpringsWithoutNoiseAreTheSprings) {
  struct Case {
    double first, second, knot, deepest;
  };
  const Case cases[] = {{30.0, 240.0, 3.8e-3, 14e-3},
                        {30.0, 150.0, 4e-3, 14e-3},
                        {20.0, 160.0, 3e-3, 12e-3},
                        {10.0, 80.0, 5e-3, 14e-3},
                        {25.0, 120.0, 6e-3, 9e-3}};
  for (const Case& c : cases) {
    const Specimen specimen = springs({c.first, c.second, c.knot, c.deepest, 0.0}, 0);
    const LocalOptima optima = find_local_optima(make_problem(Settings{}, 0, {make_part(specimen)}));
    const Point& best = optima.all.front().shared;
    const double step = std::exp(1.0 / std::exp(best[1])) * 4.0;  // k_2/k_1
    EXPECT_LT(std::sqrt(optima.all.front().cost), 1e-6) << c.first << ' ' << c.second;
    EXPECT_NEAR(std::exp(best[0]), c.first, 1e-3);
    EXPECT_NEAR(step, c.second / c.first, 1e-3);
    EXPECT_NEAR(std::exp(best[3]), c.knot, 1e-6);
  }
}

// The layers that generated the curve, with their offset fitted: the best law must not fit clearly worse.
TEST(LocalOptima, OfRandomSpringsAreNoWorseThanTheSprings) {
  for (std::uint32_t number = 0; number < 20; ++number) {
    const Springs of = random_springs(number);
    const Specimen specimen = springs(of, number);
    const LocalOptima optima = find_local_optima(make_problem(Settings{}, 0, {make_part(specimen)}));
    const Problem& problem = optima.problem;
    const double ratio = of.second / of.first / 4.0;
    const double beta = ratio > 1.06 ? 1.0 / std::log(ratio) : 18.0;
    const OwnPrior& prior = problem.parts.front().prior;
    Solution truth{{std::log(of.first), std::log(beta), std::log(2.9), std::log(of.knot)},
                   {{prior.first_contact, prior.offset}}};
    EXPECT_LT(optima.all.front().cost, 1.01 * solve(problem, truth, 200).cost) << number;
  }
}

TEST(LocalOptima, AreDescendedToFromBetterPlacesOnly) {
  const Specimen specimen = springs({20.0, 100.0, 4e-3, 8e-3, 2e-3}, 1);
  const LocalOptima found = find_local_optima(make_problem(Settings{}, 0, {make_part(specimen)}));
  ASSERT_GE(found.all.size(), 2U);
  LocalOptima optima = found;
  EXPECT_FALSE(try_more_starts(optima, {found.all.back()}));
  EXPECT_EQ(optima.all.front().shared, found.all.front().shared);
  optima.all = {found.all.back()};  // as if the search had missed the best optimum
  EXPECT_TRUE(try_more_starts(optima, {found.all.front()}));
  EXPECT_NEAR(optima.all.front().cost, found.all.front().cost, 1e-3 * found.all.front().cost);
}

// Two curves whose profiles find a better fit than the search, so that the fit is repeated from there.
TEST(FitSpecimen, ItsProgressNeverGoesBackAndGoesOnThroughTheProfiles) {
  for (const std::uint32_t number : {5U, 8U}) {
    double last = 0.0;
    const auto reported = [&last, number](double share, const auto&) {
      EXPECT_GE(share, last) << number;
      last = share;
    };
    (void)fit_specimen(springs(random_springs(number), number), Settings{}, 0, reported);
    EXPECT_GT(last, 0.8) << number;
  }
}

TEST(Starts, WithAParameterHeldHaveItsValueAndGrowWorse) {
  const Specimen specimen = springs({20.0, 100.0, 4e-3, 8e-3, 2e-3}, 1);
  const Problem problem = make_problem(Settings{}, 0, {make_part(specimen)});
  const double values[] = {std::log(18.0), std::log(3.0), std::log(0.85), std::log(3.9e-3)};
  for (std::size_t held = 0; held < kLawParameters; ++held) {
    const std::vector<Solution> all = multistart_points_at(problem, held, values[held], {}, 4);
    ASSERT_EQ(all.size(), 4U) << held;
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_NEAR(all[i].shared[held], values[held], kSame) << held;
      EXPECT_TRUE(i == 0 || all[i].cost >= all[i - 1].cost) << held;
    }
  }
}

// The best offset is the mean of measured minus computed force, as if 1/20 more points measured 0.
TEST(Starts, WithTheStiffnessHeldHaveTheOffsetOfLeastSquares) {
  const Specimen specimen = springs({20.0, 100.0, 4e-3, 8e-3, 2e-3}, 1);
  const Problem problem = make_problem(Settings{}, 0, {make_part(specimen)});
  const Solution start = multistart_points_at(problem, 0, std::log(30.0), {}, 1).front();
  const std::vector<double> left =
      plain_residuals(problem, problem.parts.front(), start.shared, start.own.front());
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : left) {
    sum += value;
    squares += value * value;
  }
  const double offset = start.own.front()[1] - problem.parts.front().prior.offset;
  const double held = 0.05 * static_cast<double>(left.size());
  EXPECT_NEAR(sum, -held * offset, 1e-9);
  EXPECT_NEAR(start.cost, squares + held * offset * offset, 1e-9);
}

}  // namespace
}  // namespace palpate::identify
