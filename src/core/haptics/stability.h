#pragma once
#include <string>
#include <vector>

#include "palpate/tissue.h"

namespace palpate::haptics {

/// Mechanics of a device by itself.
struct DeviceMechanics {
  double damping = 0.0;     // b [N s/m], viscous
  double friction = 0.0;    // f_c [N], Coulomb
  double resolution = 0.0;  // Delta [m], of its position sensors
};

/// A tissue on a device: what the device would need to hold it still.
struct StabilityCheck {
  double stiffness = 0.0;        // K [N/m] at the device: the larger of k_t and the largest tangent within
                                 // reach, times the scale
  double virtual_damping = 0.0;  // B [N s/m] at the device
  double damping_needed = 0.0;   // K T / 2 + |B| [N s/m]  [Colgate, Schenkel 1997]
  double stiffness_allowed =
      0.0;                      // 2 f_c / Delta [N/m]; infinite with perfect sensors  [Abbott, Okamura 2005]
  bool damping_short = false;   // b < damping_needed
  bool friction_short = false;  // K > stiffness_allowed
  [[nodiscard]] bool warns() const noexcept { return damping_short || friction_short; }
};

/// Depth [m] that counts as within reach; the built-in tissues promise their figures to there.
inline constexpr double kDepthWithinReach = 15e-3;

/// [setup] Checks a tissue against a device. Within reach is a depth to kDepthWithinReach whose force the
/// gate lets through.
/// @param period T [s] @param max_force of the gate [N] @param scale of the workspace: the hand feels the
/// stiffness times it
/// @throws ParameterError for a bad tissue or period, as the law does
[[nodiscard]] StabilityCheck check_stability(const model::TissueParameters& tissue,
                                             model::Direction direction, double period, double max_force,
                                             double scale, const DeviceMechanics& device);

/// [setup] Depth [m] from which on a tissue's tangent is more than `stiffness` [N/m]; infinite: nowhere
/// within reach.
[[nodiscard]] double depth_of_tangent(const model::TissueParameters& tissue, model::Direction direction,
                                      double period, double stiffness);

/// [setup] The same in words, one sentence a finding; empty: the check does not warn.
[[nodiscard]] std::vector<std::string> stability_warnings(const StabilityCheck& check,
                                                          const DeviceMechanics& device);

}  // namespace palpate::haptics
