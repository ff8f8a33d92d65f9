#pragma once
#include <cstddef>

#include "core/haptics/simulation.h"
#include "palpate/scene.h"

#include "bench/measure/account.h"

namespace palpate::bench {

/// [setup] Bytes that the program has asked the C library for and not given back, in all threads.
[[nodiscard]] std::size_t bytes_in_use();

/// A scene's organ and tools, ready for the first tick, and what that took.
struct Prepared {
  haptics::SimulationWorld world;
  PreparationAccount account;
};

/// [setup] Prepares a scene: the median time of up to five times within a second, and the memory that one
/// keeps. @throws InputError as scene::make_world.
[[nodiscard]] Prepared prepare(const scene::Setup& setup);

}  // namespace palpate::bench
