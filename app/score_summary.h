#pragma once
#include <iosfwd>
#include <memory>

#include "core/haptics/simulation.h"
#include "palpate/recording.h"
#include "science/palpation/score.h"

namespace palpate::app {

/// [setup] Scores a recording, with a progress bar. `world` receives the recording's world, which the result
/// refers to. @throws InputError as scene::make_world()
[[nodiscard]] palpation::Scorer score_of(const record::Recording& recording, bool no_cache,
                                         std::unique_ptr<haptics::SimulationWorld>& world);

/// [setup] Prints a score as text.
void print_score(std::ostream& out, const palpation::Score& score);

}  // namespace palpate::app
