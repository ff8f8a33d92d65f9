#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "app/session.h"
#include "app/window/row_tap.h"

namespace palpate::app {

/// A session that plays in the background, from start() on, while a window looks on. All members: [setup],
/// the window's thread.
class LiveRun final {
 public:
  /// @param session outlives this unless it is owned @param recording file; empty: none
  /// @param igtl shows the run to other programs, outlives this; null: nobody does
  LiveRun(Session& session, std::filesystem::path recording, haptics::LoopThread thread,
          net::IgtlServer* igtl = nullptr);
  LiveRun(std::unique_ptr<Session> session, std::filesystem::path recording, haptics::LoopThread thread,
          net::IgtlServer* igtl = nullptr);

  /// Begins to play, once.
  void start();
  [[nodiscard]] bool started() const noexcept { return run_ != nullptr; }
  /// Ends the run in good order and waits for it: zero force, recording closed.
  void stop();
  /// No time passes in the run, and its devices are stopped, until it is to go on; only where may_pause().
  void pause(bool on) noexcept { session_.control().pause(on && may_pause()); }
  [[nodiscard]] bool may_pause() const noexcept { return session_.may_pause(); }
  [[nodiscard]] bool pausing() const noexcept { return session_.control().pausing(); }
  /// Whether the run has ended.
  [[nodiscard]] bool ended() const { return run_ != nullptr && run_->ended(); }
  /// After its end: how it went; nothing when it failed.
  [[nodiscard]] std::optional<RunResult> result() const { return run_ ? run_->result() : std::nullopt; }
  /// After its end: why it failed, in words; empty: it did not.
  [[nodiscard]] std::string failure() const {
    if (!run_) return {};
    return run_->result() ? run_->result()->recording_failure : run_->failure();
  }

  [[nodiscard]] Session& session() noexcept { return session_; }
  [[nodiscard]] const Session& session() const noexcept { return session_; }
  [[nodiscard]] const std::filesystem::path& recording() const noexcept { return recording_; }
  [[nodiscard]] SnapshotCell<haptics::Snapshot>& snapshots() noexcept { return snapshots_.cell(); }
  [[nodiscard]] RowTap& rows() noexcept { return rows_; }
  [[nodiscard]] const RowTap& rows() const noexcept { return rows_; }

 private:
  std::unique_ptr<Session> owned_;
  Session& session_;
  std::filesystem::path recording_;
  haptics::LoopThread loop_thread_;
  net::IgtlServer* igtl_;
  haptics::SnapshotPublisher snapshots_;
  RowTap rows_;
  std::unique_ptr<session::BackgroundRun> run_;  // last: it uses all of the above
};

}  // namespace palpate::app
