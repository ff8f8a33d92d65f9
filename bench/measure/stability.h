#pragma once
#include <vector>

#include "core/haptics/simulation.h"
#include "core/haptics/stability.h"
#include "palpate/scene.h"

// Stability of a pressed tissue under an emulated hand, for docs/safety.md.
namespace palpate::bench {

/// [setup] A tissue of constant stiffness K [N/m] without friction: the virtual wall of the stability
/// condition.
[[nodiscard]] model::TissueParameters linear_tissue(double stiffness);

/// One device, grip and tissue.
struct StabilityCase {
  model::TissueParameters tissue;
  double rate_Hz = 1000.0;          // loop rate
  haptics::DeviceMechanics device;  // damping, friction, resolution
  scene::HandGrip grip;
};

/// Result of a case: press to the equilibrium of hand and tissue, hold for 2 s, release. The equilibrium is
/// at kDepthWithinReach, or at the force kMaxHoldForce if that comes first.
struct StabilityResult {
  double stiffness = 0.0;     // N/m, tangent stiffness at the equilibrium
  double force = 0.0;         // N, mean commanded force in the last second of the hold
  double depth = 0.0;         // m, mean in the last second of the hold
  double peak_to_peak = 0.0;  // m, true position of the hand in the last second of the hold, largest of the
                              // axes
  /// J, largest energy that the device had given to the hand beyond what it had received, at any time of the
  /// run. Integrated in the hand model's own time steps.
  double given_beyond_taken = 0.0;
  double observed_deficit = 0.0;  // J, the deficit as the loop's passivity observer measures it by the
                                  // encoder
  double most_in_a_tick = 0.0;    // J, largest energy exchanged in one tick
  bool controlled = false;        // the passivity controller acted at some tick
  haptics::StabilityCheck check;  // the check before such a run
  bool faulted = false;           // a fault was latched: the other values are invalid
};

/// The bound of docs/safety.md for given_beyond_taken [J].
[[nodiscard]] double energy_bound(const StabilityResult& result) noexcept;

/// A hold is still when the hand's position stays within this range in its last second.
inline constexpr double kStillHold = 0.05e-3;  // m

inline constexpr double kMaxHoldForce =
    4.0;  // N: reaches 15 mm in every built-in tissue, and is a moderate force for a hand

/// [setup] A flat block of tissue under a 5 mm ball in an emulated hand, without touch noise, so that any
/// vibration comes from the loop. One world for all cases of that tissue and rate.
class StabilityBlock final {
 public:
  /// @throws ParameterError for invalid tissue.
  StabilityBlock(const model::TissueParameters& tissue, double rate_Hz, const contact::Preparation& how = {});

  /// [setup] Presses, holds and releases, offline. @param the_case with this block's tissue and rate @throws
  /// ParameterError when a value of device or grip is out of range.
  [[nodiscard]] StabilityResult run(const StabilityCase& the_case) const;

 private:
  scene::Scene scene_;
  haptics::SimulationWorld world_;
  double depth_at_hold_;      // m
  double force_at_hold_;      // N
  double stiffness_at_hold_;  // N/m
};

/// [setup] Cases of the sweep with built-in tissues, each at 1 and 4 kHz: damping 0.5 to 5 N s/m, friction 0
/// to 0.2 N, light, middle and firm grip, encoder 0.01 mm; sorted by tissue.
[[nodiscard]] std::vector<StabilityCase> tissue_cases();

/// [setup] Cases of the sweep with linear tissues of 250 N/m to 32 kN/m, far stiffer than any organ, and
/// devices of 0.1 to 10 N s/m: they show where vibration begins, and where the check warns.
[[nodiscard]] std::vector<StabilityCase> wall_cases();

}  // namespace palpate::bench
