#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "palpate/base/snapshot_cell.h"
#include "palpate/haptics/histogram.h"
#include "palpate/haptics/simulation.h"

namespace palpate::haptics {

/// Where the loop's rows go (the recorder).
class TickSink {
 public:
  virtual ~TickSink() = default;
  /// [rt] The first tick is due now; wall time of tick 0.
  virtual void begin(std::int64_t started_unix_ns) noexcept = 0;
  /// [rt] One row; must not block.
  virtual void put(const TickRow& row) noexcept = 0;
};

/// What the picture is drawn from: the newest tick.
struct Snapshot {
  static constexpr std::size_t kMaxHands = 4;
  std::uint64_t tick = 0;
  std::int64_t taken_ns = 0;  // monotonic
  Pose organ_W;               // at that tick
  std::uint32_t hands = 0;
  std::array<contact::ToolInput, kMaxHands> tools{};
  std::array<contact::ToolResult, kMaxHands> results{};
  std::array<ForceCommand, kMaxHands> commands{};
};

struct LoopOptions {
  std::uint64_t ticks = 0;                  // how many to run
  bool offline = false;                     // as fast as possible; tick_ns and late_ns of the rows are 0
  const std::atomic<bool>* stop = nullptr;  // Ctrl-C
  SnapshotCell<Snapshot>* snapshots = nullptr;
  std::atomic<std::uint64_t>* progress = nullptr;  // ticks done
};

/// How a run went.
struct LoopReport {
  std::uint64_t ticks = 0;
  bool stopped_early = false;
  Fault fault = Fault::kNone;
  Histogram tick_time;                 // ns; also measured offline
  Histogram lateness;                  // ns; empty offline
  std::uint64_t missed_deadlines = 0;  // ticks that began a full period or more late
  std::int64_t longest_gap_ns = 0;     // between two tick starts
  bool realtime_priority = false;      // SCHED_FIFO granted
  bool memory_locked = false;          // mlockall granted
  std::vector<std::string> remarks;    // what was not granted, in words
};

/// [setup] Runs the loop on a thread of its own and waits for its end: absolute deadlines, SCHED_FIFO and
/// mlockall where allowed (not offline). A device that refuses a command counts as not readable at the next
/// tick. Device::stop() is called at the end whatever happened.
/// @param devices one a hand; @param sink may be null
/// @throws std::invalid_argument when there is not one device a hand.
[[nodiscard]] LoopReport run_loop(const SimulationWorld& world, SimulationState& state,
                                  std::span<Device* const> devices, TickSink* sink,
                                  const LoopOptions& options);

}  // namespace palpate::haptics
