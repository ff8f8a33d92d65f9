#pragma once
#include <atomic>
#include <cstdint>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/spsc_queue.h"
#include "palpate/session.h"

namespace palpate::app {

/// Reports the progress of a run from its own thread: a progress bar, and a message for each fault with the
/// command that resets it. The haptic loop only counts ticks and puts faults into a lock-free queue.
class ProgressObserver final : public haptics::TickObserver {
 public:
  /// [setup] @param session outlives this
  explicit ProgressObserver(const session::Session& session);
  /// [setup] Reports the remaining faults and errors, then ends the thread.
  ~ProgressObserver() override;
  ProgressObserver(const ProgressObserver&) = delete;
  ProgressObserver& operator=(const ProgressObserver&) = delete;

  /// [setup] Prints an error on standard error within 0.1 s. Any thread except the haptic loop may call it.
  void queue_error(std::string error) {
    const std::scoped_lock lock(mutex_);
    errors_.push_back(std::move(error));
  }

  void on_fault(const haptics::FaultSeen& fault) noexcept override { (void)faults_.push(fault); }
  void on_row(const haptics::TickRow& row) noexcept override {
    if ((row.events & haptics::kMotorsWarm) != 0)
      warm_hand_.store(static_cast<int>(row.hand), std::memory_order_relaxed);
  }
  void on_tick(const haptics::TickState& now) noexcept override {
    done_.store(now.tick + 1, std::memory_order_relaxed);
  }

 private:
  static constexpr std::size_t kFaultsKept = 64;

  void report_progress(const std::stop_token& stop);
  void report_fault(const haptics::FaultSeen& seen) const;
  [[nodiscard]] std::string describe_warm_motors(std::size_t hand) const;

  const session::Session& session_;
  std::atomic<std::uint64_t> done_{0};  // ticks
  std::atomic<int> warm_hand_{-1};      // hand whose device last reported warm motors; -1: none
  SpscQueue<haptics::FaultSeen> faults_{kFaultsKept};
  std::mutex mutex_;  // guards errors_
  std::vector<std::string> errors_;
  std::jthread thread_;  // last: the thread ends before the members that it uses are destroyed
};

}  // namespace palpate::app
