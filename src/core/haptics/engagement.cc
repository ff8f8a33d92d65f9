#include "core/haptics/engagement.h"

#include <algorithm>

namespace palpate::haptics {
namespace {

/// Counts the ticks for which the device has been still outside the tissue.
void watch_stillness(Engagement& engagement, const HandSituation& hand, double period) noexcept {
  const bool moved = (hand.position_D - engagement.still_at_D).norm() > kStillWithin;
  if (!hand.outside || moved || engagement.still_ticks == 0) {
    engagement.still_at_D = hand.position_D;
    engagement.still_ticks = hand.outside ? 1 : 0;
    return;
  }
  ++engagement.still_ticks;
  engagement.ready = static_cast<double>(engagement.still_ticks) * period >= kStillFor;
}

}  // namespace

double advance_engagement(Engagement& engagement, const HandSituation& hand, double period) noexcept {
  if (!hand.usable) {
    engagement = Engagement{};
  } else if (hand.clutched) {
    engagement.ready = false;
    engagement.still_ticks = 0;
    engagement.share = std::max(0.0, engagement.share - period / kLetGoTime);
  } else if (engagement.ready) {
    engagement.share = std::min(1.0, engagement.share + period / kRampTime);
  } else {
    engagement.share = std::max(0.0, engagement.share - period / kLetGoTime);
    watch_stillness(engagement, hand, period);
  }
  return engagement.share;
}

}  // namespace palpate::haptics
