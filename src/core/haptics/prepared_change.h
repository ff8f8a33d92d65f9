#pragma once
#include "core/contact/tissue_laws.h"
#include "core/haptics/simulation.h"
#include "palpate/live_changes.h"

namespace palpate::haptics {

/// A parameter update with everything that a tick needs of it.
struct PreparedChange {
  LiveChange values;
  contact::TissueLaws laws;
};

/// [setup] Checks a parameter update and prepares it for ticks. @throws ParameterError for a bad value;
/// InputError when the reference radius differs from the world's, for which its organ was prepared.
[[nodiscard]] PreparedChange prepare_change(const SimulationWorld& world, const LiveChange& values);

/// [rt] Applies the update: from this tick on its tissue and noise are in force.
void apply_change(const SimulationWorld& world, SimulationState& state,
                  const PreparedChange& change) noexcept;

}  // namespace palpate::haptics
