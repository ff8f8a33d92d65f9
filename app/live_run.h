#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/session.h"

namespace palpate::app {

/// A session that runs on its own thread after start(), while a window or clients watch it through the
/// `Observer`. All members: [setup], one thread.
template <typename Observer>
class LiveRun final {
 public:
  /// @param recording HDF5 file to write; empty: none @param igtl server that shows the run to OpenIGTLink
  /// clients, outlives this; may be null @param observer arguments of the Observer's constructor
  template <typename... ObserverArguments>
  LiveRun(std::shared_ptr<Session> session, std::filesystem::path recording, haptics::LoopThread thread,
          net::IgtlServer* igtl, ObserverArguments&&... observer)
      : session_(std::move(session)),
        recording_(std::move(recording)),
        thread_(thread),
        igtl_(igtl),
        observer_(std::forward<ObserverArguments>(observer)...) {}

  /// Starts the run. Call it once.
  void start() {
    run_ = play_in_background(
        *session_,
        {.run = {recording_, false, thread_}, .observers = {&snapshots_, &observer_}, .igtl = igtl_});
  }
  [[nodiscard]] bool started() const noexcept { return run_ != nullptr; }
  /// Ends the run with zero force and a closed recording, and waits for its end.
  void stop() {
    session_->control().stop();
    if (run_ != nullptr) run_->wait();
  }
  /// Whether the run pauses, so that its simulated time does not advance.
  [[nodiscard]] bool pausing() const noexcept { return session_->control().pausing(); }
  /// Whether the run has ended and its recording is closed.
  [[nodiscard]] bool ended() const { return run_ != nullptr && run_->ended(); }
  /// Result of the run after its end; nullopt when the run failed.
  [[nodiscard]] std::optional<RunResult> result() const { return run_ ? run_->result() : std::nullopt; }
  /// Error message of the run or of its recording after its end; empty: neither failed.
  [[nodiscard]] std::string failure() const {
    if (!run_) return {};
    return run_->result() ? run_->result()->recording_failure : run_->failure();
  }

  [[nodiscard]] Session& session() noexcept { return *session_; }
  [[nodiscard]] const Session& session() const noexcept { return *session_; }
  [[nodiscard]] const std::filesystem::path& recording() const noexcept { return recording_; }
  [[nodiscard]] TripleBuffer<haptics::Snapshot>& snapshots() noexcept { return snapshots_.cell(); }
  [[nodiscard]] Observer& observer() noexcept { return observer_; }
  [[nodiscard]] const Observer& observer() const noexcept { return observer_; }

 private:
  std::shared_ptr<Session> session_;
  std::filesystem::path recording_;
  haptics::LoopThread thread_;
  net::IgtlServer* igtl_;
  Observer observer_;
  haptics::SnapshotPublisher snapshots_;
  std::unique_ptr<session::BackgroundRun> run_;  // last: destroyed before the members that the run uses
};

}  // namespace palpate::app
