#include "core/base/normal_distribution.h"

#include <cmath>

#include "core/base/portable_math.h"

namespace palpate {

double normal_density(double z) noexcept {
  constexpr double kInverseRootOfTwoPi = 0.39894228040143267794;
  return kInverseRootOfTwoPi * portable::exp(-0.5 * z * z);
}

double normal_cdf(double z) noexcept {
  constexpr double kSeriesBelow = 3.0;  // above, 60 terms of the continued fraction are exact
  constexpr double kOneAbove = 8.3;     // the tail is below half the spacing of doubles under 1
  constexpr double kFarTail = 38.5;     // the density underflows
  const double x = std::abs(z);
  if (z > kOneAbove) return 1.0;
  if (!(x < kFarTail)) return z < 0.0 ? 0.0 : z;
  const double density = normal_density(x);
  double tail = 0.0;
  if (x < kSeriesBelow) {  // Phi(x) - 1/2 = density (x + x^3/3 + x^5/(3 5) + ...) [Marsaglia 2004]
    double term = x;
    double sum = x;
    for (int k = 3; term > 1e-17 * sum; k += 2) {
      term *= x * x / k;
      sum += term;
    }
    tail = 0.5 - density * sum;
  } else {  // 1 - Phi(x) = density/(x + 1/(x + 2/(x + 3/...))) [Laplace]
    double fraction = x;
    for (int k = 60; k > 0; --k) fraction = x + k / fraction;
    tail = density / fraction;
  }
  return z < 0.0 ? tail : 1.0 - tail;
}

}  // namespace palpate
