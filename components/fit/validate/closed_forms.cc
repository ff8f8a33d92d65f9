#include "fit/validate/closed_forms.h"

#include <cmath>
#include <numbers>

namespace palpate::validate {

double hertz_force(double modulus, double radius, double depth) noexcept {
  return 4.0 / 3.0 * modulus * std::sqrt(radius) * depth * std::sqrt(depth);
}

double hertz_contact_radius(double radius, double depth) noexcept { return std::sqrt(radius * depth); }

double hertz_displacement(double depth, double contact_radius, double r) noexcept {
  const double x = r / contact_radius;
  if (x <= 1.0) return depth * (1.0 - 0.5 * x * x);
  return depth / std::numbers::pi * ((2.0 - x * x) * std::asin(1.0 / x) + std::sqrt(x * x - 1.0));
}

double boussinesq_displacement(double modulus, double force, double r) noexcept {
  return force / (std::numbers::pi * modulus * r);
}

}  // namespace palpate::validate
