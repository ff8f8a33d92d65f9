#pragma once

/// Elementary functions with the same bits at -O0 and -O2 on any x86-64. (The C library chooses its versions
/// by processor.) They use only +, -, *, / and sqrt of IEEE 754. The error is at most 2 units in the last
/// place unless stated otherwise.
namespace palpate::portable {

inline constexpr double kPi = 3.14159265358979323846;

struct SinCos {
  double sine;
  double cosine;
};

/// [rt] e^x; 0 below -745.2, infinity above 709.8, NaN for NaN.
[[nodiscard]] double exp(double x) noexcept;

/// [rt] Natural logarithm; -infinity at 0, NaN below, infinity at infinity.
[[nodiscard]] double log(double x) noexcept;

/// [rt] e^x - 1 without cancellation at small x; -1 for large negative x, infinity above 709.8, NaN for NaN.
[[nodiscard]] double expm1(double x) noexcept;

/// [rt] ln(1 + x) without cancellation at small x; error at most 3 units in the last place. -infinity at -1,
/// NaN below, infinity at infinity.
[[nodiscard]] double log1p(double x) noexcept;

/// [rt] Sine and cosine of x [rad], |x| <= 1e5. Larger arguments lose digits; NaN beyond 1e9.
[[nodiscard]] SinCos sin_cos(double x) noexcept;

/// [rt] Cosine of 2 pi turns, |turns| <= 2^40 (NaN beyond), at half the cost of sin_cos(). The argument is
/// exact for |turns| < 1 in steps of 2^-53. Otherwise the angle is rounded to 2^-53 turns or to its own last
/// place, whichever is larger.
[[nodiscard]] double cos_of_turns(double turns) noexcept;

/// [rt] Arc cosine [rad] of x clamped to [-1, 1]; NaN for NaN.
[[nodiscard]] double acos(double x) noexcept;

}  // namespace palpate::portable
