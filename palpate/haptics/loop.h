#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/base/ring.h"
#include "palpate/base/snapshot_cell.h"
#include "palpate/haptics/histogram.h"
#include "palpate/haptics/live_changes.h"
#include "palpate/haptics/simulation.h"
#include "palpate/haptics/tick_wait.h"
#include "palpate/haptics/watchdog.h"

namespace palpate::haptics {

/// Where the loop's rows go (the recorder).
class TickSink {
 public:
  virtual ~TickSink() = default;
  /// [rt] The first tick is due now; wall time of tick 0.
  virtual void begin(std::int64_t started_unix_ns) noexcept = 0;
  /// [rt] Tissue or noise are others from change.tick on; comes before that tick's rows. Must not block.
  virtual void put_change(const LiveChange& /*change*/) noexcept {}
  /// [rt] One row; must not block.
  virtual void put(const TickRow& row) noexcept = 0;
};

/// What the picture is drawn from, and other programs see: the newest tick.
struct Snapshot {
  static constexpr std::size_t kMaxHands = 4;
  std::uint64_t tick = 0;
  std::int64_t taken_ns = 0;  // monotonic
  Pose organ_W;               // at that tick
  std::uint32_t hands = 0;
  std::array<contact::ToolInput, kMaxHands> tools{};
  std::array<contact::ToolResult, kMaxHands> results{};
  std::array<ForceCommand, kMaxHands> commands{};
  std::array<Fault, kMaxHands> faults{};  // latched
  std::uint64_t change = 0;               // number of the last live change in force; 0: none
  model::ReachParameters reach;           // of the tissue in force
};

/// A fault that was latched on one hand.
struct FaultSeen {
  static constexpr std::uint64_t kNotReset = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t tick = 0;
  std::uint32_t hand = 0;
  Fault fault = Fault::kNone;
  std::uint64_t reset_tick = kNotReset;  // the first tick without it
};

struct LoopOptions {
  std::uint64_t ticks = 0;                  // how many to run
  bool offline = false;                     // as fast as possible; tick_ns and late_ns of the rows are 0
  const std::atomic<bool>* stop = nullptr;  // Ctrl-C
  SnapshotCell<Snapshot>* snapshots = nullptr;
  SnapshotCell<Snapshot>* more_snapshots = nullptr;  // the same for a second reader: a cell has one
  std::atomic<std::uint64_t>* progress = nullptr;    // ticks done
  // A bit a hand, set by any thread: the hand's latched fault is to be cleared. The next tick takes them all.
  std::atomic<std::uint32_t>* resets = nullptr;
  LiveChanges* changes = nullptr;         // to tissue and noise while the run goes on, one a tick
  Ring<FaultSeen>* fault_news = nullptr;  // each fault when it is latched, for who tells it; full: left out
  LoopThread thread{};                    // offline it waits for nothing
  // In real time: when no tick began for so long the watchdog stops the devices, and the tick that begins
  // then latches Fault::kStalled on every hand. At low rates it is at least kStalledPeriods periods. 0:
  // nobody watches, for runs whose devices no hand holds: there a gap is a late tick, and rows are those of
  // an offline run.
  std::int64_t stalled_after_ns = static_cast<std::int64_t>(kStalledAfter * 1e9);
  // While it is set, by any thread, no tick begins: the devices are stopped and the simulation's time stands.
  // In real time, and only where nobody watches for stalls: a held device is never paused
  // (docs/decisions/0011-pause).
  const std::atomic<bool>* pause = nullptr;
};

inline constexpr double kStalledPeriods = 4.0;

/// [setup] LoopOptions::stalled_after_ns for a run of this world: 0, nobody watches, where no hand holds a
/// device.
[[nodiscard]] std::int64_t stall_limit_ns(const SimulationWorld& world) noexcept;

/// How a run went.
struct LoopReport {
  static constexpr std::size_t kMostFaults = 64;

  std::uint64_t ticks = 0;
  bool stopped_early = false;
  Fault fault = Fault::kNone;          // the first
  std::vector<FaultSeen> faults;       // the first kMostFaults
  std::uint64_t further_faults = 0;    // beyond those
  Histogram tick_time;                 // ns; also measured offline
  Histogram lateness;                  // ns; empty offline
  std::uint64_t missed_deadlines = 0;  // ticks that began a full period or more late
  std::int64_t longest_gap_ns = 0;     // between two tick starts
  bool realtime_priority = false;      // SCHED_FIFO granted
  bool memory_locked = false;          // mlockall granted
  bool polled = false;                 // between ticks; else the loop slept
  std::uint64_t pauses = 0;            // how often it was paused
  std::int64_t paused_ns = 0;          // for how long, in all
  std::uint64_t watchdog_stops = 0;    // how often the watchdog stopped the devices
  std::vector<WatchdogStop> stops;     // the first Watchdog::kMostKept
  std::vector<std::string> remarks;    // what was not granted, what the watchdog did, in words
};

/// [setup] What a report says of pauses, at least one: "the run was paused once, for 0.3 s; ...".
[[nodiscard]] std::string told_pauses(std::uint64_t pauses, std::int64_t paused_ns);

/// [setup] Runs the loop on a thread of its own and waits for its end: absolute deadlines, SCHED_FIFO and
/// mlockall where allowed, and a watchdog (not offline). Commands are turned into each device's frame before
/// they are written. A device that refuses a command counts as not readable at the next tick. After a stop by
/// the watchdog zero force is written until the gate's own commands are zero: no jump when the loop wakes.
/// Device::stop() is called at the end whatever happened.
/// @param devices one a hand; @param sink may be null
/// @throws std::invalid_argument when there is not one device a hand, or options.thread.core cannot be used.
[[nodiscard]] LoopReport run_loop(const SimulationWorld& world, SimulationState& state,
                                  std::span<Device* const> devices, TickSink* sink,
                                  const LoopOptions& options);

}  // namespace palpate::haptics
