#include "run/devices/path_end.h"

#include <cmath>

namespace palpate::devices {

std::uint64_t last_tick_of(const scene::ToolPath& path, double rate_Hz) noexcept {
  constexpr double kLargest = 9e18;  // below 2^63
  const double ticks = std::floor((path.end_time() + kRestAfterPath) * rate_Hz + 0.5);
  if (!(ticks > 0.0)) return 0;
  return ticks < kLargest ? static_cast<std::uint64_t>(ticks) : ~std::uint64_t{0};
}

}  // namespace palpate::devices
