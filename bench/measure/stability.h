#pragma once
#include <span>
#include <string>
#include <vector>

#include "palpate/haptics/simulation.h"
#include "palpate/haptics/stability.h"
#include "palpate/scene/setup.h"

// Whether a pressed tissue lies still under an emulated hand: what docs/safety.md says of stability.
namespace palpate::bench {

/// One device in one hand on one tissue.
struct StabilityCase {
  std::string tissue;               // a built-in name
  double rate_Hz = 1000.0;          // of the loop
  haptics::DeviceMechanics device;  // damping, friction, resolution
  scene::HandGrip grip;
};

/// What a case did: pressed to where hand and tissue balance at kDepthWithinReach, held for 2 s, let go.
struct StabilityResult {
  double force = 0.0;         // N, mean of the hold's last second, what was written
  double depth = 0.0;         // m, mean of the hold's last second
  double peak_to_peak = 0.0;  // m, the hand's true place in the hold's last second, the largest of the axes
  /// J, over the whole way in and out again: the most that the device had given to the hand beyond what it
  /// had taken, at any time. Integrated by the hand itself, in its own steps.
  double given_beyond_taken = 0.0;
  bool controlled = false;  // the passivity controller acted at some tick
  bool warned = false;      // haptics::check_stability warns
  bool faulted = false;     // a fault was latched: nothing of the above counts
};

/// The goal: a hold is still when the hand's place stays within so much in its last second.
inline constexpr double kStillHold = 0.05e-3;  // m

/// [setup] A flat block of a tissue under a 5 mm ball in an emulated hand, without touch noise: what trembles
/// is the loop. One world for all cases of that tissue and rate.
class StabilityBlock final {
 public:
  /// @throws InputError when the tissue is not built in.
  StabilityBlock(const std::string& tissue, double rate_Hz);

  /// [setup] Presses, holds and lets go, offline. @param the_case of this block's tissue and rate
  /// @throws ParameterError when a figure of the device or grip is out of its range.
  [[nodiscard]] StabilityResult run(const StabilityCase& the_case) const;

 private:
  scene::Setup setup_;
  haptics::SimulationWorld world_;
  double force_at_hold_;  // N
};

/// [setup] The whole sweep: every built-in tissue at 1 and 4 kHz, damping 0.5 to 5 N s/m, friction 0 to 0.2
/// N, light, middle and firm grip, encoder 0.01 mm; tissue by tissue.
[[nodiscard]] std::vector<StabilityCase> stability_cases();

}  // namespace palpate::bench
