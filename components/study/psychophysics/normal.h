#pragma once
#include "core/base/normal_distribution.h"

namespace palpate::psychophysics {

/// [setup] Inverse of normal_cdf(), for 0 < p < 1.
[[nodiscard]] double normal_quantile(double p);

/// [setup] Quantile of Student's t distribution, and the probability that |t| is exceeded by chance.
[[nodiscard]] double student_t_quantile(double freedom, double probability = 0.975);
[[nodiscard]] double student_t_two_sided(double t, double freedom);

}  // namespace palpate::psychophysics
