#include "io/scene/scene_request.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/scene/device_kinds.h"
#include "io/scene/names.h"
#include "io/scene/organ_motion_reader.h"
#include "io/scene/scene_keys.h"
#include "io/scene/variation_reader.h"
#include "io/system/path_text.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

constexpr double kFlagJawOpening = 15.0 * portable::kPi / 180.0;  // rad

LocatedString flag(const std::string& name, const std::string& value) { return {value, name, {}, true}; }

Task task_of(const Overrides& request, Task otherwise) {
  return request.task ? parse_task(flag("--task", *request.task)) : otherwise;
}

/// The scene of a run without a scene file.
SceneFile default_scene(Task task) {
  SceneFile scene_file;
  struct Default {
    const char* organ;
    const char* tool;
  };
  const Default made = task == Task::kPress    ? Default{"gallbladder", "curved-forceps"}
                       : task == Task::kPull   ? Default{"heart", "straight-forceps"}
                       : task == Task::kInsert ? Default{"box", "needle"}
                                               : Default{"liver", "sphere:5"};
  scene_file.task = task;
  scene_file.search = read_search({});
  scene_file.organ = LocatedString{made.organ, "organ", {}};
  ToolTable tool;
  tool.mesh = LocatedString{made.tool, "tool", {}};
  scene_file.tools.push_back(std::move(tool));
  return scene_file;
}

ToolTable tool_from_flags(const std::vector<std::string>& files) {
  ToolTable tool;
  if (files.size() == 1) {
    tool.mesh = flag("--tool", files.front());
    return tool;
  }
  tool.jaws_by_flags = true;
  for (const std::string& file : files) {
    JawTable jaw;
    jaw.mesh = flag("--tool", file);
    jaw.open_angle = kFlagJawOpening;
    tool.jaws.push_back(std::move(jaw));
  }
  return tool;
}

void override_meshes(const Overrides& request, SceneFile& scene_file) {
  if (request.organ) {
    scene_file.organ = flag("--organ", *request.organ);
    scene_file.organ_unit.reset();
    scene_file.organ_frame.reset();
  }
  if (request.organ_unit) scene_file.organ_unit = parse_unit(flag("--organ-unit", *request.organ_unit));
  if (request.organ_frame) {
    scene_file.organ_frame = parse_organ_frame(flag("--organ-frame", *request.organ_frame));
  }
  if (!request.organ_motion.empty()) scene_file.organ_motion = organ_motions_by_flags(request.organ_motion);
  if (!request.organ_support.empty()) scene_file.support = support_by_flags(request.organ_support);
  if (!request.inclusions.empty()) scene_file.inclusions = inclusions_by_flags(request.inclusions);
  if (request.tissue) scene_file.tissue = flag("--tissue", *request.tissue);
  if (!request.tools.empty()) {
    if (scene_file.tools.size() > 1) {
      flag("--tool", request.tools.front())
          .fail("the scene has several tools, change them in the scene file");
    }
    scene_file.tools = {tool_from_flags(request.tools)};
  }
  if (request.tool_unit) {
    const LengthUnit unit = parse_unit(flag("--tool-unit", *request.tool_unit));
    for (ToolTable& tool : scene_file.tools) tool.unit = unit;
  }
}

void override_device(const std::string& text, SceneFile& scene_file) {
  if (scene_file.tools.size() > 1 || scene_file.devices.size() > 1) {
    flag("--device", text).fail("the scene has several hands, change their devices in the scene file");
  }
  if (scene_file.devices.empty()) scene_file.devices.emplace_back();
  DeviceTable& device = scene_file.devices.front();
  const std::size_t colon = text.find(':');
  device.kind = flag("--device", text.substr(0, colon));
  device.path.reset();
  if (colon == std::string::npos) return;
  device.path = flag("--device", text.substr(colon + 1));
  if (device.path->value.empty()) flag("--device", text).fail("must be KIND or KIND:PATH");
}

void override_numbers(const Overrides& request, SceneFile& scene_file) {
  if (request.rate_Hz) {
    const double rate = *request.rate_Hz;
    if (!(rate >= kSlowestRate && rate <= kFastestRate)) {
      throw ParameterError("--rate-Hz", rate,
                           "a number >= " + shortest(kSlowestRate) + " and <= " + shortest(kFastestRate));
    }
    scene_file.rate_Hz = rate;
  }
  if (request.seed) scene_file.seed = *request.seed;
  if (request.no_noise) scene_file.noise.enabled = false;
  if (request.fit_device) {
    for (DeviceTable& device : scene_file.devices) device.setup.fit = true;
  }
}

/// Rejects a path outside `folder` before the file is opened, so that neither its content nor its existence
/// leaks.
void require_below(const std::filesystem::path& folder, const LocatedString& file) {
  std::error_code error;
  const std::filesystem::path root = std::filesystem::weakly_canonical(folder, error);
  const std::filesystem::path inside =
      error ? root : std::filesystem::weakly_canonical(file.file(), error).lexically_relative(root);
  if (error || inside.empty() || *inside.begin() == "..")
    file.fail("must be a file below " + to_text(folder));
}

/// Requires all files that the scene names to be inside the folder of the request.
void require_files_below(const std::filesystem::path& folder, const SceneFile& scene_file) {
  std::vector<const LocatedString*> named;
  const auto add = [&named](const std::optional<LocatedString>& name) {
    if (name && is_path(name->value)) named.push_back(&*name);
  };
  add(scene_file.organ);
  add(scene_file.tissue);
  if (scene_file.stiffness_map) named.push_back(&*scene_file.stiffness_map);
  for (const ToolTable& tool : scene_file.tools) {
    add(tool.mesh);
    for (const JawTable& jaw : tool.jaws) named.push_back(&jaw.mesh);
  }
  for (const DeviceTable& device : scene_file.devices) {
    const DeviceKind* kind = find_device_kind(device.kind.value);
    const bool is_file = kind == nullptr || names_file(kind->path);
    if (device.path && is_file) named.push_back(&*device.path);
  }
  std::optional<LocatedString> painted;
  if (scene_file.support && !scene_file.support->painted.empty()) {
    painted = LocatedString{to_text(scene_file.support->painted), scene_file.support->where + ".painted", {}};
    named.push_back(&*painted);
  }
  for (const LocatedString* name : named) require_below(folder, *name);
}

}  // namespace

SceneFile describe(const Overrides& request) {
  SceneFile scene_file;
  if (request.scene || request.scene_text) {
    if (request.scene && !request.files_below.empty()) {
      require_below(request.files_below, LocatedString{to_text(*request.scene), "scene", {}});
    }
    scene_file = request.scene ? read_scene_file(*request.scene, request.settings)
                               : read_scene_text(request.scene_text->toml, request.scene_text->folder,
                                                 request.settings);
    scene_file.task = task_of(request, scene_file.task);
  } else {
    if (!request.settings.empty())
      throw InputError("--set " + request.settings.front().key + ": needs a scene file");
    scene_file = default_scene(task_of(request, Task::kPress));
  }
  override_meshes(request, scene_file);
  scene_file.igtl = request.igtl;
  if (request.device) override_device(*request.device, scene_file);
  override_numbers(request, scene_file);
  if (!scene_file.organ) {
    throw InputError(fmt::format("{}: missing, must be a built-in organ ({}) or a file",
                                 scene_file.organ_location, alternatives(geometry::builtin_organ_names())));
  }
  if (scene_file.tools.empty()) {
    throw InputError(scene_file.tool_location + ": missing, must be a built-in tool (" +
                     alternatives(geometry::builtin_tool_names()) + "), sphere:R or a file; or [[tool.jaw]]");
  }
  if (!request.scene && !request.scene_text) {
    scene_file.name = to_text(to_path(scene_file.organ->value).stem()) + " " + to_string(scene_file.task);
  }
  if (!request.files_below.empty()) require_files_below(request.files_below, scene_file);
  return scene_file;
}

}  // namespace palpate::scene
