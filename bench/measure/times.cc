#include "bench/measure/times.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/statistics.h"

namespace palpate::bench {

namespace {

void add_up(std::uint64_t additions) noexcept {
  volatile double kept = 1.0;
  double sum = kept;
  for (std::uint64_t i = 0; i < additions; ++i) sum += 1e-3;
  kept = sum;
}

}  // namespace

PlainArithmetic::PlainArithmetic(double length_us) : additions_(0) {
  constexpr std::uint64_t kTried = 2000;
  constexpr int kTries = 101;
  std::vector<double> times_us;
  for (int i = 0; i < kTries; ++i) {
    const std::int64_t begun = thread_cpu_ns();
    add_up(kTried);
    times_us.push_back(static_cast<double>(thread_cpu_ns() - begun) / kNanosecondsPerMicrosecond);
  }
  // Reading the clock is in both lengths.
  const double clock_us = clock_cost_ns() / kNanosecondsPerMicrosecond;
  const double each_us = (median(times_us) - clock_us) / static_cast<double>(kTried);
  const double wanted = (length_us - clock_us) / each_us;
  if (wanted > 1.0 && std::isfinite(wanted)) additions_ = static_cast<std::uint64_t>(wanted);
}

void PlainArithmetic::run() const noexcept { add_up(additions_); }

TimeFigures figures_of(std::vector<double> times_us) {
  std::sort(times_us.begin(), times_us.end());
  TimeFigures figures;
  figures.samples = times_us.size();
  if (times_us.empty()) return figures;
  figures.p50_us = times_us[quantile_index(0.5, times_us.size())];
  figures.p99_us = times_us[quantile_index(0.99, times_us.size())];
  figures.p999_us = times_us[quantile_index(0.999, times_us.size())];
  figures.max_us = times_us.back();
  return figures;
}

double clock_cost_ns() {
  constexpr std::size_t kReadings = 20'001;
  std::vector<double> costs;
  costs.reserve(kReadings);
  for (std::size_t i = 0; i < kReadings; ++i) {
    const std::int64_t begun = thread_cpu_ns();
    costs.push_back(static_cast<double>(thread_cpu_ns() - begun));
  }
  return median(std::move(costs));
}

}  // namespace palpate::bench
