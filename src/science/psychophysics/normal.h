#pragma once

namespace palpate::psychophysics {

/// [any] Distribution function of the standard normal distribution, with the same bits on any x86-64.
/// Absolute error below 1e-15.
[[nodiscard]] double normal_cdf(double z) noexcept;

/// [setup] Its inverse, for 0 < p < 1.
[[nodiscard]] double normal_quantile(double p);

/// [setup] Quantile of Student's t distribution, and the probability that |t| is exceeded by chance.
[[nodiscard]] double student_t_quantile(double freedom, double probability = 0.975);
[[nodiscard]] double student_t_two_sided(double t, double freedom);

}  // namespace palpate::psychophysics
