#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/haptics/simulation.h"
#include "palpate/histogram.h"
#include "palpate/run_control.h"
#include "palpate/tick_observer.h"
#include "run/realtime/tick_wait.h"
#include "run/realtime/watchdog.h"

namespace palpate::haptics {

struct LoopOptions {
  std::uint64_t ticks = 0;        // how many to run
  bool offline = false;           // as fast as possible; tick_ns and late_ns of the rows are 0
  RunControl* control = nullptr;  // null: nobody stops, pauses or changes the run
  LoopThread thread{};            // offline it waits for nothing
  // In real time: when no tick began for so long the watchdog stops the devices, and the tick that begins
  // then latches Fault::kStalled on every hand. At low rates it is at least kStalledPeriods periods. 0:
  // nobody watches, for runs whose devices no hand holds: there a gap is a late tick, and rows are those of
  // an offline run.
  std::int64_t stalled_after_ns = static_cast<std::int64_t>(kStalledAfter * 1e9);
};

inline constexpr double kStalledPeriods = 4.0;

/// [setup] LoopOptions::stalled_after_ns for a run of this world: 0, nobody watches, where no hand holds a
/// device.
[[nodiscard]] std::int64_t stall_limit_ns(const SimulationWorld& world) noexcept;

/// [setup] What a report says of pauses, at least one: "the run was paused once, for 0.3 s; ...".
[[nodiscard]] std::string describe_pauses(std::uint64_t pauses, std::int64_t paused_ns);

/// [setup] Runs the loop on a thread of its own and waits for its end: absolute deadlines, SCHED_FIFO and
/// mlockall where allowed, and a watchdog (not offline). Commands are turned into each device's frame before
/// they are written. A device that refuses a command counts as not readable at the next tick. After a stop by
/// the watchdog zero force is written until the gate's own commands are zero: no jump when the loop wakes.
/// Device::stop() is called at the end whatever happened.
/// @param devices one a hand; @param observers are called in this order; none is null
/// @throws std::invalid_argument when there is not one device a hand, or options.thread.core cannot be used.
[[nodiscard]] LoopReport run_loop(const SimulationWorld& world, SimulationState& state,
                                  std::span<Device* const> devices,
                                  const std::vector<TickObserver*>& observers, const LoopOptions& options);

}  // namespace palpate::haptics
