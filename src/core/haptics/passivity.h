#pragma once
#include "core/haptics/workspace.h"
#include "palpate/device.h"
#include "palpate/pose.h"

namespace palpate::haptics {

/// The passivity observer of one hand: the energy of the written force and torque, integrated over the
/// device's motion. [Hannaford, Ryu 2002]
struct PassivityObserver {
  // J, net energy that the hand and the organ's own motion have put into the tissue's force and torque
  double tissue = 0.0;
  double noise = 0.0;         // J given to the hand by touch noise and commanded force, open-loop sources
  double noise_excess = 0.0;  // J given beyond kNoisePower
  double largest_tick = 0.0;  // J, largest energy of the tissue's force in one tick, in either direction
  DeviceMotion recent{};      // in a tick, averaged over kMotionMemory, relative to the organ
  double way = 0.0;           // m^2, mean square of the same translations
  double turn = 0.0;          // rad^2, of the rotations
  double way_kept = 0.0;      // m^2, mean product of each translation with the average of those before it
  double turn_kept = 0.0;     // rad^2, of the rotations
  double damped_share = 0.0;  // of the recent ticks, in which the controller acted; see kDampedMemory
};

/// Energy deficits up to this are ignored: a hundredth of the energy of a fingertip's tap.
inline constexpr double kEnergyTolerance = 20e-6;  // J

/// Largest damping of the passivity controller. A sampled damper is passive on masses above its coefficient
/// times T/2 (5 g at 1 kHz).
inline constexpr double kMaxDamping = 10.0;         // N s/m
inline constexpr double kMaxAngularDamping = 2e-3;  // N m s/rad

/// The controller uses the motion averaged over kMotionMemory. In a tick the position sensors show single
/// steps, 0.1 m/s for 10 um in 0.1 ms; a damper on these gives energy at the next step back.
inline constexpr double kMotionMemory = 5e-3;  // s
inline constexpr double kDampingTime = 1e-3;   // s, in which it removes a deficit

/// A held device is unstable when the controller acted in more than kUnstableShare of the recent ticks (an
/// exponential average with the time constant kDampedMemory). It is also unstable when the deficit exceeds
/// kEnergyTolerance and twice the largest energy of a tick by more than kUnstableEnergy. The margins to
/// stable cases are in docs/decisions/0027.
inline constexpr double kDampedMemory = 0.5;      // s
inline constexpr double kUnstableShare = 0.9;     // reached after 1.15 s of uninterrupted action
inline constexpr double kUnstableEnergy = 50e-6;  // J

/// The slew limit delays the fall of a force that the hand moves away from. So the force is limited to what
/// the slew limit can bring to zero at these speeds before it gives more energy than the hand has put in.
inline constexpr double kReserveSpeed = 0.25;        // m/s
inline constexpr double kReserveAngularSpeed = 0.5;  // rad/s

/// Touch noise and commanded force together may give kNoisePower [W] continuously and kNoiseEnergy [J] beyond
/// it. Above that it fades, to zero at twice the leeway. White noise of sigma on a mass m gives sigma^2 T /
/// (2 m): 1 uW for the default 10 mN on 50 g.
inline constexpr double kNoisePower = 1e-3;
inline constexpr double kNoiseEnergy = 1e-3;

/// [rt] Adds one tick of the tissue force. @param written, noise of the last tick (the noise is part of the
/// force)
/// @param relative the device's motion since then minus the organ's own motion, so that work done by
/// breathing and heartbeat is not charged to the hand
void observe_tissue(PassivityObserver& observer, const ForceCommand& written, const Vec3& noise,
                    const DeviceMotion& relative) noexcept;

/// [rt] Adds one tick of the noise. @param motion the device's motion since the last tick @param period T [s]
void observe_noise(PassivityObserver& observer, const Vec3& noise, const DeviceMotion& motion,
                   double period) noexcept;

/// [rt] Gain of the noise, 0 to 1; see kNoisePower.
[[nodiscard]] double noise_scale(const PassivityObserver& observer) noexcept;

/// [rt] Resets a positive energy outside the tissue, where nothing is stored: otherwise it could be returned
/// at the next touch. A deficit stays. Without one, the bound of the guard starts at zero.
void reset_surplus(PassivityObserver& observer) noexcept;

/// [rt] Adds one tick to the average of the motion. @param period T [s]
void average_motion(PassivityObserver& observer, const DeviceMotion& relative, double period) noexcept;

/// [rt] Notes whether the controller acted on a hand that moves in the tissue. @param period T [s]
void observe_control(PassivityObserver& observer, bool acted, double period) noexcept;

/// [rt] Whether a held device is unstable, whatever the cause; see kUnstableShare and kUnstableEnergy.
[[nodiscard]] bool is_unstable(const PassivityObserver& observer) noexcept;

/// [rt] Forgets a deficit and the controller's action: after a fault that somebody has reset.
void reset_deficit(PassivityObserver& observer) noexcept;

/// Largest force and torque that the slew limits can bring to zero in time.
struct SlewReserve {
  double force = 0.0;   // N
  double torque = 0.0;  // N m
};

/// [rt] A force F that falls at the slew rate s gives at most F^2 v / (2 s) to a hand at the speed v. Force
/// and torque may each use half of the observer's surplus and the tolerance; beyond the tolerance they are 0.
/// @param slew, torque_slew limits [N/s, N m/s]
[[nodiscard]] SlewReserve slew_reserve(const PassivityObserver& observer, double slew,
                                       double torque_slew) noexcept;

/// [rt] Removes the components of force and torque that give energy along the relative motion.
void remove_giving(const DeviceMotion& relative, ForceCommand& tissue) noexcept;

/// [rt] The passivity controller. While the deficit exceeds kEnergyTolerance, where the slew reserve is 0, it
/// adds damping on the recent motion that removes the deficit, if possible within kDampingTime. The mean
/// square of the motion sets the damping: where the hand turns, less of its motion is along the average. The
/// damping is zero where the motion does not keep its direction, as in steps of a sensor: it would give
/// energy.
/// @param period T [s] @return whether it acted
bool control_passivity(const PassivityObserver& observer, double period, ForceCommand& tissue) noexcept;

}  // namespace palpate::haptics
