#pragma once
#include <cstdint>

namespace palpate {

/// [rt] Monotonic time [ns].
[[nodiscard]] std::int64_t monotonic_ns() noexcept;

/// [rt] Processor time of the calling thread [ns].
[[nodiscard]] std::int64_t thread_cpu_ns() noexcept;

/// [rt] Wall time since 1970 [ns].
[[nodiscard]] std::int64_t unix_ns() noexcept;

/// [rt] Sleeps until monotonic_ns() reaches `deadline` [ns].
void sleep_until_ns(std::int64_t deadline) noexcept;

}  // namespace palpate
