#pragma once
#include <cstdint>

#include "palpate/base/snapshot_cell.h"
#include "palpate/haptics/live_change.h"
#include "palpate/haptics/run_control.h"
#include "palpate/haptics/snapshot.h"
#include "palpate/haptics/tick_row.h"

namespace palpate::haptics {

/// Watches a run. The loop's thread calls these functions; they must not block. Within a tick the order is
/// on_start (once), on_update, then on_row and on_fault of each hand, then on_tick.
class TickObserver {
 public:
  virtual ~TickObserver() = default;
  /// [rt] The first tick is due now. @param started_unix_ns wall-clock time of tick 0
  virtual void on_start(std::int64_t /*started_unix_ns*/) noexcept {}
  /// [rt] Tissue or noise parameters change at update.tick.
  virtual void on_update(const LiveChange& /*update*/) noexcept {}
  /// [rt] The row of one hand.
  virtual void on_row(const TickRow& /*row*/) noexcept {}
  /// [rt] A fault was latched; a fault that is latched again after a reset is a new one.
  virtual void on_fault(const FaultSeen& /*fault*/) noexcept {}
  /// [rt] The tick is complete. The snapshot is valid during the call.
  virtual void on_tick(const Snapshot& /*snapshot*/) noexcept {}
};

/// Hands the newest snapshot to one reader on another thread.
class SnapshotPublisher final : public TickObserver {
 public:
  void on_tick(const Snapshot& snapshot) noexcept override {
    cell_.writable() = snapshot;
    cell_.publish();
  }
  /// [any] Where the one reader takes it from.
  [[nodiscard]] SnapshotCell<Snapshot>& cell() noexcept { return cell_; }
  [[nodiscard]] const SnapshotCell<Snapshot>& cell() const noexcept { return cell_; }

 private:
  SnapshotCell<Snapshot> cell_;
};

}  // namespace palpate::haptics
