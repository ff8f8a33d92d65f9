#pragma once
#include "core/haptics/simulation.h"

namespace palpate::haptics {

/// [setup] Runs ticks whose results are discarded, so that the first tick of a run finds the code, the laws
/// and the organ in the processor's caches. The thread of the run calls it. `state` is the same afterwards.
void warm_up(const SimulationWorld& world, SimulationState& state);

}  // namespace palpate::haptics
