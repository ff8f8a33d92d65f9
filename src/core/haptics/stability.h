#pragma once
#include <string>
#include <vector>

#include "palpate/inclusion.h"
#include "palpate/tissue.h"

namespace palpate::haptics {

/// Mechanical properties of a device.
struct DeviceMechanics {
  double damping = 0.0;     // b [N s/m], viscous
  double friction = 0.0;    // f_c [N], Coulomb
  double resolution = 0.0;  // Delta [m], of the position sensors
};

/// Sampled wall condition of a tissue on a device.
struct StabilityCheck {
  // K [N/m] at the device: scale x the larger of k_t and the largest tangent stiffness within reach
  double stiffness = 0.0;
  double virtual_damping = 0.0;  // B [N s/m] at the device
  double damping_needed = 0.0;   // K T / 2 + |B| [N s/m]  [Colgate, Schenkel 1997]
  double stiffness_allowed =
      0.0;                      // 2 f_c / Delta [N/m]; infinite with perfect sensors  [Abbott, Okamura 2005]
  bool damping_short = false;   // b < damping_needed
  bool friction_short = false;  // K > stiffness_allowed
  [[nodiscard]] bool warns() const noexcept { return damping_short || friction_short; }
};

/// Largest depth [m] within reach; the built-in tissues are specified up to this depth.
inline constexpr double kDepthWithinReach = 15e-3;

/// [setup] Checks whether a device can display a tissue without oscillation. Within reach are depths up to
/// kDepthWithinReach whose force is at most max_force.
/// @param period T [s] @param max_force of the gate [N] @param scale workspace scale: the hand feels the
/// stiffness times it
/// @param variation largest ratio of the stiffness to the uniform tissue's (stiffness_ratio_of)
/// @throws ParameterError for a bad tissue or period, as the law does
[[nodiscard]] StabilityCheck check_stability(const model::TissueParameters& tissue,
                                             model::Direction direction, double period, double max_force,
                                             double scale, const DeviceMechanics& device,
                                             double variation = 1.0);

/// [setup] How many times as stiff as the uniform tissue the tissue above an inclusion gets within reach.
/// @param depth of the inclusion's centre below the surface [m] @param tip_radius of the tool [m]
[[nodiscard]] double stiffness_ratio_of(const model::TissueParameters& tissue, model::Direction direction,
                                        double period, const model::Inclusion& inclusion, double depth,
                                        double tip_radius);

/// [setup] The smallest depth [m] at which a tissue's tangent stiffness exceeds `stiffness` [N/m]; infinite
/// if none within reach.
[[nodiscard]] double depth_of_tangent(const model::TissueParameters& tissue, model::Direction direction,
                                      double period, double stiffness);

/// [setup] The warnings of a check, one sentence each; empty when it passes.
[[nodiscard]] std::vector<std::string> stability_warnings(const StabilityCheck& check,
                                                          const DeviceMechanics& device);

}  // namespace palpate::haptics
