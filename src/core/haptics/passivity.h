#pragma once
#include "core/haptics/workspace.h"
#include "palpate/device.h"
#include "palpate/pose.h"

namespace palpate::haptics {

/// The energy observer of one hand: what was written, times how the device moved while it was held.
/// [Hannaford, Ryu 2002]
struct EnergyAccount {
  double tissue = 0.0;  // J that the hand put into the tissue's force and torque and did not get back
  double noise = 0.0;   // J that the touch noise, an open-loop source, has given to the hand
};

/// A deficit up to this is no matter: a hundredth of what a fingertip's tap carries.
inline constexpr double kEnergyLeeway = 20e-6;  // J

/// The controller's damping is at most this: a sampled damper itself is passive on anything that weighs more
/// than its coefficient times half a tick (5 g at 1 kHz).
inline constexpr double kMostDamping = 10.0;         // N s/m
inline constexpr double kMostAngularDamping = 2e-3;  // N m s/rad

/// [rt] Books one tick. @param written, noise what was written at the last tick (noise is a part of its
/// force); @param motion how the device moved since
void book(EnergyAccount& account, const ForceCommand& written, const Vec3& noise,
          const DeviceMotion& motion) noexcept;

/// [rt] Outside the tissue nothing is stored: what the hand put in was spent, and may not be given back at
/// the next touch. A deficit stays.
void forgive_surplus(EnergyAccount& account) noexcept;

/// [rt] The passivity controller: while more than kEnergyLeeway has been given out than put in, force and
/// torque lose what would give still more along the way the device moves, and damp the deficit away, at best
/// within the next tick. @param period s @return whether it acted
bool damp_deficit(const EnergyAccount& account, const DeviceMotion& motion, double period,
                  ForceCommand& tissue) noexcept;

}  // namespace palpate::haptics
