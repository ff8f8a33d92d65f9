#include "run/devices/hand_mass.h"

#include <cmath>

namespace palpate::devices {

void HandMass::advance(const Vec3& from, const Vec3& to, const Vec3& force, double period) noexcept {
  const HandMassParameters& p = parameters_;
  // Without the factor, rounding may give 21 steps for a period of 1 ms instead of 20.
  const int steps = static_cast<int>(std::ceil(period / kLongestStep * (1.0 - 1e-12)));
  const double h = period / steps;
  const double inertia = p.mass / h;
  const double resistance = inertia + p.damping + p.grip_damping + p.grip_stiffness * h;
  const Vec3 constant = force + p.grip_damping / period * (to - from);
  const Vec3 before = position_;
  for (int step = 1; step <= steps; ++step) {
    const Vec3 target = from + static_cast<double>(step) / steps * (to - from);
    const Vec3 push = inertia * velocity_ + constant + p.grip_stiffness * (target - position_);
    const double size = push.norm();
    if (size <= p.friction) {
      velocity_.setZero();
    } else {
      velocity_ = push * ((1.0 - p.friction / size) / resistance);
    }
    position_ += h * velocity_;
  }
  work_ += force.dot(position_ - before);
}

}  // namespace palpate::devices
