#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/pose.h"

namespace palpate::model {

/// A sphere in the tissue of another stiffness: a nodule, a cyst, a stone, a vessel (docs/lumps.md). Organ
/// frame S.
struct Inclusion {
  Vec3 centre_S = Vec3::Zero();       // [m]
  double radius = 5e-3;               // a [m]
  double ratio = 10.0;                // m, its Young's modulus divided by the tissue's
  double pulse = 0.0;                 // [m], how far it rises towards the surface with each heartbeat
  double pulse_period = 60.0 / 70.0;  // [s]

  bool operator==(const Inclusion&) const = default;
};

/// The factor of the tissue's stiffness at a point of the surface, organ frame.
struct StiffnessPoint {
  Vec3 point_S = Vec3::Zero();  // [m]
  double factor = 1.0;          // > 0
};

/// Where the tissue of an organ is not uniform.
struct TissueVariation {
  std::vector<Inclusion> inclusions;      // at most kMaxInclusions
  std::vector<StiffnessPoint> stiffness;  // empty: the factor is 1

  [[nodiscard]] bool empty() const noexcept { return inclusions.empty() && stiffness.empty(); }
};

inline constexpr std::size_t kMaxInclusions = 8;      // of one organ
inline constexpr double kSmallestInclusion = 0.5e-3;  // m, radius
inline constexpr double kLargestInclusion = 50e-3;    // m, radius
inline constexpr double kSoftestInclusion = 0.1;      // ratio: a cyst
inline constexpr double kStiffestInclusion = 100.0;   // ratio: a stone
inline constexpr double kSmallestFactor = 0.01;       // of a stiffness map
inline constexpr double kLargestFactor = 100.0;

inline constexpr std::size_t kMaxStiffnessPoints = 20000;
inline constexpr double kFarthestStiffnessPoint = 5e-3;  // m, from the surface

/// An inclusion that a scene names: its numbers, and the usual depth of its centre.
struct InclusionPreset {
  std::string_view name;
  Inclusion inclusion;  // its centre is not set
  double depth = 0.0;   // [m]
};

/// [any] nodule, stone, plaque, vessel and cyst; docs/lumps.md lists their sources.
[[nodiscard]] std::span<const InclusionPreset> inclusion_presets();

/// [setup] Checks the numbers of an inclusion. @throws ParameterError that names the first invalid field by
/// its key in a scene file (radius_mm, stiffness_ratio, pulse_mm, pulse_period_s), its value in that unit and
/// the valid range.
void validate(const Inclusion& inclusion);

/// [setup] Checks a point of a stiffness map: finite, with a factor from kSmallestFactor to kLargestFactor.
/// @param field name of the factor for messages @throws InputError, ParameterError for the factor
void validate(const StiffnessPoint& point, const std::string& field = "factor");

/// A round tip that is pressed into tissue: the radius c of its contact,
/// c^2 = R D / sqrt(1 + omega (D/R)^2), Hertz's at small depths.
class PressedTip final {
 public:
  /// [rt] @param radius R of the tip [m], > 0 @param depth D [m]; 0 or less: no contact
  PressedTip(double radius, double depth) noexcept;

  double square = 0.0;     // c^2 [m^2]
  double by_depth = 0.0;   // d(c^2)/dD [m]
  double radius = 0.0;     // c [m]
  double log_slope = 0.0;  // dc/dD / c [1/m]; 0 without contact
};

/// Law of one inclusion (docs/lumps.md). Tissue that is pressed to the depth D at the lateral distance s from
/// the inclusion has the energy U(D, s) = U_0(D) (1 + e(D, s^2)), with U_0 that of the uniform tissue. The
/// normal force is dU/dD and the lateral force -dU/ds, so no closed path gives energy. e = gamma(D) g(s, D):
///
///     gamma = (m - 1) X / (P + X),   X = A a^3 c / ((h^2 - a^2 + k c^2) (h^2 + k c^2)),
///     P = 1 + beta (1 + eta (a/h)^3) (m - 1),   g = (1 + s^2 / w^2)^-3,
///     w^2 = (1 - zeta (a/h)^3 (m - 1) / P) (kappa_1 h^2 + kappa_2 c^2).
///
/// X and g have the shape of the energy that a point load's stress has in a far inclusion. Just under the
/// skin, with a cover h - a much thinner than a, X grows as c / (h - a), which a stiff floor under a thin
/// layer gives, until c^2 is about a (h - a); then it is in proportion to a / c, as where the tip presses the
/// inclusion itself. The constants are fitted to finite elements (tools/update_lump_references).
class InclusionLaw final {
 public:
  /// e and its derivatives.
  struct Extra {
    double energy = 0.0;     // e
    double by_depth = 0.0;   // de/dD [1/m]
    double by_square = 0.0;  // de/d(s^2) [1/m^2]
  };

  /// A ratio of 1: e = 0.
  InclusionLaw() = default;
  /// [rt] @param radius a [m] @param depth h of the centre below the surface [m], >= a; a cover thinner than
  /// 1 % of a counts as that @param ratio m
  InclusionLaw(double radius, double depth, double ratio) noexcept;

  /// [rt] @param square s^2 [m^2], >= 0
  [[nodiscard]] Extra at(const PressedTip& tip, double square) const noexcept;

  /// e with its derivatives, and how e and de/dD change, to first order.
  struct Slopes {
    Extra here;
    double by_depth_and_square = 0.0;  // d(de/dD)/d(s^2)
    double by_depth_twice = 0.0;       // the change of de/dD to the deeper tip
    std::array<Extra, 3> by_law{};     // the changes of e and de/dD to the other laws; by_square is 0
  };
  /// [any] @param deeper the tip a little deeper @param others laws with a number a little larger
  [[nodiscard]] Slopes slopes(const PressedTip& tip, double square, const PressedTip& deeper,
                              const std::array<InclusionLaw, 3>& others) const noexcept;

 private:
  double strength_ = 0.0;          // A a^3 [m^3]
  double cover_ = 1.0;             // h^2 - a^2 [m^2]
  double depth_ = 1.0;             // h^2 [m^2]
  double width_ = 1.0;             // w^2 where c = 0 [m^2]
  double width_by_contact_ = 0.0;  // d(w^2)/d(c^2)
  double contrast_ = 0.0;          // m - 1
  double bound_ = 1.0;             // P
};

/// A factor of the tissue's energy, and its derivative by the factor before the cap.
struct CappedFactor {
  double value = 1.0;
  double slope = 1.0;
};

/// Factors up to this are not capped. One inclusion alone gives less, unless it is hard and its cover is
/// thinner than 6 % of its radius: then at most 10.8 before the cap.
inline constexpr double kUncappedFactor = 5.0;
/// The largest factor of any number of inclusions.
inline constexpr double kLargestEnergyFactor = 10.0;

/// [rt] Caps the product of the inclusions' factors 1 + e_j: several coincident hard inclusions are not
/// harder than their material. f up to f_0 = kUncappedFactor stays, bit for bit; above it
/// f_0 + (f_1 - f_0) tanh((f - f_0) / (f_1 - f_0)), with two continuous derivatives.
[[nodiscard]] CappedFactor cap_factor(double product) noexcept;

}  // namespace palpate::model
