#include <cmath>
#include <limits>

#include "core/base/portable_math.h"
#include "palpate/error.h"

#include "study/psychophysics/normal.h"
#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {
namespace {

double rate_of(const Count& count, bool log_linear) {
  if (count.trials <= 0) throw ParameterError("trials", count.trials, "> 0");
  if (count.counted < 0 || count.counted > count.trials) {
    throw ParameterError("counted", count.counted, "0 to the number of trials");
  }
  return log_linear ? (count.counted + 0.5) / (count.trials + 1.0)
                    : static_cast<double>(count.counted) / count.trials;
}

bool extreme(const Count& count) {
  constexpr double kExtreme = 0.05;
  const double rate = rate_of(count, false);
  return rate < kExtreme || rate > 1.0 - kExtreme;
}

double z_of(double rate) {
  if (rate > 0.0 && rate < 1.0) return normal_quantile(rate);
  return std::copysign(std::numeric_limits<double>::infinity(), rate - 0.5);
}

// d' of a yes/no task.
Sensitivity sensitivity_of(double z_hits, double z_false_alarms) {
  Sensitivity found;
  found.d_prime = z_hits - z_false_alarms;
  found.criterion = -0.5 * (z_hits + z_false_alarms);
  found.ln_beta = found.d_prime * found.criterion;
  return found;
}

}  // namespace

Sensitivity yes_no(const Count& hits, const Count& false_alarms, bool log_linear) {
  Sensitivity found =
      sensitivity_of(z_of(rate_of(hits, log_linear)), z_of(rate_of(false_alarms, log_linear)));
  found.reliable = !extreme(hits) && !extreme(false_alarms);
  return found;
}

// "First interval" is the "yes" of a yes/no task: a wrong answer about the second interval is its false
// alarm.
Sensitivity two_interval(const Count& first, const Count& second, bool log_linear) {
  Sensitivity found = sensitivity_of(z_of(rate_of(first, log_linear)), -z_of(rate_of(second, log_linear)));
  found.d_prime /= std::sqrt(2.0);
  found.reliable = !extreme(first) && !extreme(second);
  return found;
}

// The integral of phi(x - d') Phi(x)^(m - 1), by the trapezoidal rule, which is exact for such bells.
double correct_of_d_prime(double d_prime, int intervals) {
  if (intervals < 2) throw ParameterError("intervals", intervals, ">= 2");
  constexpr double kRange = 9.0;
  constexpr int kSteps = 240;
  constexpr double kStep = 2.0 * kRange / kSteps;
  constexpr double kInverseRootOfTwoPi = 0.39894228040143267794;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = -kRange + i * kStep;
    const double below = normal_cdf(x + d_prime);
    double all_below = kInverseRootOfTwoPi * portable::exp(-0.5 * x * x);
    for (int other = 1; other < intervals; ++other) all_below *= below;
    sum += all_below;
  }
  return sum * kStep;
}

double d_prime_of_correct(double correct, int intervals) {
  if (!(correct > 0.0 && correct < 1.0)) throw ParameterError("correct", correct, "> 0 and < 1");
  double low = -9.0;
  double high = 9.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (correct_of_d_prime(middle, intervals) < correct ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace palpate::psychophysics
