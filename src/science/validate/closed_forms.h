#pragma once

namespace palpate::validate {

/// Closed forms of an elastic half-space, for comparison. Its modulus E* = E/(1 - nu^2) [Pa] is that under a
/// rigid tool. All lengths in m, forces in N; [any].

/// Force of a rigid ball pressed to `depth` >= 0: 4/3 E* sqrt(R) depth^(3/2) [Johnson 1985, eq. 4.23]. The
/// ball counts as a parabola, so this holds for depths well below its radius.
[[nodiscard]] double hertz_force(double modulus, double radius, double depth) noexcept;

/// Radius of the circle in which they touch: sqrt(R depth).
[[nodiscard]] double hertz_contact_radius(double radius, double depth) noexcept;

/// How far the surface gives way at distance r >= 0 from the axis [Johnson 1985, eq. 3.41a and 3.42a].
/// @param contact_radius > 0
[[nodiscard]] double hertz_displacement(double depth, double contact_radius, double r) noexcept;

/// How far the surface gives way at distance r > 0 from a point load: F/(pi E* r) [Johnson 1985, eq. 3.22b].
[[nodiscard]] double boussinesq_displacement(double modulus, double force, double r) noexcept;

}  // namespace palpate::validate
