#include "core/deform/half_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::deform {

HalfSpaceTerms<> half_space_terms(double r, double a) noexcept {
  constexpr double kPi = std::numbers::pi;
  const double k = 1.5 / (a * a * a);
  HalfSpaceTerms<> terms;
  r = std::max(r, 1e-6 * a);  // the quotients below; psi is even in r
  const double r2 = r * r;
  const double a2 = a * a;
  double f1 = 0.0;  // derivative by r of the pressure's integral of z ln(R + z) - R
  if (r < a) {
    const double p = std::sqrt(a2 - r2) / a;
    terms.psi = k * (a2 - 0.5 * r2) * 0.5 * kPi;
    terms.s = (1.0 - p * p * p) / r;
    f1 = -0.25 * k * kPi * r * (a2 - 0.25 * r2);
  } else {
    const double angle = std::asin(a / r);
    const double q = std::sqrt(r2 - a2);
    terms.psi = k * ((a2 - 0.5 * r2) * angle + 0.5 * a * q);
    terms.s = 1.0 / r;
    f1 = -(k / r) * ((a2 - 0.25 * r2) * 0.5 * (a * q + r2 * angle) + 0.25 * a * q * q * q);
    if (r > 20.0 * a) {  // series: the terms above lose their digits
      terms.psi = (1.0 + 0.1 * a2 / r2) / r;
      f1 = -1.0 + 0.1 * a2 / r2;
    }
  }
  terms.t = f1 / r;
  return terms;
}

double contact_pressure(double r, double a) noexcept {
  if (!(r < a)) return 0.0;
  return 1.5 / (std::numbers::pi * a * a) * std::sqrt(1.0 - r * r / (a * a));
}

double half_space_depth(double a) noexcept {
  return 2.0 * (1.0 - kPoisson) * half_space_terms(0.0, a).psi / kHalfSpaceModulus;
}

double ball_contact_radius(double tip_radius, double depth) noexcept {
  if (!(tip_radius > 0.0) || !(depth > 0.0)) return 0.0;
  double low = 0.0;
  double high = 1.0;
  for (int step = 0; step < 40; ++step) {
    const double x = 0.5 * (low + high);
    (x * std::atanh(x) * tip_radius < depth ? low : high) = x;
  }
  return low * tip_radius;
}

}  // namespace palpate::deform
