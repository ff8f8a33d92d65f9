#pragma once
#include <numbers>
#include <type_traits>

#include <Eigen/Core>

#include "palpate/pose.h"

namespace palpate::deform {

/// Poisson's ratio of tissue in the response of a whole organ. Fields whose depth at the contact is given
/// differ by at most 0.7 % between 0.40 and 0.49.
inline constexpr double kPoisson = 0.45;

/// Displacement of the surface of an elastic half-space (Young's modulus 1) around a round contact of radius
/// a, under a unit force that is spread as Hertz's pressure (closed forms: Johnson 1985, chapter 3).
/// With e the unit vector from the contact, z the inward normal and f = f_z z + f_t the force:
///
///     u = 2 psi f_t - 2 nu ((psi + 2 t) (e f_t) e - t f_t) + (1 - 2 nu) s ((e f_t) z - f_z e)
///         + 2 (1 - nu) psi f_z z,   all divided by 4 pi G.
template <typename Scalar = double>
struct HalfSpaceTerms {
  Scalar psi{};  // potential of the pressure [1/m]
  Scalar s{};    // derivative of its integral along z, by r [1/m]
  Scalar t{};    // [1/m]
};

/// 4 pi G at Young's modulus 1.
inline constexpr double kHalfSpaceModulus = 4.0 * std::numbers::pi / (2.0 * (1.0 + kPoisson));

/// [any] Terms at a distance r [m] from the middle of the contact. @param a radius of the contact [m], > 0
[[nodiscard]] HalfSpaceTerms<> half_space_terms(double r, double a) noexcept;

inline double dot(const Vec3& a, const Vec3& b) noexcept { return a.dot(b); }

/// [any] A number in all lanes.
template <typename Scalar>
[[nodiscard]] Scalar lanes_with(double number) noexcept {
  if constexpr (std::is_floating_point_v<Scalar>) {
    return static_cast<Scalar>(number);
  } else {
    return Scalar(static_cast<float>(number));
  }
}

/// [any] Displacement by these terms [m/N at Young's modulus 1], not yet divided by 4 pi G. Vectors need
/// dot().
/// @param e in the surface, away from the contact, unit; zero at the middle @param inward unit normal
/// @param normal part of the force along `inward`
template <typename Scalar, typename Vector>
[[nodiscard]] Vector half_space_displacement(const HalfSpaceTerms<Scalar>& terms, const Vector& e,
                                             const Vector& inward, const Scalar& normal) noexcept {
  const auto times = [&normal](double x) { return lanes_with<Scalar>(x) * normal; };
  return (times(2.0 * (1.0 - kPoisson)) * terms.psi) * inward - (times(1.0 - 2.0 * kPoisson) * terms.s) * e;
}

/// [any] The same under a force that has a part `side` along the surface, too.
template <typename Scalar, typename Vector>
[[nodiscard]] Vector half_space_displacement(const HalfSpaceTerms<Scalar>& terms, const Vector& e,
                                             const Vector& inward, const Scalar& normal,
                                             const Vector& side) noexcept {
  const auto number = lanes_with<Scalar>;
  const Scalar along = dot(e, side);
  const Vector pressed = half_space_displacement(terms, e, inward, normal);
  return pressed + (number(1.0 - 2.0 * kPoisson) * terms.s * along) * inward -
         (number(2.0 * kPoisson) * (terms.psi + terms.t + terms.t) * along) * e +
         (number(2.0) * terms.psi + number(2.0 * kPoisson) * terms.t) * side;
}

/// Radius of a pulled contact, times the tool's: what a tool holds moves as one, and the dent of such a
/// contact is as flat there.
inline constexpr double kHeldWide = 1.5;

/// [any] Hertz's pressure at a distance r [m] from the middle of a round contact of radius a [m], under a
/// unit force [1/m^2].
[[nodiscard]] double contact_pressure(double r, double a) noexcept;

/// [any] Depth of the middle of a contact of radius a [m] under a unit force along the normal [m/N at Young's
/// modulus 1].
[[nodiscard]] double half_space_depth(double a) noexcept;

/// [any] Radius a [m] of the contact of a rigid ball of radius R [m] that is pressed into a half-space to the
/// depth D [m]: D = a artanh(a/R) (Sneddon 1965). Below R at any depth.
[[nodiscard]] double ball_contact_radius(double tip_radius, double depth) noexcept;

}  // namespace palpate::deform
