#pragma once
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/model/relaxation.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::contact {

/// What ticks need of a tissue: its laws, its relaxation and its contact parameters. Plain data without
/// pointers, so a running loop can take another one (palpate/parameter_updates.h).
struct TissueLaws {
  /// The stiffest layer [N/m] that a force within reach may meet: a double still resolves its width.
  static constexpr double kStiffestLayer = 1e12;
  static constexpr double kForceWithinReach = 50.0;  // N, the largest limit of a gate
  static constexpr double kLargestForce = 1e30;      // N; layers of a tissue are not that unlike

  /// [setup] @param loop_period T [s] @throws ParameterError as the law and model::validate() do, and for a
  /// beta that makes a layer within reach stiffer than kStiffestLayer, or the law's force larger than
  /// kLargestForce
  TissueLaws(const model::TissueParameters& tissue, double loop_period)
      : press(tissue, model::Direction::kPress, loop_period),
        pull(tissue, model::Direction::kPull, loop_period),
        relaxation(tissue.relaxation, loop_period),
        tangential_stiffness(tissue.tangential_stiffness()),
        tangential_damping(tissue.contact.tangential_damping),
        friction(tissue.contact.friction),
        damping(tissue.contact.damping),
        grip_limit(tissue.contact.grip_limit),
        size_exponent(tissue.size_exponent),
        source_radius(tissue.source ? tissue.source->radius : 0.0) {
    for (const model::SpringLaw* law : {&press, &pull}) {
      constexpr double kJustBelow = 1.0 - 1e-12;  // at the law's largest force its tangent is zero
      const double force = std::min(kForceWithinReach, kJustBelow * law->max_force());
      if (std::isfinite(law->max_force()) && law->max_force() > kLargestForce) {
        throw ParameterError("beta", tissue.beta, "large enough that the law's force stays below 1e30 N");
      }
      if (law->deformation_under(force).stiffness <= kStiffestLayer && !ends_in_rigid_layer(tissue, *law)) {
        continue;
      }
      throw ParameterError("beta", tissue.beta, "large enough that no layer within 50 N exceeds 1e12 N/m");
    }
  }

  model::SpringLaw press;
  model::SpringLaw pull;
  model::Relaxation relaxation;
  double tangential_stiffness;  // k_t [N/m]
  double tangential_damping;    // c_t [N s/m]
  double friction;              // mu
  double damping;               // b [N s/m]
  double grip_limit;            // N
  double size_exponent;         // a valid tissue has one only with a source_radius
  double source_radius;         // m

  /// [rt] Factor of both laws' forces for a tool of this tip radius [m].
  [[nodiscard]] double size_factor(double tip_radius) const noexcept {
    return model::size_factor(size_exponent, source_radius, tip_radius);
  }

 private:
  /// Whether the law's layers end within reach because the next one is too stiff for a number.
  [[nodiscard]] static bool ends_in_rigid_layer(const model::TissueParameters& tissue,
                                                const model::SpringLaw& law) noexcept {
    constexpr double kLargestExponent = 709.78;  // of e, for a finite number
    return law.layers_allowed() / tissue.beta > kLargestExponent && law.max_force() < kForceWithinReach;
  }
};
static_assert(std::is_trivially_copyable_v<TissueLaws>, "a tick copies it without memory of its own");

}  // namespace palpate::contact
