#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "palpate/device.h"
#include "palpate/parameter_updates.h"
#include "palpate/pose.h"
#include "palpate/run_control.h"
#include "palpate/tick_row.h"
#include "palpate/tissue.h"
#include "palpate/tool.h"
#include "palpate/tool_contact.h"
#include "palpate/triple_buffer.h"

namespace palpate::haptics {

struct SimulationState;

/// The state after one tick, for pictures and for other programs. It is plain data, so one copy passes it to
/// another thread.
struct Snapshot {
  std::uint64_t tick = 0;
  std::int64_t taken_ns = 0;  // start of the tick, monotonic clock; 0 in an offline run
  Pose organ_W;               // pose of the organ at the tick
  std::uint32_t hands = 0;
  std::array<contact::ToolInput, kMaxHands> tools{};
  std::array<contact::ToolResult, kMaxHands> results{};
  std::array<ForceCommand, kMaxHands> commands{};  // world frame
  std::array<Fault, kMaxHands> faults{};           // latched
  std::uint64_t change = 0;    // number of the last parameter update that applies; 0: none
  model::FalloffRatios reach;  // displacement profile of the current tissue

  /// [rt] The contact of each hand.
  [[nodiscard]] std::span<const contact::ToolResult> hand_results() const noexcept {
    return {results.data(), std::min<std::size_t>(hands, kMaxHands)};
  }
};

/// A completed tick. It is valid only during TickObserver::on_tick().
struct TickState {
  const SimulationState& state;
  std::span<const ForceCommand> commands;  // results of tick(), one per hand, world frame
  std::uint64_t tick = 0;
  std::int64_t taken_ns = 0;  // start of the tick, monotonic clock; 0 in an offline run
};

/// [rt] Copies the state after a tick into `snapshot`. Entries beyond the scene's number of hands are not
/// changed.
void make_snapshot(const TickState& now, Snapshot& snapshot) noexcept;

/// Receives the ticks, rows and faults of a run. The loop's thread calls these functions, so they must not
/// block. The order within a tick is on_start (first tick only), on_update, then on_row and on_fault of each
/// hand, then on_tick.
class TickObserver {
 public:
  virtual ~TickObserver() = default;
  /// [rt] Called when the first tick is due. @param started_unix_ns wall-clock time of tick 0
  virtual void on_start(std::int64_t /*started_unix_ns*/) noexcept {}
  /// [rt] Tissue or noise parameters change at update.tick.
  virtual void on_update(const ParameterUpdate& /*update*/) noexcept {}
  /// [rt] The row of one hand.
  virtual void on_row(const TickRow& /*row*/) noexcept {}
  /// [rt] A fault was latched. A fault that is latched again after a reset is reported again.
  virtual void on_fault(const FaultSeen& /*fault*/) noexcept {}
  /// [rt] The tick is complete. make_snapshot() copies the state that pictures and other programs need.
  virtual void on_tick(const TickState& /*now*/) noexcept {}
};

/// Passes the newest snapshot to one reader on another thread.
class SnapshotPublisher final : public TickObserver {
 public:
  void on_tick(const TickState& now) noexcept override {
    make_snapshot(now, cell_.writable());
    cell_.publish();
  }
  /// [any] The triple buffer that the one reader reads.
  [[nodiscard]] TripleBuffer<Snapshot>& cell() noexcept { return cell_; }
  [[nodiscard]] const TripleBuffer<Snapshot>& cell() const noexcept { return cell_; }

 private:
  TripleBuffer<Snapshot> cell_;
};

}  // namespace palpate::haptics
