#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
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
#include "palpate/recording.h"
#include "palpate/run_control.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"

namespace palpate::haptics {
struct SimulationWorld;
}

namespace palpate::session {

/// Consecutive ticks of one hand in one phase.
struct PhaseSpan {
  std::uint32_t hand = 0;
  std::uint32_t phase = 0;  // contact::Phase
  double from = 0.0;        // s
  double to = 0.0;          // s, of the first tick after the span
};

/// Peaks and counts over the rows of a run.
struct RunStatistics {
  static constexpr std::size_t kMaxSpans = 256;

  double peak_force = 0.0;     // N, at the device, after the gate
  double peak_tissue = 0.0;    // N, tissue force before the gate
  double peak_depth = 0.0;     // m
  double depth_at_peak = 0.0;  // m, at the tick of peak_tissue
  double fastest_rise = 0.0;   // N/s, largest rise of a hand's tissue force from one tick to the next
  double loading_work = 0.0;   // J: largest work of the hands against the device forces; without torques
  double dissipated = 0.0;     // J: work of the hands that was not returned by the end of the run
  std::uint64_t deepest_tick = 0;
  std::uint32_t deepest_hand = 0;
  std::uint64_t contact_ticks = 0;                           // ticks with a hand pressing or pulling
  double nearest = std::numeric_limits<double>::infinity();  // m, of a tool to the organ without contact
  std::uint64_t limited_ticks = 0;    // ticks in which the gate limited a force or torque
  std::uint32_t status = 0;           // bitwise OR of all ticks' status bits
  std::uint64_t changes = 0;          // number of parameter updates during the run
  std::vector<PhaseSpan> phases;      // in the order of their start; at most kMaxSpans
  std::uint64_t phases_left_out = 0;  // number of spans that `phases` omits
};

/// Result of a run.
struct RunResult {
  std::string scene;  // name of the scene
  double rate_Hz = 0.0;
  std::uint64_t seed = 0;
  std::size_t hands = 0;
  std::vector<std::string> scene_remarks;  // repairs of the meshes, and warnings
  bool offline = false;
  haptics::LoopReport loop;
  RunStatistics statistics;
  std::filesystem::path fault_recording;  // last ticks before a fault of an unrecorded run; empty: no file
  std::string recording_failure;          // file, last row and cause; empty: the recording is complete
};

/// A run on its own thread. All members are [any] unless noted. Do not call them from the tick.
class BackgroundRun final {
 public:
  /// [setup] Starts the thread. @param control of the run; must outlive this object @param run executes the
  /// run, on the new thread
  BackgroundRun(haptics::RunControl& control, std::function<RunResult()> run);
  /// Ends the run: sets zero force, closes the recording and joins the thread.
  ~BackgroundRun();
  BackgroundRun(const BackgroundRun&) = delete;
  BackgroundRun& operator=(const BackgroundRun&) = delete;

  /// Requests the end of the run before its next tick. Returns at once.
  void stop() noexcept { control_.stop(); }
  /// Waits until the run has ended, its force is zero and its recording is closed.
  void wait();
  /// Waits for the end of the run, at most for `time`. @return whether the run has ended
  [[nodiscard]] bool wait_for(std::chrono::milliseconds time) const;
  [[nodiscard]] bool ended() const { return wait_for(std::chrono::milliseconds(0)); }

  /// After the end: the result of the run; empty when it failed.
  [[nodiscard]] const std::optional<RunResult>& result() const noexcept { return result_; }
  /// After the end: the cause of the failure; empty when the run succeeded.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  haptics::RunControl& control_;
  std::optional<RunResult> result_;
  std::string failure_;
  mutable std::mutex mutex_;  // guards ended_
  mutable std::condition_variable changed_;
  bool ended_ = false;
  std::mutex joining_;
  std::thread thread_;  // last member: the thread uses all members above
};

/// Options of a session.
struct SessionOptions {
  // s: the run has round(duration_s x rate) ticks; empty: it ends when the devices have no more samples
  std::optional<double> duration_s{};
  contact::Preparation preparation{};                       // of the organ: cache and progress reports
  std::vector<std::unique_ptr<haptics::Device>> devices{};  // one per hand; empty: the devices of the scene
};

/// Options of a run.
struct RunOptions {
  std::filesystem::path recording{};  // HDF5 file of all ticks; empty: no recording
  bool offline = false;               // true: runs as fast as possible, with the same rows
  haptics::LoopThread thread{};       // settings of the loop's thread
  // Without a recording: writes the last seconds before a fault to a file in the user's state folder.
  bool keep_fault = true;
  record::StudyMark study{};  // that the run belongs to; its recording is blind
  // Called once, on the recorder's thread, when the recording can no longer be written. The text names the
  // file, the number of rows that are safely in it, and the cause. The run continues, and run() returns with
  // recording_failure set. Without this function run() throws at the end of the run.
  std::function<void(const std::string&)> on_recording_failure{};
};

/// [setup] Number of ticks in a duration [s]. @param name of the duration in the error message
/// @throws ParameterError unless it is > 0 and at most `most` ticks long (1e12: 30 years at 1 kHz).
[[nodiscard]] std::uint64_t ticks_in(double duration_s, double rate_Hz,
                                     const std::string& name = "duration_s", double most = 1e12);

/// A scene that is ready to run, with its prepared organ, its devices and the controls of the run. It runs
/// once.
class Session final {
 public:
  /// [setup] Prepares the organ and opens the devices. It adds warnings to the scene's remarks: a tool tip
  /// whose size differs from the indenter that the tissue was fitted with, or a device that may be unstable.
  /// @throws InputError, ParameterError.
  explicit Session(scene::Scene scene, SessionOptions options = {});
  /// [setup] Returns a session: `Session::open(scene::load(request)).run({.recording = "press.h5"})` records
  /// a scene. @throws InputError, ParameterError.
  [[nodiscard]] static Session open(scene::Scene scene, SessionOptions options = {}) {
    return Session(std::move(scene), std::move(options));
  }
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// [setup] Runs to the end and closes the recording. @param observers receive every tick, in this order
  /// @throws InputError when the recording cannot be created, or when writing it fails and
  /// on_recording_failure is empty; std::logic_error at a second call.
  RunResult run(const RunOptions& options = {}, const std::vector<haptics::TickObserver*>& observers = {});
  /// [setup] Runs on a new thread and returns at once. The session and the observers must outlive the
  /// returned object. BackgroundRun::failure() reports the errors that run() throws.
  [[nodiscard]] std::unique_ptr<BackgroundRun> run_in_background(
      RunOptions options = {}, std::vector<haptics::TickObserver*> observers = {});

  /// [any] Stops and pauses the run, and resets its faults.
  [[nodiscard]] haptics::RunControl& control() noexcept { return control_; }
  /// [any] Takes new tissue and noise parameters for the run.
  [[nodiscard]] haptics::ParameterUpdates& updates() noexcept { return *updates_; }
  /// [any] Whether the run may be paused: no hand holds one of its devices.
  [[nodiscard]] bool may_pause() const noexcept;

  [[nodiscard]] const scene::Scene& scene() const noexcept { return scene_; }
  /// [any] The prepared world, for palpate's own windows; the public headers do not define its type.
  [[nodiscard]] const haptics::SimulationWorld& world() const noexcept { return *world_; }
  [[nodiscard]] std::size_t hands() const noexcept { return scene_.tools.size(); }
  /// [any] Number of ticks of the run; 2^64-1: it runs until it is stopped.
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  /// [any] One device per hand; empty after close_devices().
  [[nodiscard]] const std::vector<std::unique_ptr<haptics::Device>>& devices() const noexcept {
    return devices_;
  }
  /// [setup] Closes the devices, so that another session can open them. Do not call it during a run.
  void close_devices() { devices_.clear(); }

 private:
  [[nodiscard]] std::unique_ptr<const haptics::SimulationWorld> prepare(const contact::Preparation& how);

  scene::Scene scene_;
  std::vector<std::unique_ptr<haptics::Device>> devices_;
  std::unique_ptr<const haptics::SimulationWorld> world_;
  std::uint64_t ticks_ = 0;
  std::unique_ptr<haptics::ParameterUpdates> updates_;
  haptics::RunControl control_;
  bool ran_ = false;
};

}  // namespace palpate::session
