#include "core/haptics/passivity.h"

#include <algorithm>

namespace palpate::haptics {
namespace {

/// Removes the component of `force` that adds energy along `way`, and adds a damper. @param damping [N s/m]
void brake(Vec3& force, const Vec3& way, double damping, double period) noexcept {
  const double square = way.squaredNorm();
  if (!(square > 0.0)) return;
  const double giving = force.dot(way);
  if (giving > 0.0) force -= giving / square * way;
  force -= damping / period * way;
}

}  // namespace

void observe_tissue(PassivityObserver& observer, const ForceCommand& written, const Vec3& noise,
                    const DeviceMotion& relative) noexcept {
  observer.tissue -= written.force.dot(relative.translation) - noise.dot(relative.translation) +
                     written.torque.dot(relative.rotation);
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

void reset_surplus(PassivityObserver& observer) noexcept { observer.tissue = std::min(observer.tissue, 0.0); }

bool control_passivity(const PassivityObserver& observer, const DeviceMotion& relative, double period,
                       ForceCommand& tissue) noexcept {
  const double deficit = -observer.tissue;
  if (!(deficit > kEnergyTolerance)) return false;
  // A damper b dissipates b v^2 T = b way^2 / T per tick. Translation and rotation are each set to dissipate
  // the whole deficit.
  const double way = relative.translation.squaredNorm();
  const double turn = relative.rotation.squaredNorm();
  if (way > 0.0) {
    brake(tissue.force, relative.translation, std::min(kMaxDamping, deficit * period / way), period);
  }
  if (turn > 0.0) {
    brake(tissue.torque, relative.rotation, std::min(kMaxAngularDamping, deficit * period / turn), period);
  }
  return true;
}

}  // namespace palpate::haptics
