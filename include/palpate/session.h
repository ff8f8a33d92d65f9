#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "palpate/device.h"
#include "palpate/parameter_updates.h"
#include "palpate/preparation.h"
#include "palpate/run_control.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"

namespace palpate::haptics {
struct SimulationWorld;
}

namespace palpate::session {

/// A stretch of ticks that one hand spent in one phase.
struct PhaseSpan {
  std::uint32_t hand = 0;
  std::uint32_t phase = 0;  // contact::Phase
  double from = 0.0;        // s
  double to = 0.0;          // s, of the first tick after it
};

/// Peaks and counts over the rows of a run.
struct RunStatistics {
  static constexpr std::size_t kMaxSpans = 256;

  double peak_force = 0.0;     // N, at the device
  double peak_tissue = 0.0;    // N, before the gate
  double peak_depth = 0.0;     // m
  double depth_at_peak = 0.0;  // m, when the tissue's force was at its peak
  double fastest_rise = 0.0;   // N/s, of a hand's tissue force from one tick to the next
  double loading_work = 0.0;   // J: the most that the hands had put into the device forces; without torques
  double dissipated = 0.0;     // J: what they had not got back at the end
  std::uint64_t deepest_tick = 0;
  std::uint32_t deepest_hand = 0;
  std::uint64_t contact_ticks = 0;  // ticks with a hand pressing or pulling
  std::uint64_t limited_ticks = 0;  // ticks in which the gate shortened a force or torque
  std::uint32_t status = 0;         // all bits seen
  std::uint64_t changes = 0;        // of tissue or noise parameters during the run
  std::vector<PhaseSpan> phases;    // in order of their begin
  std::uint64_t phases_left_out = 0;
};

/// How a run went.
struct RunResult {
  std::string scene;  // its name
  double rate_Hz = 0.0;
  std::uint64_t seed = 0;
  std::size_t hands = 0;
  std::vector<std::string> scene_remarks;  // repairs of its meshes, and what the user should know of it
  bool offline = false;
  haptics::LoopReport loop;
  RunStatistics statistics;
  std::filesystem::path fault_recording;  // the last ticks before a fault of an unrecorded run; empty: none
  std::string recording_failure;          // the recording's file, where it ends and why; empty: it is whole
};

/// A run on a thread of its own. All members: [any], unless said; none is for the tick.
class BackgroundRun final {
 public:
  /// [setup] Starts. @param run does the run, on the new thread @param control of that run, outlives this
  BackgroundRun(haptics::RunControl& control, std::function<RunResult()> run);
  /// Ends the run: zero force, recording closed.
  ~BackgroundRun();
  BackgroundRun(const BackgroundRun&) = delete;
  BackgroundRun& operator=(const BackgroundRun&) = delete;

  /// Asks the run to end at its next tick. Does not wait.
  void stop() noexcept { control_.stop(); }
  /// Waits for the end: zero force, recording closed.
  void wait();
  /// Waits at most so long. @return whether the run has ended
  [[nodiscard]] bool wait_for(std::chrono::milliseconds time) const;
  [[nodiscard]] bool ended() const { return wait_for(std::chrono::milliseconds(0)); }

  /// After the end: how the run went; nothing when it failed.
  [[nodiscard]] const std::optional<RunResult>& result() const noexcept { return result_; }
  /// After the end: why the run failed; empty: it did not.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  haptics::RunControl& control_;
  std::optional<RunResult> result_;
  std::string failure_;
  mutable std::mutex mutex_;  // of ended_
  mutable std::condition_variable changed_;
  bool ended_ = false;
  std::mutex joining_;
  std::thread thread_;  // last: it uses all of the above
};

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
  // Called once, from the recorder's thread, when a recording cannot be written any more, with the file, the
  // rows that are safe in it, and the reason. The run goes on, and run() returns with recording_failure set.
  // Without this function run() throws at the end of the run.
  std::function<void(const std::string&)> on_recording_failure{};
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
  explicit Session(scene::Scene setup, SessionOptions options = {});
  /// [setup] `Session::open(scene::load(request)).run({.recording = "press.h5"})` records a scene.
  [[nodiscard]] static Session open(scene::Scene setup, SessionOptions options = {}) {
    return Session(std::move(setup), std::move(options));
  }
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// [setup] Runs to the end and closes the recording. @param observers are told of every tick, in this order
  /// @throws InputError when the recording cannot be made, or cannot be written and there is no
  /// on_recording_failure; std::logic_error at a second call.
  RunResult run(const RunOptions& options = {}, const std::vector<haptics::TickObserver*>& observers = {});
  /// [setup] The same on a thread of its own. The session and the observers outlive what it returns.
  [[nodiscard]] std::unique_ptr<BackgroundRun> run_in_background(
      RunOptions options = {}, std::vector<haptics::TickObserver*> observers = {});

  /// [any] Stops, pauses, and resets faults of the run.
  [[nodiscard]] haptics::RunControl& control() noexcept { return control_; }
  /// [any] Takes new tissue and noise parameters for the run.
  [[nodiscard]] haptics::ParameterUpdates& updates() noexcept { return *updates_; }
  /// [any] Whether the run may be paused: no hand holds one of its devices.
  [[nodiscard]] bool may_pause() const noexcept;

  [[nodiscard]] const scene::Scene& setup() const noexcept { return setup_; }
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
  [[nodiscard]] std::unique_ptr<const haptics::SimulationWorld> prepare(const contact::Preparation& how);

  scene::Scene setup_;
  std::vector<std::unique_ptr<haptics::Device>> devices_;
  std::unique_ptr<const haptics::SimulationWorld> world_;
  std::uint64_t ticks_ = 0;
  std::unique_ptr<haptics::ParameterUpdates> updates_;
  haptics::RunControl control_;
  bool ran_ = false;
};

}  // namespace palpate::session
