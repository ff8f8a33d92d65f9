#include "app/window/row_tap.h"

#include <cmath>

namespace palpate::app {

RowSample sample_of_row(const haptics::TickRow& row) noexcept {
  RowSample sample;
  sample.time = row.time;
  sample.tick = row.tick;
  sample.hand = row.hand;
  sample.phase = row.phase;
  sample.distance = row.distance;
  sample.depth = row.depth;
  sample.force =
      std::sqrt(row.force[0] * row.force[0] + row.force[1] * row.force[1] + row.force[2] * row.force[2]);
  sample.tissue_force = row.tissue_force;
  sample.noise_force = row.noise_force;
  sample.engagement = row.engagement;
  sample.tick_ns = row.tick_ns;
  sample.late_ns = row.late_ns;
  sample.status = row.status;
  sample.fault = row.fault;
  return sample;
}

void RowTap::on_row(const haptics::TickRow& row) noexcept {
  if (!ring_.push(sample_of_row(row))) left_out_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace palpate::app
