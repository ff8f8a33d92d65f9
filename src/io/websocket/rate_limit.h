#pragma once
#include <algorithm>
#include <cstdint>

namespace palpate::websocket {

/// [any] Token bucket: limits the long-term rate of events per second and the size of a burst.
class RateLimit final {
 public:
  RateLimit(double per_second, double at_once) noexcept
      : per_ns_(per_second / 1e9), most_(at_once), left_(at_once) {}

  /// Whether one more event is within the limit; an event beyond it is not counted. @param now_ns monotonic
  /// time
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

}  // namespace palpate::websocket
