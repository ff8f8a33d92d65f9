#include "palpate/session.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/text.h"
#include "io/record/flight_recorder.h"
#include "io/record/recorder.h"
#include "io/scene/default_path.h"
#include "io/scene/make_world.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "run/devices/devices.h"
#include "run/realtime/loop.h"
#include "run/session/statistics_observer.h"

namespace palpate::session {
namespace {

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

RunResult result_of(const scene::Scene& scene, bool offline) {
  RunResult result;
  result.scene = scene.name;
  result.rate_Hz = scene.rate_Hz;
  result.seed = scene.seed;
  result.hands = scene.tools.size();
  result.scene_remarks = scene.repairs;
  append(result.scene_remarks, scene.remarks);
  result.offline = offline;
  return result;
}

/// Writes the ticks before a fault to a file. A file that cannot be written is a remark, not an error.
void write_flight_recording(const record::FlightRecorder& flight, RunResult& result) {
  try {
    result.fault_recording = record::write_flight_recording(flight, result.loop);
  } catch (const InputError& failure) {
    result.loop.remarks.push_back(std::string("the ticks before the fault were not kept: ") + failure.what());
  }
}

/// Closes the recording. If the user was warned during the run, a failure is part of the result; else it is
/// thrown.
void close_recording(record::Recorder& recorder, const RunOptions& options, RunResult& result) try {
  recorder.finish(result.loop);
} catch (const InputError& failure) {
  if (!options.on_recording_failure) throw;
  result.recording_failure = failure.what();
}

}  // namespace

std::uint64_t ticks_in(double duration_s, double rate_Hz, const std::string& name, double most) {
  const double ticks = std::round(duration_s * rate_Hz);
  if (!(duration_s > 0.0) || !(ticks <= most)) {
    throw ParameterError(name, duration_s, "> 0 and at most " + shortest(most / rate_Hz));
  }
  return static_cast<std::uint64_t>(ticks);
}

Session::Session(scene::Scene scene, SessionOptions options)
    : scene_(std::move(scene)),
      devices_(std::move(options.devices)),
      world_(prepare(options.preparation)),
      updates_(scene::make_parameter_updates(scene_, *world_)),
      control_(updates_.get()) {
  if (options.duration_s) {
    ticks_ = ticks_in(*options.duration_s, scene_.rate_Hz);
  } else {
    for (const auto& device : devices_) ticks_ = std::max(ticks_, device->last_tick(scene_.rate_Hz));
  }
  append(scene_.remarks, scene::radius_remarks(scene_, *world_));
  append(scene_.remarks, scene::overlap_remarks(scene_));
  append(scene_.remarks, scene::stability_remarks(scene_, *world_));
}

Session::~Session() = default;

bool Session::may_pause() const noexcept { return realtime::stall_limit_ns(*world_) == 0; }

/// Prepares the organ, which may take seconds, then opens the devices and adapts the scene to their
/// abilities.
std::unique_ptr<const haptics::SimulationWorld> Session::prepare(const contact::Preparation& how) {
  scene_.store = how.store;
  auto world = std::make_unique<haptics::SimulationWorld>(scene::make_world(scene_, how));
  if (devices_.empty()) {
    const auto on_wait = [&how] {
      if (how.progress) how.progress(1.0, "waiting for the device");
    };
    for (std::size_t hand = 0; hand < scene_.devices.size(); ++hand) {
      devices_.push_back(devices::open_device(scene_, hand, on_wait));
    }
    append(scene_.remarks, scene::default_path_remarks(scene_));
  }
  if (devices_.size() != hands()) throw std::invalid_argument("Session: there must be one device a hand");
  for (std::size_t hand = 0; hand < hands(); ++hand) {
    scene_.devices[hand].abilities = devices_[hand]->abilities();
  }
  append(scene_.remarks, scene::apply_device_abilities(scene_, *world));
  return world;
}

RunResult Session::run(const RunOptions& options, const std::vector<haptics::TickObserver*>& observers) {
  if (ran_) throw std::logic_error("Session::run: a session runs once; open another one");
  std::vector<haptics::TickObserver*> all;
  std::optional<record::Recorder> recorder;
  std::optional<record::FlightRecorder> flight;
  if (!options.recording.empty()) {
    const std::vector<NamedFile> outputs = {{"the recording", options.recording}};
    std::vector<NamedFile> inputs;
    for (const scene::SourceFile& file : scene_.files) inputs.push_back({file.named_by, file.path});
    require_no_overwrite(outputs, inputs);
    all.push_back(&recorder.emplace(options.recording, scene_, options.offline, options.on_recording_failure,
                                    options.study));
  } else if (options.keep_fault) {
    all.push_back(&flight.emplace(scene_, options.study));
  }
  StatisticsObserver statistics(scene_);
  all.push_back(&statistics);
  all.insert(all.end(), observers.begin(), observers.end());
  std::vector<haptics::Device*> devices;
  for (const auto& device : devices_) devices.push_back(device.get());

  ran_ = true;
  haptics::SimulationState state(*world_);
  RunResult result = result_of(scene_, options.offline);
  result.loop = realtime::run_loop(*world_, state, devices, all,
                                   {.ticks = ticks_,
                                    .offline = options.offline,
                                    .control = &control_,
                                    .thread = options.thread,
                                    .stalled_after_ns = realtime::stall_limit_ns(*world_)});
  if (recorder) close_recording(*recorder, options, result);
  if (flight && flight->fault_met()) write_flight_recording(*flight, result);
  result.statistics = statistics.statistics();
  return result;
}

std::unique_ptr<BackgroundRun> Session::run_in_background(RunOptions options,
                                                          std::vector<haptics::TickObserver*> observers) {
  return std::make_unique<BackgroundRun>(
      control_, [this, options = std::move(options), observers = std::move(observers)] {
        return run(options, observers);
      });
}

}  // namespace palpate::session
