#pragma once

namespace palpate::identify {

/// [any] Density and distribution function of the standard normal distribution.
[[nodiscard]] double normal_density(double z) noexcept;
[[nodiscard]] double normal_cdf(double z) noexcept;

/// [any] 97.5 % quantile of Student's t distribution. `freedom` below 3 is treated as 3.
[[nodiscard]] double student_t_quantile(double freedom);

}  // namespace palpate::identify
