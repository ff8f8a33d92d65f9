#pragma once

namespace palpate::identify {

/// [any] Density and distribution function of the standard normal distribution.
[[nodiscard]] double normal_density(double z) noexcept;
[[nodiscard]] double normal_cdf(double z) noexcept;

/// [any] Student's t that 97.5 % do not exceed; fewer than 3 degrees of freedom count as 3.
[[nodiscard]] double student(double freedom);

}  // namespace palpate::identify
