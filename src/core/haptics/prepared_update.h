#pragma once
#include "core/contact/inclusions.h"
#include "core/contact/tissue_laws.h"
#include "core/haptics/simulation.h"
#include "palpate/parameter_updates.h"

namespace palpate::haptics {

/// A parameter update with everything that a tick needs of it.
struct PreparedUpdate {
  ParameterUpdate values;
  contact::TissueLaws laws;
  contact::PlacedInclusion inclusion{};  // only with kInclusionChanged
  std::uint64_t not_before_tick = 0;     // the first tick that may take it
};

/// [setup] Checks a parameter update and prepares it for ticks. @throws ParameterError for a bad value;
/// InputError when the reference radius differs from the world's, for which its organ was prepared.
[[nodiscard]] PreparedUpdate prepare_update(const SimulationWorld& world, const ParameterUpdate& values);

/// [rt] Applies the update: from this tick on its tissue and noise are in force.
void apply_update(const SimulationWorld& world, SimulationState& state,
                  const PreparedUpdate& change) noexcept;

}  // namespace palpate::haptics
