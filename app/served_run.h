#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>

#include "net/live_tap.h"

#include "app/session.h"

namespace palpate::app {

/// A session that plays in the background while clients look on. All members: [setup], the server's thread.
class ServedRun final {
 public:
  /// Begins to play. @param recording file; empty: none
  ServedRun(std::unique_ptr<Session> session, std::uint64_t number, std::filesystem::path recording,
            haptics::LoopThread thread);

  /// Ends the run in good order: zero force at the next tick. Does not wait.
  void stop() noexcept { run_->stop(); }
  /// Whether the run has ended, its recording closed.
  [[nodiscard]] bool ended() const { return run_->ended(); }
  /// After its end: closes the devices, so that another session may have them.
  void release();
  /// After its end: how it went, or why it failed.
  [[nodiscard]] const session::BackgroundRun& run() const noexcept { return *run_; }

  [[nodiscard]] std::uint64_t number() const noexcept { return number_; }
  [[nodiscard]] Session& session() noexcept { return *session_; }
  [[nodiscard]] const Session& session() const noexcept { return *session_; }
  [[nodiscard]] const std::filesystem::path& recording() const noexcept { return recording_; }
  [[nodiscard]] net::LiveTap& tap() noexcept { return tap_; }
  /// The newest snapshot; null before the first tick.
  [[nodiscard]] const haptics::Snapshot* snapshot() noexcept;

 private:
  std::unique_ptr<Session> session_;
  std::uint64_t number_;
  std::filesystem::path recording_;
  net::LiveTap tap_;
  haptics::SnapshotPublisher snapshots_;
  bool seen_ = false;                            // whether there was a snapshot
  std::unique_ptr<session::BackgroundRun> run_;  // last: it uses all of the above
};

}  // namespace palpate::app
