#include "palpate/touch_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::noise {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMillion = 1'000'000;

std::vector<double> unit_samples(std::uint64_t seed, std::uint32_t hand, std::size_t count) {
  std::vector<double> samples(count);
  for (std::size_t n = 0; n < count; ++n) samples[n] = unit_sample(seed, hand, n);
  return samples;
}

double mean_product(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < a.size(); ++i) sum += a[i] * b[i - lag];
  return sum / static_cast<double>(a.size() - lag);
}

// Forces of noise that is fully on, one per tick.
std::vector<double> forces(const TouchNoise& noise, std::uint32_t hand, std::size_t ticks, double distance) {
  TouchNoise::State state;
  std::vector<double> out(ticks);
  for (std::size_t tick = 0; tick < ticks; ++tick) out[tick] = noise.force(state, true, hand, tick, distance);
  return out;
}

TEST(UnitSample, MeanAndStandardDeviationAreThoseOfTheNormal) {
  for (const std::uint64_t seed : {1u, 2u, 99u}) {
    const std::vector<double> x = unit_samples(seed, 0, kMillion);
    double mean = 0.0;
    for (const double value : x) mean += value / static_cast<double>(kMillion);
    EXPECT_LT(std::fabs(mean), 4.0 / std::sqrt(static_cast<double>(kMillion)));  // standard errors
    EXPECT_NEAR(std::sqrt(mean_product(x, x, 0)), 1.0, 0.005);
  }
}

TEST(UnitSample, PassesKolmogorovSmirnovAgainstTheNormal) {
  std::vector<double> x = unit_samples(1, 0, kMillion);
  std::sort(x.begin(), x.end());
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double normal = 0.5 * std::erfc(-x[i] / std::numbers::sqrt2);
    const double below = static_cast<double>(i) / static_cast<double>(kMillion);
    largest = std::max({largest, std::fabs(normal - below),
                        std::fabs(normal - below - 1.0 / static_cast<double>(kMillion))});
  }
  constexpr double kCritical = 1.63;  // at the 1 % level
  EXPECT_LT(largest, kCritical / std::sqrt(static_cast<double>(kMillion)));
}

// The paper's 15-bit numbers end at 4.56 sigma and repeat after 32,768 squared pairs.
TEST(UnitSample, TailIsNotCutAndSamplesDoNotRepeat) {
  std::vector<double> x = unit_samples(1, 0, 4 * kMillion);
  const auto beyond = std::count_if(x.begin(), x.end(), [](double value) { return std::fabs(value) > 4.56; });
  EXPECT_GT(beyond, 5);  // 4e6 x 5.1e-6 = 20 expected
  EXPECT_LT(beyond, 45);
  std::sort(x.begin(), x.end());
  EXPECT_EQ(std::adjacent_find(x.begin(), x.end()), x.end());
}

TEST(UnitSample, HasAFlatSpectrum) {
  constexpr std::size_t kSegment = 64;
  constexpr std::size_t kSegments = kMillion / kSegment;
  std::array<double, kSegment> cosine{};
  std::array<double, kSegment> sine{};
  for (std::size_t i = 0; i < kSegment; ++i) {
    cosine[i] = std::cos(2 * std::numbers::pi * static_cast<double>(i) / kSegment);
    sine[i] = std::sin(2 * std::numbers::pi * static_cast<double>(i) / kSegment);
  }
  const std::vector<double> x = unit_samples(1, 0, kMillion);
  for (std::size_t bin = 1; bin < kSegment / 2; ++bin) {
    double power = 0.0;
    for (std::size_t segment = 0; segment < kSegments; ++segment) {
      double real = 0.0;
      double imaginary = 0.0;
      for (std::size_t i = 0; i < kSegment; ++i) {
        real += x[segment * kSegment + i] * cosine[bin * i % kSegment];
        imaginary += x[segment * kSegment + i] * sine[bin * i % kSegment];
      }
      power += (real * real + imaginary * imaginary) / (kSegment * static_cast<double>(kSegments));
    }
    // The power of one segment has an exponential distribution, so its mean has this standard error.
    EXPECT_NEAR(power, 1.0, 4.0 / std::sqrt(static_cast<double>(kSegments))) << bin;
  }
}

TEST(UnitSample, HasNoCorrelationAtLagsOneToOneHundred) {
  const std::vector<double> x = unit_samples(1, 0, kMillion);
  for (std::size_t lag = 1; lag <= 100; ++lag) {
    EXPECT_LT(std::fabs(mean_product(x, x, lag)), 4.0 / std::sqrt(static_cast<double>(kMillion))) << lag;
  }
}

TEST(UnitSample, HandsAndSeedsAreIndependent) {
  const std::vector<double> x = unit_samples(1, 0, kMillion);
  const double bound = 4.0 / std::sqrt(static_cast<double>(kMillion));
  for (const auto& other : {unit_samples(1, 1, kMillion), unit_samples(2, 0, kMillion)}) {
    for (const std::size_t lag : {0u, 1u, 2u, 3u}) {
      EXPECT_LT(std::fabs(mean_product(x, other, lag)), bound);
      EXPECT_LT(std::fabs(mean_product(other, x, lag)), bound);
    }
  }
}

TEST(UnitSample, EveryBitOfSeedHandAndNumberCounts) {
  std::set<double> seen{unit_sample(0, 0, 0)};
  for (unsigned bit = 0; bit < 64; ++bit) {
    EXPECT_TRUE(seen.insert(unit_sample(std::uint64_t{1} << bit, 0, 0)).second) << "seed " << bit;
    EXPECT_TRUE(seen.insert(unit_sample(0, 0, std::uint64_t{1} << bit)).second) << "number " << bit;
    if (bit < 32) {
      EXPECT_TRUE(seen.insert(unit_sample(0, std::uint32_t{1} << bit, 0)).second) << "hand " << bit;
    }
  }
}

// Philox 4x32-10 at counter 0, key 0 is 6627e8d5 e169c58d bc57ac4c 9b00dbd8. So u1 = 0x6627e8d5e169c58d /
// 2^64 and u2 = 0xbc57ac4c9b00dbd8 / 2^64. The expected number is computed from these with the C library.
TEST(UnitSample, IsBoxMullerOfTheKnownPhiloxWords) {
  const double u1 =
      std::ldexp(static_cast<double>(0x6627e8d5), -32) + std::ldexp(static_cast<double>(0xe169c58d), -64);
  const double u2 =
      std::ldexp(static_cast<double>(0xbc57ac4c), -32) + std::ldexp(static_cast<double>(0x9b00dbd8), -64);
  const double want = std::sqrt(-2.0 * std::log(1.0 - u1)) * std::cos(2.0 * std::numbers::pi * u2);
  EXPECT_NEAR(unit_sample(0, 0, 0), want, 1e-14);
}

TEST(TouchNoise, SigmaFollowsTheDistanceAndHoldsInContact) {
  const TouchNoise noise({true, 5e-5, 5e-3, 1000.0, 1}, 1000.0);
  EXPECT_DOUBLE_EQ(noise.sigma(0.0), 10e-3);  // by hand: 5e-5 / 5e-3
  EXPECT_DOUBLE_EQ(noise.sigma(-2e-3), 10e-3);
  EXPECT_DOUBLE_EQ(noise.sigma(5e-3), 5e-3);
  EXPECT_DOUBLE_EQ(noise.sigma(45e-3), 1e-3);
  EXPECT_EQ(noise.sigma(kInfinity), 0.0);
}

TEST(TouchNoise, ForceHasTheStandardDeviationOfItsDistance) {
  const TouchNoise noise({true, 5e-5, 5e-3, 1000.0, 1}, 1000.0);
  for (const double distance : {0.0, 3e-3}) {
    const std::vector<double> force = forces(noise, 0, kMillion, distance);
    const double want = 5e-5 / (distance + 5e-3);
    EXPECT_NEAR(std::sqrt(mean_product(force, force, 0)), want, 0.005 * want);
  }
}

TEST(TouchNoise, HoldsFourEqualTicksAtFourKilohertz) {
  const NoiseSettings settings{true, 5e-5, 5e-3, 1000.0, 1};
  const std::vector<double> slow = forces(TouchNoise(settings, 1000.0), 0, 1000, 3e-3);
  const std::vector<double> fast = forces(TouchNoise(settings, 4000.0), 0, 4000, 3e-3);
  for (std::size_t tick = 0; tick < fast.size(); ++tick) ASSERT_EQ(fast[tick], slow[tick / 4]) << tick;
  EXPECT_NE(slow[0], slow[1]);
}

TEST(TouchNoise, SampleNumberIsTheFloorOfTheExactRatio) {
  const NoiseSettings settings{true, 5e-5, 5e-3, 300.0, 1};
  const TouchNoise noise(settings, 1000.0);
  for (std::uint64_t tick = 0; tick < 10'000; ++tick) ASSERT_EQ(noise.sample_number(tick), tick * 3 / 10);
  EXPECT_EQ(noise.sample_number(10'000'000'000'000'000'000u), 3'000'000'000'000'000'000u);  // no overflow
  const TouchNoise odd({true, 5e-5, 5e-3, 999.5, 1}, 1000.25);
  EXPECT_EQ(odd.sample_number(1'000'250), 999'500u);
  EXPECT_EQ(odd.sample_number(1'000'249), 999'499u);
}

TEST(TouchNoise, IsBoundedAtSixSigma) {
  // One sample in 5e8 is beyond 6 sigma; this is the first one of seed 1, found by search.
  constexpr std::uint64_t kBeyond = 195'688'102;
  ASSERT_GT(unit_sample(1, 0, kBeyond), 6.0);
  TouchNoise::State state;
  const TouchNoise noise({true, 5e-5, 5e-3, 1000.0, 1}, 1000.0);
  EXPECT_EQ(noise.force(state, true, 0, kBeyond, 0.0), 6.0 * noise.sigma(0.0));
  for (const double force : forces(noise, 0, kMillion, 0.0)) ASSERT_LE(std::fabs(force), 6.0 * 10e-3);
}

TEST(TouchNoise, StartsAtItsFullLevelOrAtNone) {
  const TouchNoise noise({true, 5e-5, 5e-3, 1000.0, 1}, 1000.0);
  TouchNoise::State on;
  EXPECT_EQ(noise.force(on, true, 0, 0, 0.0), noise.sigma(0.0) * unit_sample(1, 0, 0));
  EXPECT_EQ(on.level, 1.0);
  TouchNoise::State off;
  for (std::uint64_t tick = 0; tick < 1000; ++tick) ASSERT_EQ(noise.force(off, false, 0, tick, 0.0), 0.0);
}

TEST(TouchNoise, FadesOverFiftyMillisecondsWhenSwitched) {
  for (const double rate : {1000.0, 4000.0, 1230.0}) {
    const TouchNoise noise({true, 5e-5, 5e-3, 1000.0, 1}, rate);
    TouchNoise::State state;
    static_cast<void>(noise.force(state, true, 0, 0, 0.0));
    const int fade = static_cast<int>(std::lround(0.05 * rate));
    for (int i = 1; i <= fade; ++i) {
      const double force = noise.force(state, false, 0, static_cast<std::uint64_t>(i), 0.0);
      const double want = i == fade ? 0.0 : 1.0 - i / (0.05 * rate);
      EXPECT_NEAR(state.level, want, 1e-12) << rate << ' ' << i;
      EXPECT_EQ(force, state.level * noise.sigma(0.0) *
                           unit_sample(1, 0, noise.sample_number(static_cast<std::uint64_t>(i))));
    }
    EXPECT_EQ(state.level, 0.0);
    for (int i = 1; i <= fade; ++i) static_cast<void>(noise.force(state, true, 0, 0, 0.0));
    EXPECT_EQ(state.level, 1.0);
  }
}

TEST(TouchNoise, ZeroGainIsSilent) {
  const TouchNoise noise({true, 0.0, 5e-3, 1000.0, 1}, 1000.0);
  for (const double force : forces(noise, 0, 100, 0.0)) EXPECT_EQ(force, 0.0);
}

void expect_refused(const NoiseSettings& settings, double loop_rate, const std::string& field) {
  try {
    static_cast<void>(TouchNoise(settings, loop_rate));
    ADD_FAILURE() << "accepted a bad " << field;
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.field(), field);
  }
}

TEST(TouchNoise, RefusesBadSettings) {
  const NoiseSettings good;
  for (const double bad : {-1e-9, kInfinity, kNaN}) {
    NoiseSettings settings = good;
    settings.gain = bad;
    expect_refused(settings, 1000.0, "gain_N_m");
  }
  for (const double bad : {0.0, -1e-3, kInfinity, kNaN}) {
    NoiseSettings settings = good;
    settings.threshold = bad;
    expect_refused(settings, 1000.0, "threshold_mm");
    settings = good;
    settings.rate_Hz = bad;
    expect_refused(settings, 1000.0, "rate_Hz");
    expect_refused(good, bad, "rate_Hz");
  }
  NoiseSettings settings = good;
  settings.rate_Hz = 1000.5;  // above the loop rate
  expect_refused(settings, 1000.0, "rate_Hz");
  settings = good;
  settings.gain = 1e300;
  settings.threshold = 1e-300;
  expect_refused(settings, 1000.0, "gain_N_m");
}

TEST(TouchNoise, SigmaInContactHasACeiling) {
  NoiseSettings settings;
  settings.gain = kMaxSigma * settings.threshold;
  EXPECT_NO_THROW(validate(settings, 1000.0));
  EXPECT_THROW(validate(settings, 1000.0, 0.4), ParameterError) << "a device's own ceiling may be lower";
  settings.gain *= 1.001;
  expect_refused(settings, 1000.0, "gain_N_m");
}

TEST(GainFromThreshold, PutsSigmaInContactAtTheShareOfTheThreshold) {
  NoiseSettings settings;
  settings.threshold = 4e-3;
  settings.gain = gain_from_threshold(0.02, 0.6, settings.threshold);
  EXPECT_DOUBLE_EQ(TouchNoise(settings, 1000.0).sigma(0.0), 0.012);
}

TEST(GainFromThreshold, RefusesBadValuesByName) {
  const auto field_of = [](double user, double share, double distance) {
    try {
      static_cast<void>(gain_from_threshold(user, share, distance));
    } catch (const ParameterError& error) {
      return error.field();
    }
    return std::string("accepted");
  };
  for (const double bad : {0.0, -1.0, kInfinity, kNaN}) {
    EXPECT_EQ(field_of(bad, 0.6, 5e-3), "user_threshold_N");
    EXPECT_EQ(field_of(0.02, 0.6, bad), "threshold_mm");
  }
  for (const double bad : {-0.1, 1.01, kInfinity, kNaN})
    EXPECT_EQ(field_of(0.02, bad, 5e-3), "share_of_threshold");
  EXPECT_EQ(field_of(0.02, 0.0, 5e-3), "accepted");
  EXPECT_EQ(field_of(0.02, 1.0, 5e-3), "accepted");
}

}  // namespace
}  // namespace palpate::noise
