#pragma once

namespace palpate::validate {

/// Closed-form solutions for an elastic half-space, for comparison. E* = E/(1 - nu^2) [Pa] is the modulus
/// under a rigid indenter. Lengths in m, forces in N; [any].

/// Force of a rigid ball at `depth` >= 0: 4/3 E* sqrt(R) depth^(3/2) [Johnson 1985, eq. 4.23]. The ball is
/// approximated by a paraboloid, so depth must be well below its radius.
[[nodiscard]] double hertz_force(double modulus, double radius, double depth) noexcept;

/// Radius of the contact circle: sqrt(R depth).
[[nodiscard]] double hertz_contact_radius(double radius, double depth) noexcept;

/// Displacement of the surface at distance r >= 0 from the axis [Johnson 1985, eq. 3.41a and 3.42a]. @param
/// contact_radius > 0
[[nodiscard]] double hertz_displacement(double depth, double contact_radius, double r) noexcept;

/// Displacement of the surface at distance r > 0 from a point load: F/(pi E* r) [Johnson 1985, eq. 3.22b].
[[nodiscard]] double boussinesq_displacement(double modulus, double force, double r) noexcept;

}  // namespace palpate::validate
