#include "run/devices/devices.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/device_kinds.h"
#include "io/scene/names.h"
#include "palpate/error.h"
#include "palpate/recording.h"
#include "palpate/scripted_device.h"
#include "palpate/tool_path.h"
#include "run/devices/emulated.h"
#include "run/devices/forcedimension.h"
#include "run/devices/haply.h"
#include "run/devices/igtl.h"
#include "run/devices/replay.h"
#include "run/devices/ros.h"
#include "run/devices/touch.h"
#include "run/devices/window_device.h"
#include "run/ros/ros_node.h"

namespace palpate::devices {
namespace {

/// Reads the path file of a device and checks it for the task.
scene::ToolPath path_from(const scene::DeviceSetup& device, scene::Task task) {
  scene::ToolPath path =
      scene::read_tool_path(device.path, device.interpolation, nullptr, device.earliest_row);
  if (task == scene::Task::kPull && !path.has_gripper()) {
    throw InputError(
        fmt::format("device {}: {}: gripper: missing, a pull needs this column", device.kind, device.path));
  }
  return path;
}

std::unique_ptr<haptics::Device> open_scripted(const scene::Scene& scene, std::size_t hand,
                                               const OnWait& /*on_wait*/) {
  const scene::DeviceSetup& device = scene.devices[hand];
  const scene::ToolPath path =
      device.path.empty() ? scene::default_path(scene, hand) : path_from(device, scene.task);
  return std::make_unique<ScriptedDevice>(path.faster(device.path_speed));
}

/// The default path, delayed by kSettle. A held device gives no force until the hand has been still for a
/// while.
scene::ToolPath default_path_of_a_hand(const scene::Scene& scene, std::size_t hand) {
  constexpr double kSettle = 1.0;  // s: 0.25 s still, 0.5 s of force ramp and 0.25 s of margin
  std::vector<scene::PathRow> rows =
      scene::default_path(scene, hand).faster(scene.devices[hand].path_speed).rows();
  for (scene::PathRow& row : rows) row.time += kSettle;
  return scene::ToolPath(std::move(rows));
}

std::unique_ptr<haptics::Device> open_emulated(const scene::Scene& scene, std::size_t hand,
                                               const OnWait& /*on_wait*/) {
  const scene::DeviceSetup& device = scene.devices[hand];
  scene::ToolPath path = device.path.empty() ? default_path_of_a_hand(scene, hand)
                                             : path_from(device, scene.task).faster(device.path_speed);
  return std::make_unique<EmulatedDevice>(std::move(path), device, scene.rate_Hz);
}

std::unique_ptr<haptics::Device> open_replay(const scene::Scene& scene, std::size_t hand,
                                             const OnWait& /*on_wait*/) {
  const std::string& file = scene.devices[hand].path;
  if (file.empty()) throw InputError("device replay: needs the path of a recording");
  const record::Recording recording = record::read_recording(file);
  const std::string place = "device replay: " + file + ": ";
  if (recording.scene.rate_Hz != scene.rate_Hz) {
    throw InputError(fmt::format("{}rate_Hz = {}: must be the scene's, {}", place,
                                 shortest(recording.scene.rate_Hz), shortest(scene.rate_Hz)));
  }
  std::vector<haptics::DeviceState> samples = samples_of_hand(recording.rows, hand);
  if (samples.empty()) {
    throw InputError(fmt::format("{}has no tick of hand {}, must have at least one", place, hand));
  }
  return std::make_unique<ReplayDevice>(std::move(samples));
}

/// Opens a Haply device. Hands with the same service address take the arms of that service in order.
std::unique_ptr<haptics::Device> open_haply(const scene::Scene& scene, std::size_t hand,
                                            const OnWait& /*on_wait*/) {
  const std::string& address = scene.devices[hand].path;
  std::size_t place = 0;
  for (std::size_t other = 0; other < hand; ++other) {
    const scene::DeviceSetup& device = scene.devices[other];
    if (device.kind != "haply") continue;
    if (parse_haply_address(device.path).text() == parse_haply_address(address).text()) ++place;
  }
  return std::make_unique<HaplyDevice>(address, place);
}

/// Opens a device whose input comes from the window of a run.
template <typename WindowDevice>
std::unique_ptr<haptics::Device> open_in_window(const scene::Scene& scene, std::size_t hand,
                                                const OnWait& /*on_wait*/) {
  return std::make_unique<WindowDevice>(scene::default_path(scene, hand).at(0.0), scene.rate_Hz);
}

Probe probe_mouse(const Machine& machine) {
  std::vector<Reason> reasons = mouse_reasons(machine);
  if (!reasons.empty())
    return {"mouse", false, "needs the window of a run, or its page", true, std::move(reasons)};
  return {"mouse", true,
          "holds the tool under its pointer in the window or page of `palpate run`; the wheel presses"};
}

Probe probe_gamepad(const Machine& machine) {
  std::vector<Reason> reasons = gamepad_reasons(machine);
  if (!reasons.empty()) return {"gamepad", false, "none that a window could use", true, std::move(reasons)};
  return {"gamepad", true, "moves the tool in the window of `palpate run`: sticks, triggers, rumble"};
}

Probe probe_scripted(const Machine& /*machine*/) {
  return {"scripted", true, "follows a path from a CSV file, or one of its own onto the organ"};
}

Probe probe_emulated(const Machine& /*machine*/) {
  return {"emulated", true,
          "a hand that the force moves, computed: it wants to follow a path as scripted does"};
}

/// Refuses the device "host". Its samples come through the C interface from the program that embeds palpate.
std::unique_ptr<haptics::Device> open_host(const scene::Scene& /*setup*/, std::size_t /*hand*/,
                                           const OnWait& /*on_wait*/) {
  throw InputError(
      "device host: is the device of a program that embeds palpate (palpate.h); "
      "here it must be another kind");
}

Probe probe_host(const Machine& /*machine*/) {
  return {"host", false, "is the device of a program that embeds palpate (palpate.h)"};
}

Probe probe_replay(const Machine& /*machine*/) {
  return {"replay", true, "follows the hand of a recording (replay:run.h5)"};
}

std::unique_ptr<haptics::Device> open_forcedimension(const scene::Scene& scene, std::size_t hand,
                                                     const OnWait& /*on_wait*/) {
  std::size_t ordinal = 0;
  for (std::size_t other = 0; other < hand; ++other) {
    if (scene.devices[other].kind == "forcedimension") ++ordinal;
  }
  return std::make_unique<ForceDimensionDevice>(scene.devices[hand].path, ordinal);
}

Probe probe_connected_forcedimension(const Machine& machine) {
  Probe probe = probe_forcedimension({});
  if (!probe.available) probe.reasons = forcedimension_reasons(machine, probe.library);
  return probe;
}

Probe probe_local_haply(const Machine& machine) {
  Probe probe = probe_haply({});
  if (!probe.available) probe.reasons = haply_reasons(machine);
  return probe;
}

/// Lists the reasons even when the library is installed, because probe_touch() does not ask the library for
/// arms.
Probe probe_installed_touch(const Machine& machine) {
  Probe probe = probe_touch();
  probe.reasons = touch_reasons(machine, probe.library);
  return probe;
}

/// Opens a device outside a scene. `what` are the arguments of the device's constructor.
template <typename AnyDevice, typename... What>
OpenedDevice connected(const What&... what) {
  auto device = std::make_unique<AnyDevice>(what...);
  std::string name = device->description();
  return {std::move(device), std::move(name)};
}

OpenedDevice connect_forcedimension(const std::string& path) {
  return connected<ForceDimensionDevice>(path, std::size_t{0});
}
OpenedDevice connect_haply(const std::string& path) { return connected<HaplyDevice>(path, std::size_t{0}); }
OpenedDevice connect_touch(const std::string& name) { return connected<TouchDevice>(name); }

std::unique_ptr<haptics::Device> open_touch(const scene::Scene& scene, std::size_t hand,
                                            const OnWait& /*on_wait*/) {
  return std::make_unique<TouchDevice>(scene.devices[hand].path);
}

std::unique_ptr<haptics::Device> open_igtl(const scene::Scene& scene, std::size_t hand,
                                           const OnWait& on_wait) {
  return std::make_unique<IgtlDevice>(scene.devices[hand].path, IgtlTimes{}, on_wait);
}
OpenedDevice connect_igtl(const std::string& source) { return connected<IgtlDevice>(source); }

Probe probe_igtl(const Machine& /*machine*/) {
  return {"igtl", true, "a client's OpenIGTLink TRANSFORM messages: igtl:PORT/NAME, as in igtl:18945/Hand"};
}

std::unique_ptr<RosDevice> open_ros_topic(const std::string& topic, const OnWait& on_wait) {
  return std::make_unique<RosDevice>(ros::open_node(ros::options_of_environment()), topic,
                                     RosDevice::kOpening, on_wait);
}

OpenedDevice connect_ros(const std::string& topic) {
  auto device = open_ros_topic(topic.empty() ? default_ros_topic(0) : topic, {});
  std::string name = device->description();
  return {std::move(device), std::move(name)};
}

std::unique_ptr<haptics::Device> open_ros(const scene::Scene& scene, std::size_t hand,
                                          const OnWait& on_wait) {
  const std::string& topic = scene.devices[hand].path;
  return open_ros_topic(topic.empty() ? default_ros_topic(hand) : topic, on_wait);
}

Probe probe_ros_plugin(const Machine& /*machine*/) { return probe_ros(); }

/// Functions for one kind of device.
struct Kind {
  std::string_view name;
  std::unique_ptr<haptics::Device> (*open)(const scene::Scene& scene, std::size_t hand,
                                           const OnWait& on_wait);
  Probe (*probe)(const Machine& machine);
  OpenedDevice (*connect)(const std::string& path);  // null: not hardware that a run can connect to
};

constexpr Kind kKinds[] = {
    {"scripted", open_scripted, probe_scripted, nullptr},
    {"replay", open_replay, probe_replay, nullptr},
    {"emulated", open_emulated, probe_emulated, nullptr},
    {"mouse", open_in_window<MouseDevice>, probe_mouse, nullptr},
    {"gamepad", open_in_window<GamepadDevice>, probe_gamepad, nullptr},
    {"forcedimension", open_forcedimension, probe_connected_forcedimension, connect_forcedimension},
    {"haply", open_haply, probe_local_haply, connect_haply},
    {"touch", open_touch, probe_installed_touch, connect_touch},
    {"igtl", open_igtl, probe_igtl, connect_igtl},
    {"ros", open_ros, probe_ros_plugin, connect_ros},
    {"host", open_host, probe_host, nullptr},
};

const Kind* find_kind(std::string_view name) noexcept {
  const Kind* found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [name](const Kind& kind) { return kind.name == name; });
  return found == std::end(kKinds) ? nullptr : found;
}

/// Lists the kinds that a run can open, as in "scripted, replay or haply".
/// @param connected lists only the kinds that have a `connect` function
std::string names_of_kinds(bool connected) {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) {
    if (kind.open == open_host) continue;
    if (!connected || kind.connect != nullptr) names.emplace_back(kind.name);
  }
  return scene::alternatives(names);
}

}  // namespace

std::unique_ptr<haptics::Device> open_device(const scene::Scene& scene, std::size_t hand,
                                             const OnWait& on_wait) {
  if (hand >= scene.devices.size()) {
    throw InputError(fmt::format("hand {}: the scene has only {} devices", hand, scene.devices.size()));
  }
  const std::string& name = scene.devices[hand].kind;
  if (const Kind* kind = find_kind(name)) return kind->open(scene, hand, on_wait);
  throw InputError(fmt::format("device kind = \"{}\": must be {}", name, names_of_kinds(false)));
}

std::vector<Probe> probe_devices(const Machine& machine) {
  std::vector<Probe> probes;
  for (const scene::DeviceKind& known : scene::device_kinds()) {
    Probe probe{std::string(known.name), false, "this version of palpate cannot open it"};
    if (const Kind* kind = find_kind(known.name)) probe = kind->probe(machine);
    probes.push_back(std::move(probe));
  }
  return probes;
}

OpenedDevice open_connected(const std::string& what) {
  const std::size_t colon = what.find(':');
  const Kind* kind = find_kind(what.substr(0, colon));
  if (kind == nullptr || kind->connect == nullptr) {
    throw InputError("device \"" + what + "\": must be " + names_of_kinds(true) + ", alone or with :PATH");
  }
  return kind->connect(colon == std::string::npos ? std::string() : what.substr(colon + 1));
}

OpenedDevice open_for_test(const std::string& what, double rate_Hz) {
  if (what != "emulated") return open_connected(what);
  scene::DeviceSetup setup;
  setup.kind = what;
  const scene::PathRow still{0.0, Vec3::Zero(), Quat::Identity(), 0.0};
  return {std::make_unique<EmulatedDevice>(scene::ToolPath({still}), setup, rate_Hz),
          "emulated device in an emulated hand", false};
}

}  // namespace palpate::devices
