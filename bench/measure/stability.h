#pragma once
#include <vector>

#include "core/haptics/simulation.h"
#include "core/haptics/stability.h"
#include "palpate/scene.h"

// Whether a pressed tissue lies still under an emulated hand: what docs/safety.md says of stability.
namespace palpate::bench {

/// [setup] A tissue with one stiffness K [N/m] as far as it is pressed, without friction: the wall of the
/// stability check's own theory.
[[nodiscard]] model::TissueParameters linear_tissue(double stiffness);

/// One device in one hand on one tissue.
struct StabilityCase {
  model::TissueParameters tissue;
  double rate_Hz = 1000.0;          // of the loop
  haptics::DeviceMechanics device;  // damping, friction, resolution
  scene::HandGrip grip;
};

/// What a case did: pressed to where hand and tissue balance, held for 2 s, let go. The balance is at
/// kDepthWithinReach, or where the force is kMostHoldForce if that comes first.
struct StabilityResult {
  double stiffness = 0.0;     // N/m, the tangent there
  double force = 0.0;         // N, mean of the hold's last second, what was written
  double depth = 0.0;         // m, mean of the hold's last second
  double peak_to_peak = 0.0;  // m, the hand's true place in the hold's last second, the largest of the axes
  /// J, over the whole way in and out again: the most that the device had given to the hand beyond what it
  /// had taken, at any time. Integrated by the hand itself, in its own steps.
  double given_beyond_taken = 0.0;
  double observed_deficit = 0.0;  // J, the same as the loop's energy observer saw it, by the encoder
  double most_in_a_tick = 0.0;    // J, the most that device and hand exchanged in one tick
  bool controlled = false;        // the passivity controller acted at some tick
  haptics::StabilityCheck check;  // what is told before such a run
  bool faulted = false;           // a fault was latched: nothing of the above counts
};

/// What docs/safety.md promises that given_beyond_taken stays within [J].
[[nodiscard]] double energy_bound(const StabilityResult& result) noexcept;

/// The goal: a hold is still when the hand's place stays within so much in its last second.
inline constexpr double kStillHold = 0.05e-3;  // m

inline constexpr double kMostHoldForce =
    4.0;  // N: every built-in tissue to 15 mm, and a wall before a hand tires

/// [setup] A flat block of a tissue under a 5 mm ball in an emulated hand, without touch noise: what trembles
/// is the loop. One world for all cases of that tissue and rate.
class StabilityBlock final {
 public:
  /// @throws ParameterError for a bad tissue.
  StabilityBlock(const model::TissueParameters& tissue, double rate_Hz);

  /// [setup] Presses, holds and lets go, offline. @param the_case of this block's tissue and rate
  /// @throws ParameterError when a figure of the device or grip is out of its range.
  [[nodiscard]] StabilityResult run(const StabilityCase& the_case) const;

 private:
  scene::Setup setup_;
  haptics::SimulationWorld world_;
  double depth_at_hold_;      // m
  double force_at_hold_;      // N
  double stiffness_at_hold_;  // N/m
};

/// [setup] The first half of the sweep: every built-in tissue at 1 and 4 kHz, damping 0.5 to 5 N s/m,
/// friction 0 to 0.2 N, light, middle and firm grip, encoder 0.01 mm; tissue by tissue.
[[nodiscard]] std::vector<StabilityCase> tissue_cases();

/// [setup] The second half: linear tissues of 250 N/m to 32 kN/m, far stiffer than any organ, under devices
/// of 0.1 to 10 N s/m: where trembling begins, and where the check warns of it.
[[nodiscard]] std::vector<StabilityCase> wall_cases();

}  // namespace palpate::bench
