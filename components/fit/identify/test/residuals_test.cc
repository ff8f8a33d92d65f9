#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <gmock/gmock.h>

#include "fit/identify/least_squares.h"
#include "fit/identify/test/springs.h"

namespace palpate::identify {
namespace {

/// A problem whose loss reduces most residuals, with unequal weights of the points.
Problem bent_problem(const Specimen& specimen) {
  Settings settings;
  settings.law = model::LawKind::kSmooth;
  Part part = make_part(specimen);
  for (std::size_t i = 0; i < part.weight.size(); ++i) part.weight[i] = static_cast<double>(i % 4);
  Problem problem = make_problem(settings, 0, {part});
  problem.loss_scale = 0.05;
  return problem;
}

/// Expects the derivatives of the residuals to be their differences.
void expect_differences(const Problem& problem, const Point& at) {
  const Part& part = problem.parts.front();
  const std::size_t shared = at.size() - kOwnParameters;
  const std::span<const double> all(at);
  const std::vector<double> derivatives = jacobian(problem, part, all.first(shared), all.subspan(shared));
  const std::size_t rows = residual_count(part);
  ASSERT_EQ(derivatives.size(), rows * at.size());
  constexpr double kStep = 1e-5;
  for (std::size_t c = 0; c < at.size(); ++c) {
    std::vector<double> above(rows);
    std::vector<double> below(rows);
    for (const double sign : {1.0, -1.0}) {
      Point moved = at;
      moved[c] += sign * kStep;
      const std::span<const double> there(moved);
      residuals(problem, part, there.first(shared), there.subspan(shared), sign > 0.0 ? above : below);
    }
    for (std::size_t r = 0; r < rows; ++r) {
      EXPECT_NEAR(derivatives[r * at.size() + c], (above[r] - below[r]) / (2.0 * kStep), 1e-6)
          << r << " " << c;
    }
  }
}

TEST(Residuals, TheirDerivativesAreTheirDifferences) {
  const Specimen specimen = springs({}, 1);
  expect_differences(bent_problem(specimen),
                     {std::log(30.0), std::log(1.5), std::log(0.7), std::log(5e-3), 0.01, 0.02});
}

TEST(Residuals, TheirDerivativesAreTheirDifferencesWithRelaxationOverUnequalSteps) {
  Specimen specimen = springs({}, 1);
  for (std::size_t i = 0; i < specimen.size(); ++i) {
    const auto n = static_cast<double>(i);
    specimen.time.push_back(0.01 * n + 1e-4 * n * n);
  }
  Problem problem = bent_problem(specimen);
  problem.terms = 2;
  expect_differences(problem, {std::log(30.0), std::log(1.5), std::log(0.7), std::log(5e-3), std::log(0.5),
                               std::log(1.5), std::log(0.3), std::log(0.1), 0.01, 0.02});
}

TEST(Residuals, TheSensorsZeroMovesThemAlikeAndALossThemLess) {
  const Specimen specimen = springs({.noise = 0.0}, 1);
  Problem problem = bent_problem(specimen);
  const Part& part = problem.parts.front();
  const Point shared = {std::log(30.0), std::log(1.5), std::log(0.7), std::log(5e-3)};
  const std::vector<double> with_loss = jacobian(problem, part, shared, Point{0.0, 0.0});
  problem.loss_scale = std::numeric_limits<double>::infinity();
  const std::vector<double> plain = jacobian(problem, part, shared, Point{0.0, 0.0});
  const std::size_t columns = shared.size() + kOwnParameters;
  const std::size_t offset = columns - 1;  // the sensor offset, as a fraction of the force range
  for (std::size_t r = 0; r < specimen.size(); ++r) {
    EXPECT_NEAR(plain[r * columns + offset], std::sqrt(part.weight[r]), 1e-9) << r;
    EXPECT_LE(std::abs(with_loss[r * columns + offset]), plain[r * columns + offset] + 1e-9) << r;
  }
}

}  // namespace
}  // namespace palpate::identify
