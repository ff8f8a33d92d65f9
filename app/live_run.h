#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/session.h"

namespace palpate::app {

/// A session that plays in the background, from start() on, while a window or clients watch it through a
/// Observer, an observer. All members: [setup], one thread.
template <typename Observer>
class LiveRun final {
 public:
  /// @param recording file; empty: none @param igtl shows the run to other programs, outlives this; may be
  /// null @param observer what the Observer is made of
  template <typename... ObserverArguments>
  LiveRun(std::shared_ptr<Session> session, std::filesystem::path recording, haptics::LoopThread thread,
          net::IgtlServer* igtl, ObserverArguments&&... observer)
      : session_(std::move(session)),
        recording_(std::move(recording)),
        thread_(thread),
        igtl_(igtl),
        observer_(std::forward<ObserverArguments>(observer)...) {}

  /// Begins to play, once.
  void start() {
    run_ = play_in_background(
        *session_,
        {.run = {recording_, false, thread_}, .observers = {&snapshots_, &observer_}, .igtl = igtl_});
  }
  [[nodiscard]] bool started() const noexcept { return run_ != nullptr; }
  /// Ends the run in good order and waits for it: zero force, recording closed.
  void stop() {
    session_->control().stop();
    if (run_ != nullptr) run_->wait();
  }
  /// Whether no time passes in the run.
  [[nodiscard]] bool pausing() const noexcept { return session_->control().pausing(); }
  /// Whether the run has ended, its recording closed.
  [[nodiscard]] bool ended() const { return run_ != nullptr && run_->ended(); }
  /// After its end: how it went; nothing when it failed.
  [[nodiscard]] std::optional<RunResult> result() const { return run_ ? run_->result() : std::nullopt; }
  /// After its end: why it, or its recording, failed; empty: it did not.
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
  std::unique_ptr<session::BackgroundRun> run_;  // last: it uses all of the above
};

}  // namespace palpate::app
