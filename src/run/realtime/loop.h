#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/haptics/simulation.h"
#include "palpate/run_control.h"
#include "palpate/tick_observer.h"
#include "run/realtime/tick_wait.h"

namespace palpate::realtime {

struct LoopOptions {
  std::uint64_t ticks = 0;                 // number of ticks to run
  bool offline = false;                    // as fast as possible; tick_ns and late_ns of the rows are 0
  haptics::RunControl* control = nullptr;  // null: the run cannot be stopped, paused or changed
  haptics::LoopThread thread{};            // not used offline
  // In real time: when no tick begins for this time, the watchdog stops the devices, and the next tick
  // latches Fault::kStalled on every hand. The limit is at least kStalledPeriods periods. 0: no watchdog, for
  // runs without held devices. A gap is then a late tick, and the rows equal those of an offline run.
  std::int64_t stalled_after_ns = static_cast<std::int64_t>(haptics::kStalledAfter * 1e9);
};

inline constexpr double kStalledPeriods = 4.0;

/// [setup] LoopOptions::stalled_after_ns for a run of this world; 0 (no watchdog) when no device is held.
[[nodiscard]] std::int64_t stall_limit_ns(const haptics::SimulationWorld& world) noexcept;

/// [setup] Remark of a report about at least one pause: "the run was paused once, for 0.3 s; ...".
[[nodiscard]] std::string describe_pauses(std::uint64_t pauses, std::int64_t paused_ns);

/// [setup] Runs the loop on its own thread and waits for its end. In real time it uses absolute deadlines,
/// SCHED_FIFO and mlockall where permitted, and a watchdog. Commands are rotated into each device's frame. A
/// device that refuses a command has Fault::kDevice at the next tick. After a stop by the watchdog, zero
/// force is written until the gate's command is zero, so that the force does not jump. Device::stop() is
/// always called at the end.
/// @param devices one a hand; @param observers are called in this order; none is null
/// @throws std::invalid_argument when there is not one device a hand, or options.thread.core cannot be used.
[[nodiscard]] haptics::LoopReport run_loop(const haptics::SimulationWorld& world,
                                           haptics::SimulationState& state,
                                           std::span<haptics::Device* const> devices,
                                           const std::vector<haptics::TickObserver*>& observers,
                                           const LoopOptions& options);

}  // namespace palpate::realtime
