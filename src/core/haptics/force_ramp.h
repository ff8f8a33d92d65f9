#pragma once
#include <cstdint>

#include "palpate/pose.h"

namespace palpate::haptics {

/// The force ramp (soft start) of a held device. The force ramps up only after the device was still outside
/// the tissue, so nobody takes hold of a device that already pushes.
struct ForceRamp {
  double gain = 0.0;              // gain of force and noise, 0 to 1
  bool ready = false;             // it has been still outside: the gain rises
  std::uint64_t still_ticks = 0;  // ticks it has been still outside
  Vec3 still_at_D = Vec3::Zero();
};

inline constexpr double kStillWithin = 1e-3;   // m; a resting hand trembles by some tenths of a millimetre
inline constexpr double kStillFor = 0.25;      // s
inline constexpr double kRampTime = 0.5;       // s, from 0 to full force
inline constexpr double kRampDownTime = 0.05;  // s, from full force to 0 while the clutch is held

/// A hand's input to the force ramp in one tick.
struct ForceRampInput {
  Vec3 position_D = Vec3::Zero();
  bool usable = true;   // the sample is valid and no fault is latched
  bool outside = true;  // the tool is not in contact and not inside the organ
  bool clutched = false;
};

/// [rt] One tick of a held device. A fault sets the gain to 0 at once (the gate lowers the force); the clutch
/// lowers it within kRampDownTime. Both require stillness again. @param period T [s] @return the gain
double advance_force_ramp(ForceRamp& ramp, const ForceRampInput& hand, double period) noexcept;

}  // namespace palpate::haptics
