#include "core/haptics/force_ramp.h"

#include <algorithm>

namespace palpate::haptics {
namespace {

/// Counts the ticks for which the device has been still outside the tissue.
void count_still_ticks(ForceRamp& ramp, const ForceRampInput& hand, double period) noexcept {
  const bool moved = (hand.position_D - ramp.still_at_D).norm() > kStillWithin;
  if (!hand.outside || moved || ramp.still_ticks == 0) {
    ramp.still_at_D = hand.position_D;
    ramp.still_ticks = hand.outside ? 1 : 0;
    return;
  }
  ++ramp.still_ticks;
  ramp.ready = static_cast<double>(ramp.still_ticks) * period >= kStillFor;
}

}  // namespace

double advance_force_ramp(ForceRamp& ramp, const ForceRampInput& hand, double period) noexcept {
  if (!hand.usable) {
    ramp = ForceRamp{};
  } else if (hand.clutched) {
    ramp.ready = false;
    ramp.still_ticks = 0;
    ramp.gain = std::max(0.0, ramp.gain - period / kRampDownTime);
  } else if (ramp.ready) {
    ramp.gain = std::min(1.0, ramp.gain + period / kRampTime);
  } else {
    ramp.gain = std::max(0.0, ramp.gain - period / kRampDownTime);
    count_still_ticks(ramp, hand, period);
  }
  return ramp.gain;
}

}  // namespace palpate::haptics
