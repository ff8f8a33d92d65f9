#pragma once
#include <cstddef>

#include "core/haptics/simulation.h"
#include "palpate/scene.h"

#include "bench/measure/account.h"

namespace palpate::bench {

/// [setup] Heap memory in use [bytes], over all threads.
[[nodiscard]] std::size_t bytes_in_use();

/// A prepared scene, and the cost of its preparation.
struct Prepared {
  haptics::SimulationWorld world;
  PreparationAccount account;
};

/// [setup] Prepares a scene: median time of up to five runs within a second, and the memory that one keeps.
/// @throws InputError as scene::make_world.
[[nodiscard]] Prepared prepare(const scene::Scene& scene);

}  // namespace palpate::bench
