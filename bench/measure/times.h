#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/statistics.h"
#include "io/system/clock.h"

namespace palpate::bench {

inline constexpr double kNanosecondsPerMicrosecond = 1e3;

/// Statistics of many times; zero without samples.
struct TimeStatistics {
  std::size_t samples = 0;
  double p50_us = 0.0;
  double p99_us = 0.0;
  double p999_us = 0.0;
  double max_us = 0.0;
};

/// [setup] Statistics of times [us] in any order.
[[nodiscard]] TimeStatistics figures_of(std::vector<double> times_us);

/// [setup] Median over batches of the CPU time of one call [ns].
/// @param call call(i), i = 0 .. calls-1, returns a number; its use keeps the compiler from removing the call
template <typename Call>
[[nodiscard]] double median_call_ns(Call call) {
  constexpr std::size_t kBatches = 101;
  constexpr std::uint64_t kCalls = 10'000;
  std::vector<double> batches;
  double sum = 0.0;
  for (std::size_t batch = 0; batch < kBatches; ++batch) {
    const std::int64_t begun = thread_cpu_ns();
    for (std::uint64_t i = 0; i < kCalls; ++i) sum += call(i);
    batches.push_back(static_cast<double>(thread_cpu_ns() - begun) / static_cast<double>(kCalls));
  }
  volatile double kept = sum;
  static_cast<void>(kept);
  return median(std::move(batches));
}

/// [setup] Median cost [ns] of reading the clock twice; every single time of this library contains it.
[[nodiscard]] double clock_cost_ns();

}  // namespace palpate::bench
