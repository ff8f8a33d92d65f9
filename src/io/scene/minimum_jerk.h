#pragma once

namespace palpate::scene {

/// [any] Minimum-jerk motion from 0 to 1 as u goes from 0 to 1: no speed and no acceleration at either end,
/// its greatest slope 1.875 [Flash and Hogan 1985].
[[nodiscard]] constexpr double minimum_jerk(double u) noexcept {
  return u * u * u * (10.0 + u * (-15.0 + u * 6.0));
}

}  // namespace palpate::scene
