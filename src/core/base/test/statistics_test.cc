#include "core/base/statistics.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Quantile, IsTheSmallestValueThatTheShareDoesNotExceed) {
  const std::vector<double> five = {16.0, 1.0, 8.0, 4.0, 2.0};
  EXPECT_EQ(quantile(five, 0.0), 1.0);
  EXPECT_EQ(quantile(five, 0.2), 1.0);   // exactly one fifth
  EXPECT_EQ(quantile(five, 0.21), 2.0);  // more than one fifth
  EXPECT_EQ(quantile(five, 0.5), 4.0);
  EXPECT_EQ(quantile(five, 0.99), 16.0);
  EXPECT_EQ(quantile(five, 1.0), 16.0);
  EXPECT_EQ(quantile({}, 0.5), 0.0);
}

TEST(Median, OfAnEvenNumberIsTheMeanOfTheTwoMiddleOnes) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_EQ(median({}), 0.0);
}

TEST(NormalizedMad, EstimatesTheStandardDeviationOfNormalResidualsWithOutliers) {
  EXPECT_DOUBLE_EQ(normalized_mad({-1.0, 2.0, -4.0, 1e6}), 3.0 * 1.4826);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, 3.0);
  std::vector<double> residuals(100'000);
  for (double& residual : residuals) residual = normal(random);
  EXPECT_NEAR(normalized_mad(residuals), 3.0, 0.03);
  EXPECT_NEAR(standard_deviation(residuals), 3.0, 0.03);
  for (std::size_t i = 0; i < residuals.size(); i += 100) residuals[i] = 1e6;
  EXPECT_NEAR(normalized_mad(residuals), 3.0, 0.1);
}

TEST(StandardDeviation, DividesByOneLessThanTheNumber) {
  const std::vector<double> two = {1.0, -1.0};
  EXPECT_DOUBLE_EQ(mean(two), 0.0);
  EXPECT_DOUBLE_EQ(standard_deviation(two), std::sqrt(2.0));
  EXPECT_EQ(standard_deviation(std::vector<double>{5.0}), 0.0);
  EXPECT_EQ(mean({}), 0.0);
}

TEST(Correlation, IsOneOnALineAndZeroOfAConstant) {
  const std::vector<double> x = {1.0, 2.0, 4.0};
  const std::vector<double> rising = {3.0, 5.0, 9.0};
  const std::vector<double> falling = {-3.0, -5.0, -9.0};
  const std::vector<double> constant = {2.0, 2.0, 2.0};
  EXPECT_DOUBLE_EQ(correlation(x, rising), 1.0);
  EXPECT_DOUBLE_EQ(correlation(x, falling), -1.0);
  EXPECT_EQ(correlation(x, constant), 0.0);
}

TEST(EffectiveSampleSize, OfAnAutoregressiveSeriesIsThatOfItsCoefficient) {
  constexpr double kCoefficient = 0.8;
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  std::vector<double> series = {0.0};
  while (series.size() < 200'000) series.push_back(kCoefficient * series.back() + normal(random));
  const double wanted = 200'000 * (1.0 - kCoefficient) / (1.0 + kCoefficient);
  EXPECT_NEAR(effective_sample_size(series), wanted, 0.03 * wanted);
}

TEST(EffectiveSampleSize, NeverExceedsTheNumberOfValues) {
  EXPECT_EQ(effective_sample_size(std::vector<double>{1.0, -1.0, 1.0, -1.0}), 4.0);
}

}  // namespace
}  // namespace palpate
