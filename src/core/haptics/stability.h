#pragma once
#include <string>
#include <vector>

#include "palpate/device.h"
#include "palpate/spring_law.h"
#include "palpate/tissue.h"

namespace palpate::haptics {

/// Mechanical properties of a device.
struct DeviceMechanics {
  double damping = 0.0;     // b [N s/m], viscous
  double friction = 0.0;    // f_c [N], Coulomb
  double resolution = 0.0;  // Delta [m], of the position sensors
  double mass = 0.0;        // m [kg], of the moving parts and the hand; 0: unknown
};

/// The loop that displays a tissue.
struct StabilityLoop {
  model::Direction direction = model::Direction::kPress;
  double period = 1e-3;     // T [s]
  double max_force = 20.0;  // N, of the gate
  double scale = 1.0;       // workspace scale times force scale: the hand feels the stiffness times it
  // Largest stiffness over the uniform tissue's (contact::largest_stiffness)
  double variation = 1.0;
  double slew = DeviceAbilities::kUnknown;  // N/s, of the gate
};

/// Sampled wall condition of a tissue on a device.
struct StabilityCheck {
  // K [N/m] at the device: scale x the larger of k_t and the largest stiffness within reach
  double stiffness = 0.0;
  double virtual_damping = 0.0;  // B [N s/m] at the device
  double damping_needed = 0.0;   // K T / 2 + |B| [N s/m]  [Colgate, Schenkel 1997]
  // 2 f_c / Delta [N/m]; infinite with perfect sensors  [Abbott, Okamura 2005]
  double stiffness_allowed = 0.0;
  double stiffness_by_slew = 0.0;  // N/m, what the slew limit lets the hand feel (slew_reserve)
  bool damping_short = false;      // b < damping_needed
  bool friction_short = false;     // K > stiffness_allowed
  // The mass oscillates in the sampled loop of tissue and passivity controller.
  bool mass_short = false;
  bool slew_short = false;  // K > stiffness_by_slew
  [[nodiscard]] bool warns() const noexcept { return damping_short || friction_short || mass_short; }
};

/// Largest depth [m] within reach; the built-in tissues are specified up to this depth.
inline constexpr double kDepthWithinReach = 15e-3;

/// [setup] Checks whether a device can display a tissue without oscillation. Within reach are depths up to
/// kDepthWithinReach whose force is at most max_force.
/// @throws ParameterError for a bad tissue or period, as the law does
[[nodiscard]] StabilityCheck check_stability(const model::TissueParameters& tissue, const StabilityLoop& loop,
                                             const DeviceMechanics& device);

/// [setup] The smallest depth [m] at which a tissue's tangent stiffness exceeds `stiffness` [N/m]; infinite
/// if none within reach.
[[nodiscard]] double depth_of_tangent(const model::TissueParameters& tissue, model::Direction direction,
                                      double period, double stiffness);

/// [setup] The warnings of a check, one sentence each; empty when it passes.
[[nodiscard]] std::vector<std::string> stability_warnings(const StabilityCheck& check,
                                                          const DeviceMechanics& device);

/// [setup] The sentence of a tissue that the slew limit holds back; empty when it does not. It needs no
/// mechanics of the device.
[[nodiscard]] std::string slew_note(const StabilityCheck& check);

}  // namespace palpate::haptics
