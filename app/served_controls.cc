// What clients of `palpate serve`, and above all the page of `palpate run --page`, control besides the scene:
// the device, its mouse or gamepad, and a recording.
#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "io/scene/device_kinds.h"
#include "io/system/clock.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "run/devices/devices.h"

#include "app/messages.h"
#include "app/served_devices.h"
#include "app/served_runs.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;
using net::LiveError;

/// KIND or KIND:PATH, as on the command line.
std::string text_of(const scene::DeviceSetup& device) {
  return device.path.empty() ? device.kind : device.kind + ":" + device.path;
}

}  // namespace

/// Devices that `start` can name: that of the command line, and those that need no path. Not during a run,
/// because a maker's library is asked.
ServedRuns::Answer ServedRuns::devices() {
  if (running()) throw LiveError("state", "devices: a run is in progress; stop it first");
  const std::string own = text_of(own_devices_.front());
  Json list = Json::array();
  list.push_back({{"device", own},
                  {"available", true},
                  {"words", own_device_flag_ ? "chosen by --device" : "the scene's own"}});
  if (own_devices_.size() > 1) return Json{{"devices", list}};  // a scene of several hands names them itself
  for (const devices::Probe& probe : devices::probe_devices()) {
    const scene::DeviceKind& kind = *scene::find_device_kind(probe.kind);
    const bool needs_path =
        kind.path == scene::DevicePath::kRecording || kind.path == scene::DevicePath::kClient;
    if (needs_path || probe.kind == own || probe.kind == "host") continue;
    if (!options_.page && !is_made_up(probe.kind)) continue;
    const std::string text = probe.kind == "mouse"     ? "the tool is under the pointer in the picture"
                             : probe.kind == "gamepad" ? "one at the browser's computer"
                                                       : probe.text;
    list.push_back({{"device", probe.kind}, {"available", kind.window || probe.available}, {"words", text}});
  }
  return Json{{"devices", list}};
}

/// The value of --device for a device that a client chose. @throws LiveError
std::optional<std::string> ServedRuns::device_flag(const std::string& wanted) const {
  if (wanted == text_of(own_devices_.front())) return own_device_flag_;
  if (!options_.page) require_made_up(wanted);
  if (wanted.find(':') != std::string::npos) {
    throw LiveError("refused", "device = \"" + wanted + "\": must be a kind without a path", "device");
  }
  return wanted;
}

Json ServedRuns::about_recording() const {
  const bool writing = tape_ != nullptr ? tape_->writing() : running() && !run_->recording().empty();
  const std::filesystem::path& file = tape_ != nullptr ? tape_->file() : run_->recording();
  Json json{{"recording", file.empty() ? Json(nullptr) : Json(to_text(file))}, {"writing", writing}};
  if (!recording_failure_.empty()) json["recording_failure"] = recording_failure_;
  return json;
}

/// Begins or ends a recording of the run in a new file of the current folder. The run goes on.
ServedRuns::Answer ServedRuns::record(bool on) {
  (void)newest_snapshot("record");
  if (tape_ == nullptr) {
    throw LiveError("state",
                    run_->recording().empty()
                        ? "record: this server records only with --record FILE.h5"
                        : "record: --record records whole runs, this one in " + to_text(run_->recording()));
  }
  if (on && !tape_->writing()) {
    recording_failure_.clear();
    tape_->begin(free_name(named_by_time(".h5"), true), run_->observer().rows.started_unix_ns());
    send_event("recording", about_recording());
  }
  if (!on) end_recording();
  return about_recording();
}

void ServedRuns::end_recording() {
  if (tape_ == nullptr || !tape_->writing()) return;
  try {
    const std::optional<RunResult> result = accounted_ ? run_->result() : std::nullopt;
    tape_->end(result ? &result->loop : nullptr);
    report_message("recorded in " + to_text(tape_->file()));
  } catch (const InputError& error) {
    recording_failure_ = error.what();
    failed_ = true;
    report_error(recording_failure_);
  }
  send_event("recording", about_recording());
}

/// Keeps new rows, and passes them to the recording, which ends with its run.
void ServedRuns::poll_recording() {
  if (tape_ == nullptr) return;
  haptics::TickRow row;
  while (run_->observer().rows.take(row)) tape_->add(row);
  haptics::ParameterUpdate update;
  while (run_->observer().rows.take(update)) tape_->add(update);
  if (!tape_->writing()) return;
  const bool all = tape_->feed();
  if ((accounted_ && all) || !tape_->failure().empty()) end_recording();
}

ServedRuns::Answer ServedRuns::steer(const net::SteerMouse& input) {
  const auto mouse = std::find_if(mice_.begin(), mice_.end(),
                                  [&input](const MouseHand& one) { return one.hand() == input.hand; });
  if (mouse == mice_.end()) {
    throw LiveError("state", fmt::format("mouse: the device of hand {} is no mouse of a page", input.hand));
  }
  if (input.ray_W) mouse->rider().point_at(*input.ray_W);
  if (input.elsewhere) mouse->rider().freeze();
  if (input.deeper != 0.0) mouse->rider().press(input.deeper);
  if (input.grip) mouse->grip(*input.grip);
  if (input.park) mouse->rider().park(*input.park);
  return Json::object();
}

ServedRuns::Answer ServedRuns::steer(const net::SteerGamepad& input) {
  const auto pad = std::find_if(pads_.begin(), pads_.end(),
                                [&input](const PagePad& one) { return one.hand.hand() == input.hand; });
  if (pad == pads_.end()) {
    throw LiveError("state",
                    fmt::format("gamepad: the device of hand {} is no gamepad of a page", input.hand));
  }
  pad->state = {input.way_W, input.press, input.close, input.buttons};
  pad->heard_ns = monotonic_ns();
  return Json::object();
}

/// Ticks a second, measured over a second.
void ServedRuns::measure_rate() {
  constexpr std::int64_t kMeasured = 1'000'000'000;  // ns
  const haptics::Snapshot& newest = run_->snapshots().value();
  const std::int64_t time = newest.taken_ns - rate_ns_;
  if (newest.hands == 0 || (rate_ns_ != 0 && time < kMeasured)) return;
  if (rate_ns_ != 0)
    rate_Hz_ = 1e9 * static_cast<double>(newest.tick - rate_tick_) / static_cast<double>(time);
  rate_tick_ = newest.tick;
  rate_ns_ = newest.taken_ns;
}

/// Moves the tools of mice and gamepads on. Without messages of a page a mouse's tool goes to where it was
/// sent and stays there; a gamepad's tool stops, later with the fault of an unplugged one.
void ServedRuns::move_hands() {
  constexpr std::int64_t kReleased = 300'000'000;     // ns without a message: the sticks count as released,
  constexpr std::int64_t kUnplugged = 3'000'000'000;  // and then the gamepad as unplugged
  const std::int64_t now = monotonic_ns();
  const double time = 1e-9 * static_cast<double>(now - std::exchange(moved_hands_ns_, now));
  for (MouseHand& mouse : mice_) mouse.update(run_->snapshots().value(), time, 1.0, 0);
  for (PagePad& pad : pads_) {
    if (pad.heard_ns == 0) continue;
    const std::int64_t silent = now - pad.heard_ns;
    if (silent > kReleased) pad.state.way_W.setZero();
    pad.hand.update(silent < kUnplugged ? &pad.state : nullptr, 0);
  }
}

}  // namespace palpate::app
