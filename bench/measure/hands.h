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
inline constexpr double kPeriodShare = 0.8;            // of the period may be spent
inline constexpr std::uint64_t kPeriodsHeld = 10'000;  // in a row, of every core
inline constexpr std::uint64_t kPeriodsExceeded = 10;  // of them may take longer: p99.9
inline constexpr std::size_t kMostHandsTried = 4000;

/// [setup] How many independent hands, each with a state of its own and in contact all the time, every core
/// carries inside 80 % of a 1 ms period at p99.9 while all the others carry as many, and what memory each
/// takes. One thread a core ticks all of its hands once a period, in real time, for 10,000 periods; no core
/// may be over in more than 10 of them. The number is found by halving; one that does not fit is tried twice,
/// for what else the machine does comes in bursts. @throws as walk().
[[nodiscard]] HandsAccount most_hands(const scene::Setup& setup, const haptics::SimulationWorld& world,
                                      const scene::ToolPath& path, haptics::Waiting waiting,
                                      const Watch& watch);

/// [setup] Runs `hands` of them at 1 kHz, spread evenly over all cores, for `periods` each.
/// @throws as walk(), and std::invalid_argument for no hands
[[nodiscard]] HandsRun run_hands(const scene::Setup& setup, const haptics::SimulationWorld& world,
                                 const scene::ToolPath& path, haptics::Waiting waiting, std::size_t hands,
                                 std::uint64_t periods = kPeriodsHeld);

/// [setup] The greatest number that was seen to fit, by halving between 0 and `too_many`, with `first` as the
/// first one tried: as if whatever is greater than one that does not fit did not either. 0: none fitted.
[[nodiscard]] std::size_t greatest_that_fits(std::size_t first, std::size_t too_many,
                                             const std::function<bool(std::size_t)>& fits);

}  // namespace palpate::bench
