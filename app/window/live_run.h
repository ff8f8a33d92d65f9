#pragma once
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "palpate/base/snapshot_cell.h"
#include "palpate/haptics/live_changes.h"

#include "app/session.h"
#include "app/window/row_tap.h"

namespace palpate::app {

/// A session that plays on a thread of its own, from start() on, while a window looks on. All members:
/// [setup], the window's thread, unless said.
class LiveRun final {
 public:
  /// @param session outlives this unless it is owned @param recording file; empty: none
  /// @param igtl shows the run to other programs, outlives this; null: nobody does
  LiveRun(Session& session, std::filesystem::path recording, haptics::LoopThread thread,
          net::IgtlServer* igtl = nullptr);
  LiveRun(std::unique_ptr<Session> session, std::filesystem::path recording, haptics::LoopThread thread,
          net::IgtlServer* igtl = nullptr);
  /// Zero force, recording closed.
  ~LiveRun();
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  /// Begins to play, once.
  void start();
  [[nodiscard]] bool started() const noexcept { return thread_.joinable() || ended(); }
  /// Ends the run in good order and waits for it: zero force, recording closed.
  void stop();
  /// No time passes in the run, and its devices are stopped, until it is to go on; only where may_pause().
  void pause(bool on) noexcept { pause_.store(on && may_pause_, std::memory_order_relaxed); }
  [[nodiscard]] bool may_pause() const noexcept { return may_pause_; }
  [[nodiscard]] bool pausing() const noexcept { return pause_.load(std::memory_order_relaxed); }
  /// Whether the run has ended.
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  /// After its end: how it went; nothing when it failed.
  [[nodiscard]] const std::optional<RunAccount>& account() const noexcept { return account_; }
  /// After its end: why it failed, in words; empty: it did not.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

  [[nodiscard]] Session& session() noexcept { return session_; }
  [[nodiscard]] const Session& session() const noexcept { return session_; }
  [[nodiscard]] const std::filesystem::path& recording() const noexcept { return recording_; }
  [[nodiscard]] SnapshotCell<haptics::Snapshot>& snapshots() noexcept { return snapshots_; }
  [[nodiscard]] RowTap& rows() noexcept { return rows_; }
  [[nodiscard]] const RowTap& rows() const noexcept { return rows_; }
  /// Hands new tissue and noise to the loop.
  [[nodiscard]] haptics::LiveChanges& changes() noexcept { return *changes_; }

 private:
  std::unique_ptr<Session> owned_;
  Session& session_;
  std::filesystem::path recording_;
  haptics::LoopThread loop_thread_;
  net::IgtlServer* igtl_;
  SnapshotCell<haptics::Snapshot> snapshots_;
  RowTap rows_;
  std::unique_ptr<haptics::LiveChanges> changes_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> pause_{false};
  bool may_pause_ = false;
  std::atomic<bool> ended_{false};
  std::optional<RunAccount> account_;
  std::string failure_;
  std::thread thread_;
};

}  // namespace palpate::app
