#include <string>
#include <utility>

#include "io/scene/device_kinds.h"
#include "io/scene/make_world.h"
#include "io/system/path_text.h"
#include "palpate/organ_cache.h"
#include "palpate/scene.h"
#include "palpate/scripted_device.h"
#include "palpate/tool_path.h"
#include "run/devices/devices.h"

#include "bindings/c/errors.h"
#include "bindings/c/simulation.h"

namespace palpate::c_interface {
namespace {

contact::Preparation preparation_of(const palpate_options& options) {
  contact::Preparation how;
  if (options.no_cache == 0) scene::use_organ_cache(how);
  if (options.progress != nullptr) {
    how.progress = [tell = options.progress, user = options.progress_user](
                       double share, const std::string& what) { tell(share, what.c_str(), user); };
  }
  return how;
}

/// Source of palpate_scripted_sample(): a replay, the scene's path, or the default path.
std::unique_ptr<haptics::Device> scripted_device(const scene::Scene& scene, std::size_t hand) {
  const scene::DeviceSetup& device = scene.devices[hand];
  if (device.kind == "replay") return devices::open_device(scene, hand);
  const bool has_path =
      !device.path.empty() && scene::find_device_kind(device.kind)->path == scene::DevicePath::kToolPath;
  const scene::ToolPath path = has_path ? scene::read_tool_path(to_path(device.path), device.interpolation,
                                                                nullptr, device.earliest_row)
                                        : scene::default_path(scene, hand);
  return std::make_unique<devices::ScriptedDevice>(path.faster(device.path_speed));
}

}  // namespace

scene::Overrides request_of(const palpate_options& options) {
  scene::Overrides request;
  if (options.scene_file != nullptr && options.scene_text != nullptr) {
    throw UseError("palpate_options: scene_file and scene_text are both given, must be at most one");
  }
  if (options.scene_file != nullptr) request.scene = to_path(options.scene_file);
  if (options.scene_text != nullptr) {
    request.scene_text = {options.scene_text,
                          to_path(options.scene_folder == nullptr ? "" : options.scene_folder)};
  }
  if (options.task != nullptr) request.task = options.task;
  return request;
}

Loaded load(const palpate_options& options, const scene::Overrides& request) {
  if (!(options.surface_edge >= 0.0) || options.surface_edge > 1.0) {
    throw ParameterError("palpate_options.surface_edge", options.surface_edge, "0, or at most 1 m");
  }
  if (options.surface_edge > 0.0 && options.surface_edge < 1e-4) {
    throw ParameterError("palpate_options.surface_edge", options.surface_edge, "0, or at least 1e-4 m");
  }
  const contact::Preparation how = preparation_of(options);
  scene::Overrides with_cache = request;
  with_cache.store = how.store;
  return load(scene::load(with_cache), how, options.no_hand != 0);
}

Loaded load(scene::Scene scene, const contact::Preparation& how, bool no_hand) {
  std::vector<std::unique_ptr<haptics::Device>> scripted;
  for (std::size_t hand = 0; hand < scene.devices.size(); ++hand) {
    scripted.push_back(scripted_device(scene, hand));
  }
  // The tick, the recording and its replay depend on whether a hand holds the device.
  for (scene::DeviceSetup& device : scene.devices) {
    if (!no_hand && !scene::find_device_kind(device.kind)->held) device.kind = "host";
  }
  for (std::string& remark : scene::overlap_remarks(scene)) scene.remarks.push_back(std::move(remark));
  haptics::SimulationWorld world = scene::make_world(scene, how);
  scene.store = how.store;
  for (std::string& remark : scene::stability_remarks(scene, world)) {
    scene.remarks.push_back(std::move(remark));
  }
  return {std::move(scene), std::move(scripted), std::move(world)};
}

}  // namespace palpate::c_interface
