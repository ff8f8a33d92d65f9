#pragma once

namespace palpate::identify {

/// [any] 97.5 % quantile of Student's t distribution. `freedom` below 3 is treated as 3.
[[nodiscard]] double student_t_quantile(double freedom);

}  // namespace palpate::identify
