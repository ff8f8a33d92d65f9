#pragma once
#include "core/haptics/simulation.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"
#include "run/realtime/tick_wait.h"

#include "bench/measure/account.h"

namespace palpate::bench {

/// [setup] Runs the scene in real time at its own rate, recorded, in turns of 0.25 s with an empty loop on
/// the same thread, to the end of the path. Both loops wait in the same way. A missed tick began a full
/// period or more late. @throws InputError when no temporary file can be made.
[[nodiscard]] LoopAccount compare_with_empty_loop(const scene::Scene& scene,
                                                  const haptics::SimulationWorld& world,
                                                  const scene::ToolPath& path, haptics::Waiting waiting,
                                                  const Watch& watch);

}  // namespace palpate::bench
