#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/error.h"
#include "view/report/analysis.h"

namespace palpate::report {
namespace {

TEST(Percentiles, AreTheSmallestValuesThatCoverTheShare) {
  std::vector<std::int64_t> values;
  for (std::int64_t i = 2000; i >= 1; --i) values.push_back(i);
  const Percentiles result = percentiles(values);
  EXPECT_EQ(result.count, 2000U);
  EXPECT_EQ(result.p50, 1000);
  EXPECT_EQ(result.p99, 1980);
  EXPECT_EQ(result.p999, 1998);
  EXPECT_EQ(result.max, 2000);
}

TEST(Percentiles, OfNothingAreZero) {
  const Percentiles result = percentiles({});
  EXPECT_EQ(result.count, 0U);
  EXPECT_EQ(result.max, 0);
}

TEST(Percentiles, OfOneValueAreThatValue) {
  const Percentiles result = percentiles({42});
  EXPECT_EQ(result.p50, 42);
  EXPECT_EQ(result.p999, 42);
}

TEST(Bins, CountEveryValueOnceAndTheUpperEdgeToo) {
  const std::vector<double> values{-1.0, -0.5, 0.0, 0.49, 0.5, 1.0, 1.1, std::nan("")};
  const Bins bins = bin_linear(values, -1.0, 1.0, 4);
  EXPECT_EQ(bins.counts, (std::vector<std::size_t>{1, 1, 2, 2}));
}

TEST(Bins, RefuseAnEmptyRange) {
  EXPECT_THROW(static_cast<void>(bin_linear({}, 1.0, 1.0, 4)), InputError);
  EXPECT_THROW(static_cast<void>(bin_linear({}, 0.0, 1.0, 0)), InputError);
  EXPECT_THROW(static_cast<void>(bin_logarithmic({}, 0)), InputError);
}

TEST(Bins, LogarithmicBinsGoFromDecadeToDecade) {
  const std::vector<double> values{0.0, -3.0, 2.0, 5.0, 50.0, 99.0};
  const Bins bins = bin_logarithmic(values, 2);
  ASSERT_EQ(bins.counts.size(), 4U);
  EXPECT_DOUBLE_EQ(bins.edges.front(), 1.0);
  EXPECT_NEAR(bins.edges[1], 3.1622776601683795, 1e-12);
  EXPECT_DOUBLE_EQ(bins.edges.back(), 100.0);
  EXPECT_EQ(bins.counts, (std::vector<std::size_t>{1, 1, 0, 2}));
}

TEST(Bins, AValueThatWasMetSeveralTimesCountsSoOften) {
  const std::vector<double> values{2.0, 5.0, 50.0};
  const std::vector<std::uint64_t> times{10, 1, 4};
  EXPECT_EQ(bin_logarithmic(values, 2, times).counts, (std::vector<std::size_t>{10, 1, 0, 4}));
  EXPECT_THROW(static_cast<void>(bin_logarithmic(values, 2, std::span(times).first(2))), InputError);
}

TEST(Bins, LogarithmicBinsOfNothingPositiveAreEmpty) {
  const std::vector<double> values{0.0, 0.0};
  EXPECT_TRUE(bin_logarithmic(values, 10).counts.empty());
}

TEST(Welch, WhiteSamplesHaveTwiceTheVarianceOverTheRate) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal(0.0, 3.0);
  std::vector<double> samples(1 << 17);
  for (double& sample : samples) sample = normal(random);
  const Spectrum spectrum = welch(samples, 500.0, 256);
  ASSERT_EQ(spectrum.density.size(), 129U);
  EXPECT_DOUBLE_EQ(spectrum.frequency.back(), 250.0);
  double mean = 0.0;
  for (std::size_t i = 1; i < 128; ++i) mean += spectrum.density[i] / 127.0;
  EXPECT_NEAR(mean, 2.0 * 9.0 / 500.0, 0.02 * 2.0 * 9.0 / 500.0);
}

TEST(Welch, PutsASineOfAmplitudeAIntoHalfItsSquare) {
  std::vector<double> samples(4096);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = 2.0 * std::sin(2.0 * std::numbers::pi * 125.0 * static_cast<double>(i) / 1000.0);
  }
  const Spectrum spectrum = welch(samples, 1000.0, 256);
  const auto peak = std::max_element(spectrum.density.begin(), spectrum.density.end());
  EXPECT_DOUBLE_EQ(spectrum.frequency[static_cast<std::size_t>(peak - spectrum.density.begin())], 125.0);
  double power = 0.0;
  for (const double density : spectrum.density) power += density * 1000.0 / 256.0;
  EXPECT_NEAR(power, 2.0, 1e-9);
}

TEST(Welch, OfTooFewSamplesIsEmpty) {
  const std::vector<double> samples(100);
  EXPECT_TRUE(welch(samples, 1000.0, 128).density.empty());
}

TEST(Welch, RefusesSegmentsThatAreNoPowerOfTwo) {
  const std::vector<double> samples(1000);
  EXPECT_THROW(static_cast<void>(welch(samples, 1000.0, 100)), InputError);
  EXPECT_THROW(static_cast<void>(welch(samples, 1000.0, 2)), InputError);
}

TEST(NormalCheck, TellsMeanDeviationAndDistanceOfAKnownSample) {
  const NormalCheck check = check_standard_normal({1.0, -1.0});
  EXPECT_EQ(check.count, 2U);
  EXPECT_DOUBLE_EQ(check.mean, 0.0);
  EXPECT_DOUBLE_EQ(check.standard_deviation, std::sqrt(2.0));
  // Phi(1) = 0.841344746; the empirical distribution function just below 1 is 1/2.
  EXPECT_NEAR(check.ks_distance, 0.341344746, 1e-9);
}

TEST(NormalCheck, ANormalSampleIsNearAndAUniformOneIsFar) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.7320508, 1.7320508);
  std::vector<double> good(20000);
  std::vector<double> bad(20000);
  for (double& value : good) value = normal(random);
  for (double& value : bad) value = uniform(random);
  const double bound = 1.95 / std::sqrt(20000.0);
  EXPECT_LT(check_standard_normal(good).ks_distance, bound);
  EXPECT_GT(check_standard_normal(bad).ks_distance, 3.0 * bound);
}

}  // namespace
}  // namespace palpate::report
