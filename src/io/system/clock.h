#pragma once
#include <cstdint>
#include <limits>

namespace palpate {

/// [rt] Monotonic time [ns].
[[nodiscard]] std::int64_t monotonic_ns() noexcept;

/// [rt] Processor time of the calling thread [ns].
[[nodiscard]] std::int64_t thread_cpu_ns() noexcept;

/// [rt] Wall time since 1970 [ns].
[[nodiscard]] std::int64_t unix_ns() noexcept;

/// [rt] Wall time since 1970 [ns] at a monotonic time: of both clocks read together, since a thread that is
/// preempted between them would shift the time.
[[nodiscard]] inline std::int64_t wall_time_of(std::int64_t monotonic) noexcept {
  std::int64_t offset = 0;
  std::int64_t closest = std::numeric_limits<std::int64_t>::max();
  for (int tries = 0; tries < 8 && closest > 10'000; ++tries) {
    const std::int64_t before = monotonic_ns();
    const std::int64_t wall = unix_ns();
    const std::int64_t apart = monotonic_ns() - before;
    if (apart >= closest) continue;
    closest = apart;
    offset = wall - before - apart / 2;
  }
  return monotonic + offset;
}

/// [rt] Sleeps until monotonic_ns() reaches `deadline` [ns].
void sleep_until_ns(std::int64_t deadline) noexcept;

}  // namespace palpate
