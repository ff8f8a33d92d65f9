#pragma once
#include <cstdint>

#include "palpate/pose.h"

namespace palpate::haptics {

/// A held device gives force only after it was still outside the tissue, then by a ramp: whoever takes it in
/// hand meets no force that was there before.
struct Engagement {
  double share = 0.0;             // of force and noise that is let through, 0 to 1
  bool ready = false;             // it was still outside: the share rises
  std::uint64_t still_ticks = 0;  // so long it has been
  Vec3 still_at_D = Vec3::Zero();
};

inline constexpr double kStillWithin = 1e-3;  // m: a resting hand trembles by some tenths of a millimetre
inline constexpr double kStillFor = 0.25;     // s
inline constexpr double kRampTime = 0.5;      // s, from nothing to all
inline constexpr double kLetGoTime = 0.05;    // s, from all to nothing when the clutch is held

/// What a hand does at a tick, as far as engagement goes.
struct HandSituation {
  Vec3 position_D = Vec3::Zero();
  bool usable = true;   // the sample is good and no fault is latched
  bool outside = true;  // the tool touches nothing and is not inside
  bool clutched = false;
};

/// [rt] One tick of a held device. A fault takes the share to 0 at once (the gate brings the force down); the
/// clutch within kLetGoTime; both ask for stillness again. @param period s @return the share
double advance_engagement(Engagement& engagement, const HandSituation& hand, double period) noexcept;

}  // namespace palpate::haptics
