#include "core/haptics/passivity.h"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {
namespace {

/// Removes the component of `force` that adds energy along `way`.
void remove_along(Vec3& force, const Vec3& way) noexcept {
  const double square = way.squaredNorm();
  const double giving = force.dot(way);
  if (square > 0.0 && giving > 0.0) force -= giving / square * way;
}

}  // namespace

void observe_tissue(PassivityObserver& observer, const ForceCommand& written, const Vec3& noise,
                    const DeviceMotion& relative) noexcept {
  const double given = written.force.dot(relative.translation) - noise.dot(relative.translation) +
                       written.torque.dot(relative.rotation);
  observer.tissue -= given;
  observer.largest_tick = std::max(observer.largest_tick, std::abs(given));
}

void observe_noise(PassivityObserver& observer, const Vec3& noise, const DeviceMotion& motion,
                   double period) noexcept {
  const double given = noise.dot(motion.translation);
  observer.noise += given;
  observer.noise_excess = std::max(0.0, observer.noise_excess + given - kNoisePower * period);
}

double noise_scale(const PassivityObserver& observer) noexcept {
  return std::clamp(2.0 - observer.noise_excess / kNoiseEnergy, 0.0, 1.0);
}

void reset_surplus(PassivityObserver& observer) noexcept {
  observer.tissue = std::min(observer.tissue, 0.0);
  if (observer.tissue >= -kEnergyTolerance) observer.largest_tick = 0.0;
}

void average_motion(PassivityObserver& observer, const DeviceMotion& relative, double period) noexcept {
  const double weight = std::min(1.0, period / kMotionMemory);
  DeviceMotion& recent = observer.recent;
  observer.way_kept += weight * (relative.translation.dot(recent.translation) - observer.way_kept);
  observer.turn_kept += weight * (relative.rotation.dot(recent.rotation) - observer.turn_kept);
  recent.translation += weight * (relative.translation - recent.translation);
  recent.rotation += weight * (relative.rotation - recent.rotation);
  observer.way += weight * (relative.translation.squaredNorm() - observer.way);
  observer.turn += weight * (relative.rotation.squaredNorm() - observer.turn);
  constexpr double kStill = 1e-30;  // m^2 or rad^2: the tail of an average is no motion
  if (recent.translation.squaredNorm() < kStill) recent.translation = Vec3::Zero();
  if (recent.rotation.squaredNorm() < kStill) recent.rotation = Vec3::Zero();
}

void observe_control(PassivityObserver& observer, bool acted, double period) noexcept {
  observer.damped_share +=
      ((acted ? 1.0 : 0.0) - observer.damped_share) * std::min(1.0, period / kDampedMemory);
}

bool is_unstable(const PassivityObserver& observer) noexcept {
  const double bound = kEnergyTolerance + 2.0 * observer.largest_tick;
  return observer.damped_share > kUnstableShare || -observer.tissue > bound + kUnstableEnergy;
}

void reset_deficit(PassivityObserver& observer) noexcept {
  observer.tissue = std::max(observer.tissue, 0.0);
  observer.largest_tick = 0.0;
  observer.damped_share = 0.0;
}

SlewReserve slew_reserve(const PassivityObserver& observer, double slew, double torque_slew) noexcept {
  const double energy = std::max(observer.tissue + kEnergyTolerance, 0.0);
  return {std::sqrt(energy * slew / kReserveSpeed), std::sqrt(energy * torque_slew / kReserveAngularSpeed)};
}

void remove_giving(const DeviceMotion& relative, ForceCommand& tissue) noexcept {
  remove_along(tissue.force, relative.translation);
  remove_along(tissue.torque, relative.rotation);
}

bool control_passivity(const PassivityObserver& observer, double period, ForceCommand& tissue) noexcept {
  const double deficit = -observer.tissue;
  if (!(deficit > kEnergyTolerance)) return false;
  // A damper b dissipates b v^2 T = b way^2 / T per tick. Translation and rotation are each set to dissipate
  // the whole deficit.
  const double share = std::min(1.0, period / kDampingTime) * deficit * period;
  const DeviceMotion& recent = observer.recent;
  if (observer.way_kept > 0.0) {
    tissue.force -= std::min(kMaxDamping, share / observer.way) / period * recent.translation;
  }
  if (observer.turn_kept > 0.0) {
    tissue.torque -= std::min(kMaxAngularDamping, share / observer.turn) / period * recent.rotation;
  }
  return true;
}

}  // namespace palpate::haptics
