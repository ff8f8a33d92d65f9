#include "core/base/portable_math.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/charconv.h"
#include "core/base/infinity.h"

namespace palpate::portable {
namespace {

// Adding and subtracting 1.5 x 2^52 rounds to the nearest integer. In between, the low bits hold the integer.
constexpr double kRounder = 6755399441055744.0;

// ln 2 in two parts; the first has 32 bits, so that k times it is exact for every exponent k.
constexpr double kLn2High = 0x1.62e42feep-1;
constexpr double kLn2Low = 0x1.a39ef35793c76p-33;

// pi/2 in parts of 33, 33, 33 and 53 bits; n times each of the first three is exact for |n| < 2^20.
constexpr double kHalfPi1 = 0x1.921fb544p+0;
constexpr double kHalfPi2 = 0x1.0b4611a6p-34;
constexpr double kHalfPi3 = 0x1.3198a2ep-69;
constexpr double kHalfPi4 = 0x1.b839a252049c1p-104;

// pi/2 as the nearest double plus the remainder.
constexpr double kHalfPiHigh = 0x1.921fb54442d18p+0;
constexpr double kHalfPiLow = 0x1.1a62633145c07p-54;

// 2^k for -1022 <= k <= 1023.
double power_of_two(std::int64_t k) noexcept {
  return bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52);
}

// c[I] + c[I + 2] x^2 + c[I + 4] x^4 + ... by Horner's rule. Recursive, because compilers do not unroll a
// loop at -O2.
template <std::size_t I, std::size_t N>
double every_other(const double (&c)[N], double square) noexcept {
  if constexpr (I + 2 < N) {
    return every_other<I + 2>(c, square) * square + c[I];
  } else {
    return c[I];
  }
}

// sum c[i] x^i with even and odd powers separated: half the dependent operations of Horner's rule.
template <std::size_t N>
double polynomial(const double (&c)[N], double x) noexcept {
  const double square = x * x;
  return every_other<0>(c, square) + every_other<1>(c, square) * x;
}

// A value and its rounding error.
struct Reduced {
  double value;
  double rest;
  std::uint64_t quadrant;
};

// x - n pi/2 in [-pi/4, pi/4], to about 100 bits.
Reduced reduce_to_quadrant(double x) noexcept {
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  const double shifted = x * kTwoOverPi + kRounder;
  const double n = shifted - kRounder;
  const double first = x - n * kHalfPi1;  // exact
  const double second = n * kHalfPi2;     // exact
  const double a = first - second;
  const double a_virtual = first - a;
  const double a_rest = (first - (a + a_virtual)) + (a_virtual - second);
  const double third = n * kHalfPi3;  // exact
  const double b = a - third;
  const double b_virtual = a - b;
  const double b_rest = (a - (b + b_virtual)) + (b_virtual - third);
  const double rest = (a_rest + b_rest) - n * kHalfPi4;
  const double value = b + rest;
  return {value, (b - value) + rest, bit_cast<std::uint64_t>(shifted) & 3};
}

// Sine and cosine from the reduced angle and its quadrant.
SinCos sin_cos_of(const Reduced& angle) noexcept {
  const auto [r, rest, quadrant] = angle;
  const double z = r * r;
  // Taylor series; the next terms are below 1e-19 and 1e-18.
  constexpr double kSine[] = {-1.0 / 6,
                              1.0 / 120,
                              -1.0 / 5040,
                              1.0 / 362880,
                              -1.0 / 39916800.0,
                              1.0 / 6227020800.0,
                              -1.0 / 1307674368000.0,
                              1.0 / 355687428096000.0};
  constexpr double kCosine[] = {1.0 / 24,
                                -1.0 / 720,
                                1.0 / 40320,
                                -1.0 / 3628800,
                                1.0 / 479001600.0,
                                -1.0 / 87178291200.0,
                                1.0 / 20922789888000.0,
                                -1.0 / 6402373705728000.0};
  const double half = 0.5 * z;
  const double sine = r + (r * z * polynomial(kSine, z) + rest * (1.0 - half));
  const double near_one = 1.0 - half;
  const double cosine = near_one + (((1.0 - near_one) - half) + (z * z * polynomial(kCosine, z) - r * rest));
  // A quarter turn swaps sine and cosine and changes a sign. Without branches, which random angles would
  // mispredict.
  const auto sine_bits = bit_cast<std::uint64_t>(sine);
  const auto cosine_bits = bit_cast<std::uint64_t>(cosine);
  const std::uint64_t swap = (sine_bits ^ cosine_bits) & (0 - (quadrant & 1));
  const std::uint64_t sine_sign = (quadrant & 2) << 62;
  const std::uint64_t cosine_sign = ((quadrant + 1) & 2) << 62;
  return {bit_cast<double>(sine_bits ^ swap ^ sine_sign), bit_cast<double>(cosine_bits ^ swap ^ cosine_sign)};
}

// (asin(s)/s - 1)/s^2 as a function of z = s^2 in [0, 1/4]: interpolated at Chebyshev nodes of the exact
// series; z times the error is below 2.4e-18.
double asin_excess(double z) noexcept {
  constexpr double kTerms[] = {0x1.5555555555555p-3,  0x1.3333333333388p-4, 0x1.6db6db6dac1e0p-5,
                               0x1.f1c71c7a52ba3p-6,  0x1.6e8ba123e494cp-6, 0x1.1c4efce23019fp-6,
                               0x1.c990ad3d8fdc7p-7,  0x1.7b027ee1dd5a0p-7, 0x1.3b49de71213edp-7,
                               0x1.31622469ce7d2p-7,  0x1.8f193743407d3p-9, 0x1.406192d12476cp-6,
                               -0x1.3b416bb7d8f2dp-6, 0x1.e529c6fce96eep-6};
  return polynomial(kTerms, z);
}

constexpr double kLog2E = 0x1.71547652b82fep+0;

// (e^r - 1 - r)/r^2 for |r| <= ln(2)/2: Taylor series, next term below 5e-18.
constexpr double kExpExcess[] = {1.0 / 2,       1.0 / 6,        1.0 / 24,        1.0 / 120,
                                 1.0 / 720,     1.0 / 5040,     1.0 / 40320,     1.0 / 362880,
                                 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800.0};

// The upper 21 bits of a positive number's significand; its square is exact.
double upper_half(double x) noexcept {
  return bit_cast<double>(bit_cast<std::uint64_t>(x) & 0xffff'ffff'0000'0000ULL);
}

}  // namespace

double exp(double x) noexcept {
  constexpr double kOverflow = 709.782712893384;     // ln of the largest double
  constexpr double kUnderflow = -745.1332191019412;  // ln of half the smallest double
  if (!(x <= kOverflow)) return x > kOverflow ? kInfinity : x;
  if (x < kUnderflow) return 0.0;
  const double k = (x * kLog2E + kRounder) - kRounder;
  const double high = x - k * kLn2High;  // exact
  const double low = k * kLn2Low;
  const double r = high - low;  // |r| <= ln(2)/2
  const double value = 1.0 + (high + (r * r * polynomial(kExpExcess, r) - low));
  const auto exponent = static_cast<std::int64_t>(k);
  const std::int64_t half = exponent / 2;  // in two steps, so that neither factor overflows or underflows
  return value * power_of_two(half) * power_of_two(exponent - half);
}

double expm1(double x) noexcept {
  constexpr double kFromExp = 38.0;  // above it e^x - 1 equals e^x up to the last digit, below minus it -1
  if (x != x || x > kFromExp) return exp(x) - 1.0;
  if (x < -kFromExp) return -1.0;
  const double k = (x * kLog2E + kRounder) - kRounder;
  const double high = x - k * kLn2High;  // exact
  const double low = k * kLn2Low;
  const double r = high - low;                                            // |r| <= ln(2)/2
  const double small = high + (r * r * polynomial(kExpExcess, r) - low);  // e^r - 1
  if (k == 0.0) return small;
  const double power = power_of_two(static_cast<std::int64_t>(k));
  return power * small + (power - 1.0);
}

double log1p(double x) noexcept {
  // ln(u) x/(u - 1) with u = 1 + x rounded: the rounding error of u cancels [Kahan; Goldberg 1991, th. 4]
  const double u = 1.0 + x;
  if (u == 1.0 || u == kInfinity) return x;
  return log(u) * (x / (u - 1.0));
}

double log(double x) noexcept {
  if (!(x > 0.0)) return x == 0.0 ? -kInfinity : kNaN;
  if (x == kInfinity) return x;
  constexpr double kSmallestNormal = std::numeric_limits<double>::min();
  std::int64_t exponent = 0;
  if (x < kSmallestNormal) {
    x *= 0x1p54;
    exponent = -54;
  }
  // x = 2^k m with m in [sqrt(1/2), sqrt(2)): the offset moves the boundary from 1 to sqrt(1/2)
  constexpr std::uint64_t kSqrtHalf = 0x3fe6'a09e'667f'3bcdULL;
  const std::uint64_t offset = bit_cast<std::uint64_t>(x) - kSqrtHalf;
  const std::int64_t shift = static_cast<std::int64_t>(offset) >> 52;
  exponent += shift;
  const double m = bit_cast<double>(bit_cast<std::uint64_t>(x) - (static_cast<std::uint64_t>(shift) << 52));
  // ln(1 + f) = 2 atanh(s) = 2s + s R(s^2), s = f/(2 + f), and 2s = f - f^2/2 + s f^2/2; next term below
  // 1e-18
  const double f = m - 1.0;
  const double s = f / (2.0 + f);
  const double z = s * s;
  // R(z)/z, interpolated at Chebyshev nodes of the exact series; s z times the error is below 2e-18
  constexpr double kTerms[] = {0x1.5555555555558p-1, 0x1.99999999952e2p-2, 0x1.2492492df14dfp-2,
                               0x1.c71c62e579789p-3, 0x1.7462b4ad0d879p-3, 0x1.39fe60271f67fp-3,
                               0x1.2b584dae87b53p-3};
  const double series = z * polynomial(kTerms, z);
  const double half_square = 0.5 * f * f;
  const auto k = static_cast<double>(exponent);
  return k * kLn2High - ((half_square - (s * (half_square + series) + k * kLn2Low)) - f);
}

SinCos sin_cos(double x) noexcept {
  constexpr double kLargest = 1e9;  // beyond it even the quadrant would be wrong
  if (!(std::fabs(x) <= kLargest)) return {kNaN, kNaN};
  return sin_cos_of(reduce_to_quadrant(x));
}

double cos_of_turns(double turns) noexcept {
  constexpr double kLargest = 0x1p40;  // the rounder's low bits must hold the parity
  if (!(std::fabs(turns) <= kLargest)) return kNaN;
  // cos(2 pi turns) = -sin(pi (2 turns - 1/2)) = -(-1)^n sin(pi left), |left| <= 1/2: one odd series is
  // enough
  const double halves = 2.0 * turns - 0.5;
  const double shifted = halves + kRounder;
  const double left = halves - (shifted - kRounder);
  const double r = left * kPi;
  const double z = r * r;
  // (sin(r)/r - 1)/z, interpolated at Chebyshev nodes of the exact series; z times the error is below 3e-17
  constexpr double kSine[] = {-0x1.5555555555555p-3,  0x1.1111111111107p-7,   -0x1.a01a01a018aadp-13,
                              0x1.71de3a5456715p-19,  -0x1.ae6455a1d702bp-26, 0x1.6124015b5d047p-33,
                              -0x1.ae5138c0886c1p-41, 0x1.89a4865c3ec8ep-49};
  const double sine = r + r * z * polynomial(kSine, z);
  const std::uint64_t sign = (~bit_cast<std::uint64_t>(shifted) & 1) << 63;  // minus where n is even
  return bit_cast<double>(bit_cast<std::uint64_t>(sine) ^ sign);
}

double acos(double x) noexcept {
  if (x >= 1.0) return 0.0;
  if (x <= -1.0) return kPi;
  if (std::fabs(x) <= 0.5) {  // pi/2 - asin(x)
    const double excess = x * (x * x) * asin_excess(x * x);
    return kHalfPiHigh - (x - (kHalfPiLow - excess));
  }
  if (x > 0.5) {  // 2 asin(sqrt((1 - x)/2)), with the rounding error of the root
    const double z = 0.5 * (1.0 - x);
    const double root = std::sqrt(z);
    const double upper = upper_half(root);
    const double lower = (z - upper * upper) / (root + upper);
    return 2.0 * (upper + (root * z * asin_excess(z) + lower));
  }
  const double z = 0.5 * (1.0 + x);  // pi - 2 asin(sqrt((1 + x)/2))
  const double root = std::sqrt(z);
  return 2.0 * (kHalfPiHigh - (root + (root * z * asin_excess(z) - kHalfPiLow)));
}

}  // namespace palpate::portable
