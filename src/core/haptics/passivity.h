#pragma once
#include "core/haptics/workspace.h"
#include "palpate/device.h"
#include "palpate/pose.h"

namespace palpate::haptics {

/// The energy observer of one hand: what was written, times how the device moved while it was held.
/// [Hannaford, Ryu 2002]
struct EnergyAccount {
  double tissue = 0.0;  // J that the hand and the organ's own motion put into the tissue's force and torque
                        // and did not get back
  double noise = 0.0;   // J that the touch noise, an open-loop source, has given to the hand
  double noise_excess = 0.0;  // J of it beyond kNoisePower
};

/// A deficit up to this is no matter: a hundredth of what a fingertip's tap carries.
inline constexpr double kEnergyLeeway = 20e-6;  // J

/// The controller's damping is at most this: a sampled damper itself is passive on anything that weighs more
/// than its coefficient times half a tick (5 g at 1 kHz).
inline constexpr double kMostDamping = 10.0;         // N s/m
inline constexpr double kMostAngularDamping = 2e-3;  // N m s/rad

/// The touch noise may give the hand this much [W] without end, and kNoiseLeeway [J] at once; beyond that it
/// fades, and is gone at twice the leeway. White noise of sigma on a mass m gives sigma^2 T / (2 m): 1 uW at
/// the default 10 mN on 50 g.
inline constexpr double kNoisePower = 1e-3;
inline constexpr double kNoiseLeeway = 1e-3;

/// [rt] Books one tick of the tissue's force. @param written, noise what was written at the last tick (noise
/// is a part of its force) @param relative how the device moved since, less how the organ moved by itself:
/// what a breathing organ does on the hand is paid for by its breathing
void book(EnergyAccount& account, const ForceCommand& written, const Vec3& noise,
          const DeviceMotion& relative) noexcept;

/// [rt] Books one tick of the noise. @param motion how the device moved since @param period s
void book_noise(EnergyAccount& account, const Vec3& noise, const DeviceMotion& motion,
                double period) noexcept;

/// [rt] How much of the noise may go on, 0 to 1: see kNoisePower.
[[nodiscard]] double noise_share(const EnergyAccount& account) noexcept;

/// [rt] Outside the tissue nothing is stored: what the hand put in was spent, and may not be given back at
/// the next touch. A deficit stays.
void forgive_surplus(EnergyAccount& account) noexcept;

/// [rt] The passivity controller: while more than kEnergyLeeway has been given out than put in, force and
/// torque lose what would give still more along the way the device moves on the organ, and damp the deficit
/// away, at best within the next tick. @param relative as for book() @param period s @return whether it acted
bool damp_deficit(const EnergyAccount& account, const DeviceMotion& relative, double period,
                  ForceCommand& tissue) noexcept;

}  // namespace palpate::haptics
