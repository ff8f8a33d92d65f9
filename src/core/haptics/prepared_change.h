#pragma once
#include "core/contact/tissue_laws.h"
#include "core/haptics/simulation.h"
#include "palpate/live_changes.h"

namespace palpate::haptics {

/// A change with all that a tick needs of it.
struct PreparedChange {
  LiveChange values;
  contact::TissueLaws laws;
};

/// [setup] Checks a change and works out what the ticks need of it. @throws ParameterError for a bad value,
/// InputError for another reference radius than the world's, for which its organ was prepared.
[[nodiscard]] PreparedChange prepare_change(const SimulationWorld& world, const LiveChange& values);

/// [rt] From this tick on the tissue and the noise are those of the change.
void apply_change(const SimulationWorld& world, SimulationState& state,
                  const PreparedChange& change) noexcept;

}  // namespace palpate::haptics
