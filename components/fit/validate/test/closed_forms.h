#pragma once
#include <cmath>
#include <numbers>

namespace palpate::validate {

/// Closed-form solutions for an elastic half-space. E* = E/(1 - nu^2) [Pa] is the modulus under a rigid
/// indenter. Lengths in m, forces in N.

/// Force of a rigid ball at `depth` >= 0: 4/3 E* sqrt(R) depth^(3/2) [Johnson 1985, eq. 4.23]. The ball is
/// approximated by a paraboloid, so depth must be well below its radius.
inline double hertz_force(double modulus, double radius, double depth) {
  return 4.0 / 3.0 * modulus * std::sqrt(radius) * depth * std::sqrt(depth);
}

/// Radius of the contact circle: sqrt(R depth).
inline double hertz_contact_radius(double radius, double depth) { return std::sqrt(radius * depth); }

/// Displacement of the surface at distance r > 0 from a point load: F/(pi E* r) [Johnson 1985, eq. 3.22b].
inline double boussinesq_displacement(double modulus, double force, double r) {
  return force / (std::numbers::pi * modulus * r);
}

}  // namespace palpate::validate
