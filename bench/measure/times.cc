#include "bench/measure/times.h"

#include <algorithm>

namespace palpate::bench {

TimeStatistics figures_of(std::vector<double> times_us) {
  std::sort(times_us.begin(), times_us.end());
  TimeStatistics figures;
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
