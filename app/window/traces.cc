#include "app/window/traces.h"

#include <algorithm>

namespace palpate::app {

void Traces::take(RowObserver& observer, bool keep,
                  const std::function<void(const haptics::TickRow&)>& each) {
  haptics::TickRow sample;
  while (observer.take(sample)) {
    if (sample.hand >= kept_.size()) continue;
    if (each) each(sample);
    newest_[sample.hand] = sample;
    newest_time_ = sample.time;
    if (sample.hand == 0) {  // the rows of all hands carry the times of their tick
      tick_time_.add(sample.tick_ns);
      lateness_.add(sample.late_ns);
      if (static_cast<double>(sample.late_ns) >= period_ns_) ++missed_;
    }
    noise_squares_ += sample.noise_force * sample.noise_force;
    largest_tissue_ = std::max(largest_tissue_, sample.tissue_force);
    ++statistics_rows_;
    if (!keep) continue;
    std::deque<haptics::TickRow>& rows = kept_[sample.hand];
    rows.push_back(sample);
    while (rows.front().time < sample.time - kKept) rows.pop_front();
  }
}

Traces::NoiseStatistics Traces::take_noise_statistics() {
  NoiseStatistics statistics;
  if (statistics_rows_ > 0)
    statistics = {std::sqrt(noise_squares_ / static_cast<double>(statistics_rows_)), largest_tissue_};
  noise_squares_ = 0.0;
  largest_tissue_ = 0.0;
  statistics_rows_ = 0;
  return statistics;
}

}  // namespace palpate::app
