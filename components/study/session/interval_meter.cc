#include "study/session/interval_meter.h"

#include <algorithm>

namespace palpate::study {

void IntervalMeter::add(const haptics::TickRow& row, bool averaged, double target) {
  touched_ = touched_ || row.depth > 0.0;
  cues_.peak_force = std::max(cues_.peak_force, row.tissue_force);
  cues_.depth = std::max(cues_.depth, row.depth);
  cues_.work += std::max(row.depth - last_depth_, 0.0) * row.tissue_force;
  last_depth_ = row.depth;
  if (!averaged) return;
  ++averaged_;
  force_sum_ += row.tissue_force;
  force_square_ += row.tissue_force * row.tissue_force;
  const double error = row.tissue_force - target;
  square_sum_ += error * error;
}

IntervalCues IntervalMeter::cues() const {
  IntervalCues cues = cues_;
  if (averaged_ > 0) cues.mean_force = force_sum_ / static_cast<double>(averaged_);
  return cues;
}

double IntervalMeter::rms_error() const {
  return averaged_ == 0 ? 0.0 : std::sqrt(square_sum_ / static_cast<double>(averaged_));
}

double IntervalMeter::variation() const {
  if (averaged_ == 0) return 0.0;
  const double rows = static_cast<double>(averaged_);
  const double mean = force_sum_ / rows;
  return mean > 0.0 ? std::sqrt(std::max(force_square_ / rows - mean * mean, 0.0)) / mean : 0.0;
}

}  // namespace palpate::study
