#pragma once
#include <algorithm>
#include <cstdint>

namespace palpate::net {

/// How often something may happen: so many times a second in the long run, and so many at once. [any]
class RateLimit final {
 public:
  RateLimit(double per_second, double at_once) noexcept
      : per_ns_(per_second / 1e9), most_(at_once), left_(at_once) {}

  /// Counts one more. @param now_ns monotonic time @return whether it is within the limit; it does not count
  /// against it otherwise.
  [[nodiscard]] bool allows(std::int64_t now_ns) noexcept {
    if (last_ns_ != 0) left_ = std::min(most_, left_ + per_ns_ * static_cast<double>(now_ns - last_ns_));
    last_ns_ = now_ns;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double per_ns_;
  double most_;
  double left_;
  std::int64_t last_ns_ = 0;
};

}  // namespace palpate::net
