#pragma once
#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "app/session.h"

namespace palpate::app {

/// The session to come: read and checked on a thread of its own while the one before still plays, then, once
/// that has let its devices go, made ready. All members: [setup], one thread.
class NextSession final {
 public:
  /// What is taken over from the session before instead of what the request says.
  struct Kept {
    std::optional<model::TissueParameters> tissue;
    std::optional<noise::NoiseSettings> noise;
  };
  /// Refuses a scene that was read, before the session before it ends. @throws InputError
  using Check = std::function<void(const scene::Scene&)>;
  enum class State { kReading, kRead, kPreparing, kReady, kFailed };

  /// Begins to read.
  NextSession(scene::Overrides request, Kept kept, std::filesystem::path recording, Check check = {});

  [[nodiscard]] State state();
  /// It is wanted no more: what its thread does ends after the file that is being read, or with the organ's
  /// next stage.
  void break_off() noexcept { broken_off_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool is_broken_off() const noexcept { return broken_off_.load(std::memory_order_relaxed); }
  /// Whether its thread does nothing any more, so that destroying it does not wait.
  [[nodiscard]] bool is_idle() { return state() != State::kReading && state() != State::kPreparing; }
  /// In kRead, when no other session holds a device: goes on.
  void prepare_now(std::optional<double> duration_s, bool no_cache);
  /// In kReady: the session.
  [[nodiscard]] std::unique_ptr<Session> take() { return std::move(session_); }
  /// In kFailed: why, in words.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  [[nodiscard]] const scene::Overrides& request() const noexcept { return request_; }
  [[nodiscard]] const std::filesystem::path& recording() const noexcept { return recording_; }

 private:
  scene::Overrides request_;
  Kept kept_;
  std::filesystem::path recording_;
  Check check_;
  std::optional<scene::Scene> setup_;
  std::unique_ptr<Session> session_;
  std::string failure_;
  std::atomic<bool> broken_off_{false};
  State state_ = State::kReading;
  std::future<void> work_;  // last: its thread uses all of the above, and ends with this
};

}  // namespace palpate::app
