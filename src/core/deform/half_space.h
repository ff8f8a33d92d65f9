#pragma once
#include <Eigen/Core>

#include "palpate/pose.h"

namespace palpate::deform {

/// Poisson's ratio of tissue in the response of a whole organ. Fields whose depth at the contact is given
/// differ by at most 0.7 % between 0.40 and 0.49.
inline constexpr double kPoisson = 0.45;

/// Displacement of the surface of an elastic half-space (Young's modulus 1) around a round contact of radius
/// a, under a unit force that is spread as Hertz's pressure (closed forms: Johnson 1985, chapter 3).
/// With e the unit vector from the contact, z the inward normal and f the force:
///
///     u = 2 psi f_t - 2 nu ((psi + 2 t) (e f_t) e - t f_t) + (1 - 2 nu) s ((e f_t) z - f_z e)
///         + 2 (1 - nu) psi f_z z,   all divided by 4 pi G.
struct HalfSpaceTerms {
  double psi = 0.0;  // potential of the pressure [1/m]
  double s = 0.0;    // derivative of its integral along z, by r [1/m]
  double t = 0.0;    // [1/m]
};

/// [any] Terms at a distance r [m] from the middle of the contact. @param a radius of the contact [m], > 0
[[nodiscard]] HalfSpaceTerms half_space_terms(double r, double a) noexcept;

/// [any] Displacement [m/N at Young's modulus 1] by these terms.
/// @param e unit vector in the surface, away from the contact; zero at the middle
/// @param inward unit normal @param force any vector
[[nodiscard]] Vec3 half_space_displacement(const HalfSpaceTerms& terms, const Vec3& e, const Vec3& inward,
                                           const Vec3& force) noexcept;

/// [any] Radius a [m] of the contact of a rigid ball of radius R [m] that is pressed into a half-space to the
/// depth D [m]: D = a artanh(a/R) (Sneddon 1965). Below R at any depth.
[[nodiscard]] double ball_contact_radius(double tip_radius, double depth) noexcept;

}  // namespace palpate::deform
