#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/haptics/simulation.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"
#include "run/realtime/tick_wait.h"

#include "bench/measure/account.h"

namespace palpate::bench {

inline constexpr double kHandsRate = 1000.0;           // Hz
inline constexpr double kPeriodShare = 0.8;            // of the period that may be used
inline constexpr std::uint64_t kPeriodsHeld = 10'000;  // consecutive periods on each core
inline constexpr std::uint64_t kPeriodsExceeded = 10;  // periods that may take longer: p99.9
inline constexpr std::size_t kMaxHandsTried = 4000;

/// [setup] Number of independent hands, all in contact, that every core can compute within 80 % of a 1 ms
/// period at p99.9 while all other cores have the same load, and the memory per hand. One thread per core
/// runs all of its hands once a period, in real time, for 10,000 periods; at most 10 periods per core may
/// exceed the limit. The number is found by bisection; a number that fails is tried twice, because other load
/// on the machine comes in bursts. @throws as run_path().
[[nodiscard]] HandsAccount hand_capacity(const scene::Scene& scene, const haptics::SimulationWorld& world,
                                         const scene::ToolPath& path, haptics::Waiting waiting,
                                         const Watch& watch);

/// [setup] Runs `hands` hands at 1 kHz, distributed evenly over all cores, for `periods` each. @throws as
/// run_path(), and std::invalid_argument for no hands
[[nodiscard]] HandsRun run_hands(const scene::Scene& scene, const haptics::SimulationWorld& world,
                                 const scene::ToolPath& path, haptics::Waiting waiting, std::size_t hands,
                                 std::uint64_t periods = kPeriodsHeld);

/// [setup] Largest number for which `fits` was true, by bisection between 0 and `too_many`, starting with
/// `first`; assumes that `fits` is monotonic. 0: none.
[[nodiscard]] std::size_t greatest_that_fits(std::size_t first, std::size_t too_many,
                                             const std::function<bool(std::size_t)>& fits);

}  // namespace palpate::bench
