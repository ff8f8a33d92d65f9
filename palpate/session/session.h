#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/contact/preparation.h"
#include "palpate/haptics/device.h"
#include "palpate/haptics/live_changes.h"
#include "palpate/haptics/tick_observer.h"
#include "palpate/scene/load.h"
#include "palpate/session/background_run.h"
#include "palpate/session/run_result.h"

namespace palpate::haptics {
struct SimulationWorld;
}

namespace palpate::session {

/// How a session is opened.
struct SessionOptions {
  // s: exactly round(duration_s x rate) ticks; none: until the devices have no more samples
  std::optional<double> duration_s{};
  contact::Preparation preparation{};                       // of the organ: cache and progress
  std::vector<std::unique_ptr<haptics::Device>> devices{};  // one a hand; empty: those that the scene names
};

/// How a session is run.
struct RunOptions {
  std::filesystem::path recording{};  // HDF5 file of all ticks; empty: none
  bool offline = false;               // as fast as possible, the same rows
  haptics::LoopThread thread{};       // of the loop
  // Without a recording: the last seconds before a fault go to a file in the user's state folder.
  bool keep_fault = true;
};

/// [setup] The number of ticks in a duration [s]. @param name what the user calls the duration
/// @throws ParameterError unless it is > 0 and at most `most` ticks long (1e12: 30 years at 1 kHz).
[[nodiscard]] std::uint64_t ticks_in(double duration_s, double rate_Hz,
                                     const std::string& name = "duration_s", double most = 1e12);

/// A scene that is ready to run: its world, its devices and what steers it. It runs once.
class Session final {
 public:
  /// [setup] Prepares the organ and opens the devices. What the user should know of the scene (a tip of
  /// another size than the tissue was fitted with, a device that may be unstable) is added to its remarks.
  /// @throws InputError, ParameterError.
  explicit Session(scene::Setup setup, SessionOptions options = {});
  /// [setup] `Session::open(scene::load(request)).run({.recording = "press.h5"})` records a scene.
  [[nodiscard]] static Session open(scene::Setup setup, SessionOptions options = {}) {
    return Session(std::move(setup), std::move(options));
  }
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// [setup] Runs to the end and closes the recording. @param observers are told of every tick, in this order
  /// @throws InputError when the recording cannot be written, std::logic_error at a second call.
  RunResult run(const RunOptions& options = {}, const std::vector<haptics::TickObserver*>& observers = {});
  /// [setup] The same on a thread of its own. The session and the observers outlive what it returns.
  [[nodiscard]] std::unique_ptr<BackgroundRun> run_in_background(
      RunOptions options = {}, std::vector<haptics::TickObserver*> observers = {});

  /// [any] Stops, pauses, and resets faults of the run.
  [[nodiscard]] haptics::RunControl& control() noexcept { return control_; }
  /// [any] Takes new tissue and noise parameters for the run.
  [[nodiscard]] haptics::LiveChanges& updates() noexcept { return *updates_; }
  /// [any] Whether the run may be paused: no hand holds one of its devices.
  [[nodiscard]] bool may_pause() const noexcept;

  [[nodiscard]] const scene::Setup& setup() const noexcept { return setup_; }
  [[nodiscard]] const haptics::SimulationWorld& world() const noexcept { return *world_; }
  [[nodiscard]] std::size_t hands() const noexcept { return setup_.tools.size(); }
  /// [any] How many ticks the run has; 2^64-1: until it is stopped.
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  /// [any] One a hand; empty after close_devices().
  [[nodiscard]] const std::vector<std::unique_ptr<haptics::Device>>& devices() const noexcept {
    return devices_;
  }
  /// [setup] Not during a run: closes the devices, so that another session can open them.
  void close_devices() { devices_.clear(); }

 private:
  void open_devices();

  scene::Setup setup_;
  std::unique_ptr<const haptics::SimulationWorld> world_;
  std::vector<std::unique_ptr<haptics::Device>> devices_;
  std::uint64_t ticks_ = 0;
  std::unique_ptr<haptics::LiveChanges> updates_;
  haptics::RunControl control_;
  bool ran_ = false;
};

}  // namespace palpate::session
