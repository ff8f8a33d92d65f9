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
#include "palpate/tool_contact.h"
#include "palpate/triple_buffer.h"

namespace palpate::haptics {

struct SimulationState;

/// The state after one tick, for pictures and for other programs. Plain data, so that it can be handed from
/// thread to thread.
struct Snapshot {
  static constexpr std::size_t kMaxHands = 4;
  std::uint64_t tick = 0;
  std::int64_t taken_ns = 0;  // when the tick began, monotonic clock; 0 in an offline run
  Pose organ_W;               // at that tick
  std::uint32_t hands = 0;
  std::array<contact::ToolInput, kMaxHands> tools{};
  std::array<contact::ToolResult, kMaxHands> results{};
  std::array<ForceCommand, kMaxHands> commands{};  // world frame
  std::array<Fault, kMaxHands> faults{};           // latched
  std::uint64_t change = 0;                        // number of the last live change in force; 0: none
  model::FalloffRatios reach;                      // of the tissue in force

  /// [rt] The contact of each hand.
  [[nodiscard]] std::span<const contact::ToolResult> hand_results() const noexcept {
    return {results.data(), std::min<std::size_t>(hands, kMaxHands)};
  }
};

/// One tick after it was made, as long as an observer looks at it.
struct TickState {
  const SimulationState& state;
  std::span<const ForceCommand> commands;  // what tick() returned, one a hand, world frame
  std::uint64_t tick = 0;
  std::int64_t taken_ns = 0;  // when the tick began, monotonic clock; 0 in an offline run
};

/// [rt] Fills in the state after a tick (entries of hands that the scene lacks stay as they are).
void make_snapshot(const TickState& now, Snapshot& snapshot) noexcept;

/// Watches a run. The loop's thread calls these functions; they must not block. Within a tick the order is
/// on_start (once), on_update, then on_row and on_fault of each hand, then on_tick.
class TickObserver {
 public:
  virtual ~TickObserver() = default;
  /// [rt] The first tick is due now. @param started_unix_ns wall-clock time of tick 0
  virtual void on_start(std::int64_t /*started_unix_ns*/) noexcept {}
  /// [rt] Tissue or noise parameters change at update.tick.
  virtual void on_update(const ParameterUpdate& /*update*/) noexcept {}
  /// [rt] The row of one hand.
  virtual void on_row(const TickRow& /*row*/) noexcept {}
  /// [rt] A fault was latched; a fault that is latched again after a reset is a new one.
  virtual void on_fault(const FaultSeen& /*fault*/) noexcept {}
  /// [rt] The tick is complete. make_snapshot() copies what pictures and other programs need of it.
  virtual void on_tick(const TickState& /*now*/) noexcept {}
};

/// Hands the newest snapshot to one reader on another thread.
class SnapshotPublisher final : public TickObserver {
 public:
  void on_tick(const TickState& now) noexcept override {
    make_snapshot(now, cell_.writable());
    cell_.publish();
  }
  /// [any] Where the one reader takes it from.
  [[nodiscard]] TripleBuffer<Snapshot>& cell() noexcept { return cell_; }
  [[nodiscard]] const TripleBuffer<Snapshot>& cell() const noexcept { return cell_; }

 private:
  TripleBuffer<Snapshot> cell_;
};

}  // namespace palpate::haptics
