#pragma once
#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/session.h"

namespace palpate::app {

/// Tissue, touch noise and inclusions in force, which may differ from those of the scene.
struct LiveParameters {
  explicit LiveParameters(const scene::Scene& scene)
      : tissue(scene.tissue), noise(scene.noise), inclusions(scene.inclusions) {}

  model::TissueParameters tissue;
  noise::NoiseSettings noise;
  std::vector<scene::InclusionSetup> inclusions;
};

/// Parameters of a session that replace those of the next one's scene; nothing: the scene's.
struct KeptParameters {
  KeptParameters() = default;
  /// Keeps all.
  KeptParameters(const LiveParameters& all)  // NOLINT(google-explicit-constructor): a subset of it
      : tissue(all.tissue), noise(all.noise), inclusions(all.inclusions) {}

  std::optional<model::TissueParameters> tissue{};
  std::optional<noise::NoiseSettings> noise{};
  std::optional<std::vector<scene::InclusionSetup>> inclusions{};
};

/// Prepares the next session on its own thread. The scene is read and checked while the previous session
/// still runs. The session is prepared after the previous session has closed its devices. All members:
/// [setup], one thread.
class NextSession final {
 public:
  /// Checks the scene while the previous session still runs. @throws InputError to reject the scene.
  using Check = std::function<void(const scene::Scene&)>;
  enum class State { kReading, kRead, kPreparing, kReady, kFailed };

  /// Starts to read and check the scene. @param kept parameters of the previous session that replace those of
  /// the request @param recording HDF5 file to write; empty: none @param check may be empty
  NextSession(scene::Overrides request, KeptParameters kept, std::filesystem::path recording,
              Check check = {});

  /// Polls the thread; does not wait.
  [[nodiscard]] State state();
  /// Cancels the session. The thread ends after it has read the current file, or at the next stage of the
  /// organ's preparation.
  void break_off() noexcept { broken_off_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool is_broken_off() const noexcept { return broken_off_.load(std::memory_order_relaxed); }
  /// Whether the thread has finished, so that the destructor does not wait.
  [[nodiscard]] bool is_idle() { return state() != State::kReading && state() != State::kPreparing; }
  /// Call it in kRead, when no other session holds a device. Starts to prepare the session.
  /// @param duration_s simulated time [s]; nullopt: until the devices have no more samples @param no_cache
  /// ignores the cache of prepared organs
  void prepare_now(std::optional<double> duration_s, bool no_cache);
  /// Call it in kReady. Hands over the session.
  [[nodiscard]] std::unique_ptr<Session> take() { return std::move(session_); }
  /// In kFailed: the error message.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  [[nodiscard]] const scene::Overrides& request() const noexcept { return request_; }
  [[nodiscard]] const std::filesystem::path& recording() const noexcept { return recording_; }

 private:
  scene::Overrides request_;
  KeptParameters kept_;
  std::filesystem::path recording_;
  Check check_;
  std::optional<scene::Scene> scene_;
  std::unique_ptr<Session> session_;
  std::string failure_;
  std::atomic<bool> broken_off_{false};
  State state_ = State::kReading;
  std::future<void> work_;  // last: the thread ends before the members that it uses are destroyed
};

}  // namespace palpate::app
