#pragma once
#include <cstddef>

#include "palpate/haptics/simulation.h"
#include "palpate/scene/setup.h"
#include "palpate/scene/tool_path.h"

#include "bench/measure/account.h"

namespace palpate::bench {

inline constexpr double kHandsRate = 1000.0;  // Hz
inline constexpr double kPeriodShare = 0.8;   // of the period may be spent

/// [setup] How many independent hands, each with a state of its own and in contact all the time, one core
/// carries inside 80 % of a 1 ms period at p99.9, and what memory each takes. All are ticked once a period,
/// on one thread, in real time; a number that does not fit is tried twice. @throws as walk().
[[nodiscard]] HandsAccount most_hands(const scene::Setup& setup, const haptics::SimulationWorld& world,
                                      const scene::ToolPath& path, const Watch& watch);

/// [setup] Runs `hands` of them at 1 kHz, spread evenly over all processors, for three seconds, and adds how
/// that went to `account`.
void run_hands(const scene::Setup& setup, const haptics::SimulationWorld& world, const scene::ToolPath& path,
               std::size_t hands, HandsAccount& account);

/// [any] The next number of hands to try after `hands` took `p999_us` a round of which `limit_us` may be
/// spent: in proportion, but at least one more or one less.
[[nodiscard]] std::size_t next_hands(std::size_t hands, double p999_us, double limit_us) noexcept;

}  // namespace palpate::bench
