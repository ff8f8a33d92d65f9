#include "core/base/portable_math.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/base/infinity.h"

namespace palpate {
namespace {

// |got - want| in units in the last place of the double nearest to `want`.
double ulps(double got, long double want) {
  const auto nearest = static_cast<double>(want);
  if (std::isinf(nearest)) return got == nearest ? 0.0 : kInfinity;
  const double magnitude = std::fabs(nearest);
  const double unit = std::nextafter(magnitude, kInfinity) - magnitude;
  return static_cast<double>(std::fabs(static_cast<long double>(got) - want) /
                             static_cast<long double>(unit));
}

// Stated error of every function but cos_of_turns, in units in the last place.
constexpr double kPromise = 2.0;
constexpr int kSamples = 200'000;

TEST(PortableMath, ExpIsWithinTwoUnitsOfLongDouble) {
  std::mt19937_64 random(1);
  double worst = 0.0;
  for (const double span : {1e-6, 0.3, 2.0, 40.0, 700.0}) {
    std::uniform_real_distribution<double> argument(-span, span);
    for (int i = 0; i < kSamples; ++i) {
      const double x = argument(random);
      worst = std::max(worst, ulps(portable::exp(x), std::exp(static_cast<long double>(x))));
    }
  }
  EXPECT_LE(worst, kPromise);
}

TEST(PortableMath, ExpIsRightAtItsEdges) {
  EXPECT_EQ(portable::exp(0.0), 1.0);
  EXPECT_EQ(portable::exp(-0.0), 1.0);
  EXPECT_EQ(portable::exp(kInfinity), kInfinity);
  EXPECT_EQ(portable::exp(-kInfinity), 0.0);
  EXPECT_EQ(portable::exp(709.79), kInfinity);
  EXPECT_TRUE(std::isfinite(portable::exp(709.78)));
  EXPECT_EQ(portable::exp(-745.2), 0.0);
  EXPECT_EQ(portable::exp(-745.1), std::numeric_limits<double>::denorm_min());
  EXPECT_TRUE(std::isnan(portable::exp(kNaN)));
  for (const double x : {709.7827, -708.3, -708.4, -720.5, -744.0, 5e-324, 1e-17}) {
    EXPECT_LE(ulps(portable::exp(x), std::exp(static_cast<long double>(x))), kPromise) << x;
  }
}

TEST(PortableMath, Expm1IsWithinTwoUnitsOfLongDouble) {
  std::mt19937_64 random(5);
  double worst = 0.0;
  for (const double span : {1e-12, 1e-3, 0.4, 2.0, 37.0, 45.0, 700.0}) {
    std::uniform_real_distribution<double> argument(-span, span);
    for (int i = 0; i < kSamples; ++i) {
      const double x = argument(random);
      worst = std::max(worst, ulps(portable::expm1(x), std::expm1(static_cast<long double>(x))));
    }
  }
  EXPECT_LE(worst, kPromise);
}

TEST(PortableMath, Log1pIsWithinThreeUnitsOfLongDouble) {
  std::mt19937_64 random(6);
  double worst = 0.0;
  for (const double span : {1e-18, 1e-12, 1e-3, 0.4, 0.999}) {
    std::uniform_real_distribution<double> argument(-span, span);
    for (int i = 0; i < kSamples; ++i) {
      const double x = argument(random);
      worst = std::max(worst, ulps(portable::log1p(x), std::log1p(static_cast<long double>(x))));
    }
  }
  for (double x = 1e-3; x < 1e300; x *= 1.7) {
    worst = std::max(worst, ulps(portable::log1p(x), std::log1p(static_cast<long double>(x))));
  }
  EXPECT_LE(worst, 3.0);
}

TEST(PortableMath, Expm1AndLog1pAreRightAtTheirEdges) {
  EXPECT_EQ(portable::expm1(0.0), 0.0);
  EXPECT_EQ(portable::expm1(kInfinity), kInfinity);
  EXPECT_EQ(portable::expm1(-kInfinity), -1.0);
  EXPECT_TRUE(std::isnan(portable::expm1(kNaN)));
  EXPECT_EQ(portable::log1p(0.0), 0.0);
  EXPECT_EQ(portable::log1p(-1.0), -kInfinity);
  EXPECT_EQ(portable::log1p(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(portable::log1p(-1.5)));
  EXPECT_TRUE(std::isnan(portable::log1p(kNaN)));
}

TEST(PortableMath, LogIsWithinTwoUnitsOfLongDouble) {
  std::mt19937_64 random(2);
  double worst = 0.0;
  for (int i = 0; i < 3 * kSamples; ++i) {  // all positive doubles, subnormal ones included
    const double x = std::bit_cast<double>(random() % 0x7ff0'0000'0000'0000ULL);
    if (x > 0.0) worst = std::max(worst, ulps(portable::log(x), std::log(static_cast<long double>(x))));
  }
  for (const double span : {1e-12, 1e-6, 1e-2, 0.3}) {  // around 1, where the logarithm is small
    std::uniform_real_distribution<double> argument(1.0 - span, 1.0 + span);
    for (int i = 0; i < kSamples; ++i) {
      const double x = argument(random);
      worst = std::max(worst, ulps(portable::log(x), std::log(static_cast<long double>(x))));
    }
  }
  EXPECT_LE(worst, kPromise);
}

TEST(PortableMath, LogIsRightAtItsEdges) {
  EXPECT_EQ(portable::log(1.0), 0.0);
  EXPECT_EQ(portable::log(0.0), -kInfinity);
  EXPECT_EQ(portable::log(-0.0), -kInfinity);
  EXPECT_EQ(portable::log(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(portable::log(-1.0)));
  EXPECT_TRUE(std::isnan(portable::log(kNaN)));
  for (const double x : {5e-324, 2.2250738585072009e-308, 2.2250738585072014e-308, 1.7976931348623157e308,
                         0.70710678118654746, 0.70710678118654757, 0.99999999999999989, 1.0000000000000002}) {
    EXPECT_LE(ulps(portable::log(x), std::log(static_cast<long double>(x))), kPromise) << x;
  }
}

TEST(PortableMath, SineAndCosineAreWithinTwoUnitsOfLongDouble) {
  std::mt19937_64 random(3);
  double worst = 0.0;
  for (const double span : {1e-9, 0.8, 7.0, 1e3, 1e5}) {
    std::uniform_real_distribution<double> argument(-span, span);
    for (int i = 0; i < kSamples; ++i) {
      const double x = argument(random);
      const auto [sine, cosine] = portable::sin_cos(x);
      worst = std::max(worst, ulps(sine, std::sin(static_cast<long double>(x))));
      worst = std::max(worst, ulps(cosine, std::cos(static_cast<long double>(x))));
    }
  }
  EXPECT_LE(worst, kPromise);
}

TEST(PortableMath, SineAndCosineHoldBesideTheirZeros) {
  // The double nearest to n pi/2 is within 1e-11 of a zero: all leading digits cancel.
  double worst = 0.0;
  for (int n = 1; n <= 63'000; ++n) {
    const double x = n * (portable::kPi / 2);
    const auto [sine, cosine] = portable::sin_cos(x);
    worst = std::max(worst, ulps(sine, std::sin(static_cast<long double>(x))));
    worst = std::max(worst, ulps(cosine, std::cos(static_cast<long double>(x))));
  }
  EXPECT_LE(worst, kPromise);
}

TEST(PortableMath, SineAndCosineAreRightAtTheirEdges) {
  EXPECT_EQ(portable::sin_cos(0.0).sine, 0.0);
  EXPECT_EQ(portable::sin_cos(0.0).cosine, 1.0);
  EXPECT_EQ(portable::sin_cos(5e-324).sine, 5e-324);
  for (const double x : {kNaN, kInfinity, -kInfinity, 1e300}) {
    EXPECT_TRUE(std::isnan(portable::sin_cos(x).sine)) << x;
    EXPECT_TRUE(std::isnan(portable::sin_cos(x).cosine)) << x;
  }
}

TEST(PortableMath, CosineOfTurnsIsWithinThreeUnitsOfLongDouble) {
  std::mt19937_64 random(6);
  const long double pi = std::acos(-1.0L);
  double worst = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double turns = static_cast<double>(random() >> 11) * 0x1p-53;
    // The reference is a sine of the exact distance from the nearer zero, at 1/4 or 3/4, so that it loses no
    // digits.
    const long double left = static_cast<long double>(turns) - (turns < 0.5 ? 0.25L : 0.75L);
    const long double want = std::sin((turns < 0.5 ? -2.0L : 2.0L) * pi * left);
    worst = std::max(worst, ulps(portable::cos_of_turns(turns), want));
  }
  EXPECT_LE(worst, 3.0);
}

TEST(PortableMath, CosineOfTurnsIsRightAtItsEdges) {
  EXPECT_EQ(portable::cos_of_turns(0.0), 1.0);
  EXPECT_EQ(portable::cos_of_turns(0.25), 0.0);
  EXPECT_EQ(portable::cos_of_turns(0.5), -1.0);
  EXPECT_EQ(portable::cos_of_turns(0.75), 0.0);
  EXPECT_EQ(portable::cos_of_turns(1.0), 1.0);
  EXPECT_NEAR(portable::cos_of_turns(0.125), std::sqrt(0.5), 1e-15);
  for (const double turns : {0.1, 0.3, 0.6, 0.9}) {
    for (const double whole : {1.0, -3.0, 1000.0}) {
      EXPECT_NEAR(portable::cos_of_turns(whole + turns), portable::cos_of_turns(turns), 1e-11);
      EXPECT_NEAR(portable::cos_of_turns(-turns), portable::cos_of_turns(turns), 1e-15);
    }
  }
  for (const double bad : {kNaN, kInfinity, -1e300}) EXPECT_TRUE(std::isnan(portable::cos_of_turns(bad)));
}

TEST(PortableMath, AcosIsWithinTwoUnitsOfLongDouble) {
  std::mt19937_64 random(4);
  double worst = 0.0;
  std::uniform_real_distribution<double> argument(-1.0, 1.0);
  for (int i = 0; i < 5 * kSamples; ++i) {
    const double x = argument(random);
    worst = std::max(worst, ulps(portable::acos(x), std::acos(static_cast<long double>(x))));
  }
  for (const double span : {1e-15, 1e-9, 1e-3}) {  // near both ends, where the slope is unbounded
    std::uniform_real_distribution<double> gap(0.0, span);
    for (int i = 0; i < kSamples; ++i) {
      const double x = 1.0 - gap(random);
      worst = std::max(worst, ulps(portable::acos(x), std::acos(static_cast<long double>(x))));
      worst = std::max(worst, ulps(portable::acos(-x), std::acos(static_cast<long double>(-x))));
    }
  }
  EXPECT_LE(worst, kPromise);
}

TEST(PortableMath, AcosClampsItsArgument) {
  EXPECT_EQ(portable::acos(1.0), 0.0);
  EXPECT_EQ(portable::acos(1.0000001), 0.0);
  EXPECT_EQ(portable::acos(-1.0), portable::kPi);
  EXPECT_EQ(portable::acos(-7.0), portable::kPi);
  EXPECT_EQ(portable::acos(0.0), portable::kPi / 2);
  EXPECT_TRUE(std::isnan(portable::acos(kNaN)));
  for (const double x : {0.5, -0.5, 0.50000000000000011, -0.50000000000000011, 1e-300}) {
    EXPECT_LE(ulps(portable::acos(x), std::acos(static_cast<long double>(x))), kPromise) << x;
  }
}

// One hash over the bits of many results. The constant makes it equal for every compiler and optimization
// level.
TEST(PortableMath, ResultsAreTheSameBitsInEveryBuild) {
  std::mt19937_64 random(5);
  std::uint64_t hash = 0xcbf2'9ce4'8422'2325ULL;  // FNV-1a
  const auto mix = [&hash](double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x0000'0100'0000'01b3ULL;
  };
  for (int i = 0; i < 20'000; ++i) {
    const double u = static_cast<double>(random() >> 11) * 0x1p-53;  // [0, 1), no library distribution
    mix(portable::exp(1400.0 * u - 700.0));
    mix(portable::log(u + 0x1p-60));
    mix(portable::acos(2.0 * u - 1.0));
    const auto [sine, cosine] = portable::sin_cos(2e5 * u - 1e5);
    mix(sine);
    mix(cosine);
    mix(portable::cos_of_turns(u));
  }
  EXPECT_EQ(hash, 8643489481486671040ULL);
}

}  // namespace
}  // namespace palpate
