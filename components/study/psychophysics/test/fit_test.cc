#include "study/psychophysics/fit.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/error.h"

#include "study/psychophysics/nelder_mead.h"

namespace palpate::psychophysics {
namespace {

std::vector<Count> counts_of(const std::vector<int>& counted, int trials) {
  std::vector<Count> counts;
  for (const int one : counted) counts.push_back({trials, one});
  return counts;
}

// Ten levels from 0.25 to 1.75 with ten trials each, of psignifit's tests.
FunctionFit fit_ten(const std::vector<int>& counted, Sigmoid sigmoid, int intervals) {
  std::vector<double> levels;
  for (int i = 0; i < 10; ++i) levels.push_back(0.25 + 1.5 * i / 9.0);
  return fit_function(levels, counts_of(counted, 10), sigmoid, intervals);
}

void expect_near_percent(const FunctionFit& fit, double threshold, double width) {
  EXPECT_NEAR(fit.threshold / threshold, 1.0, 0.01);
  EXPECT_NEAR(fit.width / width, 1.0, 0.01);
}

TEST(Fit, NormalFunctionOfTwoIntervalsAgreesWithPsignifit) {
  expect_near_percent(fit_ten({4, 6, 3, 8, 7, 5, 8, 9, 9, 10}, Sigmoid::kNormal, 2), 1.19233664, 1.13590185);
}

TEST(Fit, NormalFunctionOfYesNoAgreesWithPsignifit) {
  expect_near_percent(fit_ten({0, 2, 2, 3, 7, 7, 8, 8, 9, 10}, Sigmoid::kNormal, 0), 0.897273717, 1.43410261);
}

TEST(Fit, LogisticFunctionOfTwoIntervalsAgreesWithPsignifit) {
  expect_near_percent(fit_ten({5, 5, 5, 6, 5, 7, 9, 9, 8, 10}, Sigmoid::kLogistic, 2), 1.18954146,
                      1.34590649);
}

TEST(Fit, LogisticFunctionOfYesNoAgreesWithPsignifit) {
  expect_near_percent(fit_ten({1, 1, 4, 6, 5, 6, 7, 9, 7, 10}, Sigmoid::kLogistic, 0), 0.879924438,
                      2.05631136);
}

TEST(Fit, ManyTrialsAgreeWithPsignifit) {
  const std::vector<double> levels = {0.001,  0.0015, 0.002, 0.0025, 0.003, 0.0035, 0.004,
                                      0.0045, 0.005,  0.006, 0.007,  0.008, 0.01};
  const std::vector<int> counted = {45, 50, 44, 44, 52, 53, 62, 64, 76, 79, 88, 90, 90};
  expect_near_percent(fit_function(levels, counts_of(counted, 90), Sigmoid::kNormal, 2),
                      0.0046448472488663396, 0.004683837353547434);
}

TEST(Fit, FindsTheFunctionOfManyExactTrials) {
  const FunctionFit truth{1.0, 0.8, 0.03, 0.5, 0.0};
  std::vector<double> levels;
  std::vector<Count> counts;
  for (int i = 0; i <= 20; ++i) {
    levels.push_back(0.1 * i);
    const int trials = 1000000;
    counts.push_back({trials, static_cast<int>(trials * truth.correct(levels.back(), Sigmoid::kNormal))});
  }
  const FunctionFit found = fit_function(levels, counts, Sigmoid::kNormal, 2);
  EXPECT_NEAR(found.threshold, truth.threshold, 1e-3);
  EXPECT_NEAR(found.width, truth.width, 1e-3);
  EXPECT_NEAR(found.lapse, truth.lapse, 1e-3);
}

TEST(Fit, InvalidDataAreRejected) {
  const std::vector<Count> counts(2, Count{10, 5});
  EXPECT_THROW((void)fit_function(std::vector<double>{1.0, 1.0}, counts, Sigmoid::kNormal, 2),
               ParameterError);
  EXPECT_THROW((void)fit_function(std::vector<double>{1.0}, counts, Sigmoid::kNormal, 2), ParameterError);
}

TEST(Fit, SimplexFindsTheMinimumOfRosenbrocksFunction) {
  const auto cost = [](const std::vector<double>& x) {
    return 100.0 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1.0 - x[0], 2);
  };
  const Minimum found = minimize(cost, {-1.2, 1.0}, {0.1, 0.1}, 1e-14);
  EXPECT_NEAR(found.at[0], 1.0, 1e-4);
  EXPECT_NEAR(found.at[1], 1.0, 1e-4);
}

}  // namespace
}  // namespace palpate::psychophysics
