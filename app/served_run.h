#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "palpate/haptics/live_changes.h"
#include "palpate/net/live_tap.h"

#include "app/session.h"

namespace palpate::app {

/// A session that plays on a thread of its own while clients look on. All members: [setup], the server's
/// thread, unless said.
class ServedRun final {
 public:
  /// Begins to play. @param recording file; empty: none
  ServedRun(std::unique_ptr<Session> session, std::uint64_t number, std::filesystem::path recording,
            haptics::LoopThread thread);
  /// Zero force, recording closed.
  ~ServedRun();
  ServedRun(const ServedRun&) = delete;
  ServedRun& operator=(const ServedRun&) = delete;

  /// Ends the run in good order: zero force at the next tick. Does not wait.
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }
  /// Whether the run has ended, its recording closed.
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  /// After its end: lets the devices go, so that another session may have them.
  void release();
  /// After its end: how it went; nothing when it failed.
  [[nodiscard]] const std::optional<RunAccount>& account() const noexcept { return account_; }
  /// After its end: why it failed, in words; empty: it did not.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

  [[nodiscard]] std::uint64_t number() const noexcept { return number_; }
  [[nodiscard]] const Session& session() const noexcept { return *session_; }
  [[nodiscard]] const std::filesystem::path& recording() const noexcept { return recording_; }
  [[nodiscard]] net::LiveTap& tap() noexcept { return tap_; }
  /// The newest snapshot; nothing before the first tick.
  [[nodiscard]] const haptics::Snapshot* snapshot() noexcept;
  /// Hands new tissue and noise to the loop.
  [[nodiscard]] haptics::LiveChanges& changes() noexcept { return *changes_; }

 private:
  std::unique_ptr<Session> session_;
  std::uint64_t number_;
  std::filesystem::path recording_;
  net::LiveTap tap_;
  SnapshotCell<haptics::Snapshot> snapshots_;
  bool seen_ = false;  // whether there was a snapshot
  std::unique_ptr<haptics::LiveChanges> changes_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> ended_{false};
  std::optional<RunAccount> account_;
  std::string failure_;
  std::thread thread_;
};

}  // namespace palpate::app
