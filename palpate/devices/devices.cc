#include "palpate/devices/devices.h"

#include "palpate/base/error.h"
#include "palpate/base/text.h"
#include "palpate/devices/haply.h"
#include "palpate/devices/replay.h"
#include "palpate/devices/scripted.h"
#include "palpate/record/recording.h"
#include "palpate/scene/tool_path.h"

namespace palpate::devices {
namespace {

std::unique_ptr<haptics::Device> open_scripted(const scene::Setup& setup, std::size_t hand) {
  const std::string& file = setup.devices[hand].path;
  if (file.empty()) return std::make_unique<ScriptedDevice>(scene::default_path(setup, hand));
  scene::ToolPath path = scene::read_tool_path(file);
  if (setup.task == scene::Task::kPull && !path.has_gripper()) {
    throw InputError("device scripted: " + file + ": gripper: missing, a pull needs this column");
  }
  return std::make_unique<ScriptedDevice>(std::move(path));
}

std::unique_ptr<haptics::Device> open_replay(const scene::Setup& setup, std::size_t hand) {
  const std::string& file = setup.devices[hand].path;
  if (file.empty()) throw InputError("device replay: needs the path of a recording");
  const record::Recording recording = record::read_recording(file);
  const std::string place = "device replay: " + file + ": ";
  if (recording.setup.rate_Hz != setup.rate_Hz) {
    throw InputError(place + "rate_Hz = " + shortest(recording.setup.rate_Hz) + ": must be the scene's, " +
                     shortest(setup.rate_Hz));
  }
  std::vector<haptics::DeviceState> samples = samples_of_hand(recording.rows, hand);
  if (samples.empty()) {
    throw InputError(place + "has no tick of hand " + std::to_string(hand) + ", must have at least one");
  }
  return std::make_unique<ReplayDevice>(std::move(samples));
}

/// Hands that name the same service take its arms in order.
std::unique_ptr<haptics::Device> open_haply(const scene::Setup& setup, std::size_t hand) {
  const std::string& address = setup.devices[hand].path;
  std::size_t place = 0;
  for (std::size_t other = 0; other < hand; ++other) {
    const scene::DeviceSetup& device = setup.devices[other];
    if (device.kind != "haply") continue;
    if (parse_haply_address(device.path).text() == parse_haply_address(address).text()) ++place;
  }
  return std::make_unique<HaplyDevice>(address, place);
}

}  // namespace

std::unique_ptr<haptics::Device> open_device(const scene::Setup& setup, std::size_t hand) {
  if (hand >= setup.devices.size()) {
    throw InputError("hand " + std::to_string(hand) + ": the scene has only " +
                     std::to_string(setup.devices.size()) + " devices");
  }
  const std::string& kind = setup.devices[hand].kind;
  if (kind == "scripted") return open_scripted(setup, hand);
  if (kind == "replay") return open_replay(setup, hand);
  if (kind == "haply") return open_haply(setup, hand);
  throw InputError("device kind = \"" + kind + "\": must be scripted, replay or haply");
}

}  // namespace palpate::devices
