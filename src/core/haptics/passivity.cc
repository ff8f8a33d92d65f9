#include "core/haptics/passivity.h"

#include <algorithm>

namespace palpate::haptics {
namespace {

/// `force` without what gives energy along `way`, and braking it. @param damping N s/m
void brake(Vec3& force, const Vec3& way, double damping, double period) noexcept {
  const double square = way.squaredNorm();
  if (!(square > 0.0)) return;
  const double giving = force.dot(way);
  if (giving > 0.0) force -= giving / square * way;
  force -= damping / period * way;
}

}  // namespace

void book(EnergyAccount& account, const ForceCommand& written, const Vec3& noise,
          const DeviceMotion& motion) noexcept {
  const double by_noise = noise.dot(motion.translation);
  account.noise += by_noise;
  account.tissue -= written.force.dot(motion.translation) - by_noise + written.torque.dot(motion.rotation);
}

void forgive_surplus(EnergyAccount& account) noexcept { account.tissue = std::min(account.tissue, 0.0); }

bool damp_deficit(const EnergyAccount& account, const DeviceMotion& motion, double period,
                  ForceCommand& tissue) noexcept {
  const double deficit = -account.tissue;
  if (!(deficit > kEnergyLeeway)) return false;
  // A damper b takes b v^2 T = b way^2 / T in a tick; both kinds of motion are asked for the whole deficit.
  const double way = motion.translation.squaredNorm();
  const double turn = motion.rotation.squaredNorm();
  if (way > 0.0) {
    brake(tissue.force, motion.translation, std::min(kMostDamping, deficit * period / way), period);
  }
  if (turn > 0.0) {
    brake(tissue.torque, motion.rotation, std::min(kMostAngularDamping, deficit * period / turn), period);
  }
  return true;
}

}  // namespace palpate::haptics
