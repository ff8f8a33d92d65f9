#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "core/contact/tissue_laws.h"
#include "io/mesh_io/formats/gltf_check.h"
#include "io/scene/device_kinds.h"
#include "io/scene/emulated_reader.h"
#include "io/scene/instrument.h"
#include "io/scene/mesh_source.h"
#include "io/scene/names.h"
#include "io/scene/organ_distance.h"
#include "io/scene/organ_motion_reader.h"
#include "io/scene/scene_file.h"
#include "io/scene/scene_keys.h"
#include "io/scene/stiffness_map_reader.h"
#include "io/scene/variation_reader.h"
#include "io/system/file_exists.h"
#include "io/system/path_text.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"
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
  SceneFile scene;
  struct Default {
    const char* organ;
    const char* tool;
  };
  const Default made = task == Task::kPress  ? Default{"gallbladder", "curved-forceps"}
                       : task == Task::kPull ? Default{"heart", "straight-forceps"}
                                             : Default{"liver", "sphere:5"};
  scene.task = task;
  scene.search = read_search({});
  scene.organ = LocatedString{made.organ, "organ", {}};
  ToolTable tool;
  tool.mesh = LocatedString{made.tool, "tool", {}};
  scene.tools.push_back(std::move(tool));
  return scene;
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

void override_meshes(const Overrides& request, SceneFile& scene) {
  if (request.organ) {
    scene.organ = flag("--organ", *request.organ);
    scene.organ_unit.reset();
  }
  if (request.organ_unit) scene.organ_unit = parse_unit(flag("--organ-unit", *request.organ_unit));
  if (!request.organ_motion.empty()) scene.organ_motion = organ_motions_by_flags(request.organ_motion);
  if (!request.inclusions.empty()) scene.inclusions = inclusions_by_flags(request.inclusions);
  if (request.tissue) scene.tissue = flag("--tissue", *request.tissue);
  if (!request.tools.empty()) {
    if (scene.tools.size() > 1) {
      flag("--tool", request.tools.front())
          .fail("the scene has several tools, change them in the scene file");
    }
    scene.tools = {tool_from_flags(request.tools)};
  }
  if (request.tool_unit) {
    const LengthUnit unit = parse_unit(flag("--tool-unit", *request.tool_unit));
    for (ToolTable& tool : scene.tools) tool.unit = unit;
  }
}

void override_device(const std::string& text, SceneFile& scene) {
  if (scene.tools.size() > 1 || scene.devices.size() > 1) {
    flag("--device", text).fail("the scene has several hands, change their devices in the scene file");
  }
  if (scene.devices.empty()) scene.devices.emplace_back();
  DeviceTable& device = scene.devices.front();
  const std::size_t colon = text.find(':');
  device.kind = flag("--device", text.substr(0, colon));
  device.path.reset();
  if (colon == std::string::npos) return;
  device.path = flag("--device", text.substr(colon + 1));
  if (device.path->value.empty()) flag("--device", text).fail("must be KIND or KIND:PATH");
}

void override_numbers(const Overrides& request, SceneFile& scene) {
  if (request.rate_Hz) {
    const double rate = *request.rate_Hz;
    if (!(rate >= kSlowestRate && rate <= kFastestRate)) {
      throw ParameterError("--rate-Hz", rate,
                           "a number >= " + shortest(kSlowestRate) + " and <= " + shortest(kFastestRate));
    }
    scene.rate_Hz = rate;
  }
  if (request.seed) scene.seed = *request.seed;
  if (request.no_noise) scene.noise.enabled = false;
  if (request.fit_device) {
    for (DeviceTable& device : scene.devices) device.setup.fit = true;
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

/// Whether a device's path is a file, or a name that could be one.
bool names_file(DevicePath path) { return path != DevicePath::kAddress && path != DevicePath::kClient; }

/// Requires all files that the scene names to be inside the folder of the request.
void require_files_below(const std::filesystem::path& folder, const SceneFile& scene) {
  std::vector<const LocatedString*> named;
  const auto add = [&named](const std::optional<LocatedString>& name) {
    if (name && is_path(name->value)) named.push_back(&*name);
  };
  add(scene.organ);
  add(scene.tissue);
  if (scene.stiffness_map) named.push_back(&*scene.stiffness_map);
  for (const ToolTable& tool : scene.tools) {
    add(tool.mesh);
    for (const JawTable& jaw : tool.jaws) named.push_back(&jaw.mesh);
  }
  for (const DeviceTable& device : scene.devices) {
    const DeviceKind* kind = find_device_kind(device.kind.value);
    const bool is_file = kind == nullptr || names_file(kind->path);
    if (device.path && is_file) named.push_back(&*device.path);
  }
  for (const LocatedString* name : named) require_below(folder, *name);
}

/// The scene file, or the default scene, with the flags applied.
SceneFile describe(const Overrides& request) {
  SceneFile scene;
  if (request.scene || request.scene_text) {
    if (request.scene && !request.files_below.empty()) {
      require_below(request.files_below, LocatedString{to_text(*request.scene), "scene", {}});
    }
    scene = request.scene
                ? read_scene_file(*request.scene, request.settings)
                : read_scene_text(request.scene_text->toml, request.scene_text->folder, request.settings);
    scene.task = task_of(request, scene.task);
  } else {
    if (!request.settings.empty())
      throw InputError("--set " + request.settings.front().key + ": needs a scene file");
    scene = default_scene(task_of(request, Task::kPress));
  }
  override_meshes(request, scene);
  if (request.device) override_device(*request.device, scene);
  override_numbers(request, scene);
  if (!scene.organ) {
    throw InputError(fmt::format("{}: missing, must be a built-in organ ({}) or a file", scene.organ_location,
                                 alternatives(geometry::builtin_organ_names())));
  }
  if (scene.tools.empty()) {
    throw InputError(scene.tool_location + ": missing, must be a built-in tool (" +
                     alternatives(geometry::builtin_tool_names()) + "), sphere:R or a file; or [[tool.jaw]]");
  }
  if (!request.scene && !request.scene_text) {
    scene.name = to_text(to_path(scene.organ->value).stem()) + " " + to_string(scene.task);
  }
  return scene;
}

void load_organ(const SceneFile& scene, Scene& setup, MeshNotes& notes) {
  const LocatedString& organ = *scene.organ;
  setup.organ_name = organ.value;
  if (is_path(organ.value)) {
    setup.organ = read_organ_source(organ, scene.organ_unit, notes);
    return;
  }
  const std::vector<std::string>& known = geometry::builtin_organ_names();
  if (std::find(known.begin(), known.end(), organ.value) == known.end()) {
    const std::string near = nearest_word(organ.value, known);
    organ.fail(fmt::format("must be {}, or a file (with a / or an extension such as .stl){}",
                           alternatives(known), near.empty() ? "" : "; did you mean " + near + "?"));
  }
  setup.organ = geometry::make_organ(organ.value);
}

void load_stiffness_map(const SceneFile& scene, Scene& setup, MeshNotes& notes) {
  if (!scene.stiffness_map) return;
  StiffnessMapOptions options = scene.stiffness_map_options;
  options.unit = scene.organ_unit.value_or(LengthUnit::kMillimetre);
  try {
    StiffnessMapFile map = read_stiffness_map(scene.stiffness_map->file(), options);
    const geometry::SignedDistance surface = organ_distance_of(setup);
    for (std::size_t i = 0; i < map.points.size(); ++i) {
      const double distance = std::abs(surface.nearest(map.points[i].point_S).distance);
      if (distance <= model::kFarthestStiffnessPoint) continue;
      throw InputError(
          fmt::format("{}: {}: the point is {} mm from the organ's surface: must be at most {} mm, in the "
                      "organ's frame",
                      to_text(scene.stiffness_map->file()), map.name_of(i), brief(distance / kMillimetre, 3),
                      brief(model::kFarthestStiffnessPoint / kMillimetre, 3)));
    }
    setup.stiffness = std::move(map.points);
    notes.remarks.insert(notes.remarks.end(), map.remarks.begin(), map.remarks.end());
  } catch (const InputError& error) {
    throw InputError(scene.stiffness_map->where + ": " + error.what());
  }
}

/// @throws InputError where the tissue has a layer that is too stiff for a tick (contact::TissueLaws)
void check_layers(const SceneFile& scene, const Scene& setup) {
  try {
    static_cast<void>(contact::TissueLaws(setup.tissue, 1.0 / setup.rate_Hz));
  } catch (const ParameterError& error) {
    throw InputError(fmt::format("{}tissue '{}': {}", scene.tissue ? scene.tissue->where + ": " : "",
                                 setup.tissue.name, error.what()));
  }
}

/// The requested tissue; else the built-in one of the organ's name ("heart" for heart-30k); else the task's.
model::TissueParameters find_tissue(const SceneFile& scene) {
  if (scene.tissue) {
    try {
      return load_tissue(is_path(scene.tissue->value) ? to_text(scene.tissue->file()) : scene.tissue->value);
    } catch (const InputError& error) {
      throw InputError(scene.tissue->where + ": " + error.what());
    }
  }
  if (!is_path(scene.organ->value)) {
    try {
      return model::tissue_preset(scene.organ->value.substr(0, scene.organ->value.find('-')));
    } catch (const InputError&) {  // an organ without its own tissue, such as the box
    }
  }
  return model::tissue_preset(scene.task == Task::kPull ? "heart" : "gallbladder");
}

const DeviceKind& check_device_kind(const LocatedString& kind) {
  if (const DeviceKind* found = find_device_kind(kind.value)) return *found;
  std::vector<std::string> names;
  for (const DeviceKind& known : device_kinds()) {
    if (known.name != "host") names.emplace_back(known.name);  // no run can open the host's device
  }
  kind.fail("must be " + alternatives(names));
}

void check_tool_path(const LocatedString& path, const std::filesystem::path& file, Task task) {
  try {
    const ToolPath read = read_tool_path(file);
    if (task == Task::kPull && !read.has_gripper()) {
      throw InputError(to_text(file) + ":1: gripper: missing, a pull needs this column (1 open, 0 closed)");
    }
  } catch (const InputError& error) {
    throw InputError(path.where + ": " + error.what());
  }
}

/// Loading a library runs its code. So only the person who starts the program may name one: no scene may, and
/// no relative path, which a file of the current folder could replace.
void check_library(const LocatedString& path) {
  if (!path.by_flag) {
    path.fail(
        "must be left out: a scene may not name a library; link it into ~/.config/palpate, or give its "
        "absolute path on the command line (docs/devices.md)");
  }
  if (!path.file().is_absolute()) path.fail("must be an absolute path, such as /opt/vendor/lib/libdhd.so.3");
}

/// Who listens at an address of a network lets other machines move the tool. So only the person who starts
/// the program may name one.
void check_client(const LocatedString& path) {
  if (path.by_flag || path.value.find(':') == std::string::npos) return;
  path.fail(
      "must be PORT/NAME: a scene may let only this machine connect; give an address on the command line");
}

/// Checks the files that a device reads when it is opened. @return its resolved path; empty if none is given
std::string check_device_path(const DeviceTable& device, const DeviceKind& kind, Task task) {
  if (!device.path) {
    if (kind.path == DevicePath::kRecording) device.kind.fail("needs the path of a recording beside it");
    if (kind.path == DevicePath::kClient) {
      device.kind.fail("needs path = \"PORT/NAME\" beside it, as in --device igtl:18945/Hand");
    }
    return {};
  }
  if (kind.path == DevicePath::kNone)
    device.path->fail("must be left out: a " + std::string(kind.name) + " has none");
  if (kind.path == DevicePath::kLibrary) check_library(*device.path);
  if (kind.path == DevicePath::kClient) check_client(*device.path);
  if (!names_file(kind.path) || kind.path == DevicePath::kName)
    return device.path->value;  // checked by the device itself
  const std::filesystem::path file = device.path->file();
  if (!file_exists(file)) device.path->fail("there is no such file");
  if (folder_exists(file)) device.path->fail("is a folder, must be a file");
  if (kind.path == DevicePath::kToolPath) check_tool_path(*device.path, file, task);
  return to_text(file);
}

void load_hands(const SceneFile& scene, Scene& setup, MeshNotes& notes) {
  const std::size_t hands = scene.tools.size();
  if (hands > kMaxHands) {
    throw InputError(
        fmt::format("{}: there are {} tools, must be at most {}", scene.tool_location, hands, kMaxHands));
  }
  std::vector<DeviceTable> devices = scene.devices;
  if (devices.empty()) devices.resize(hands);
  if (devices.size() != hands) {
    throw InputError(fmt::format("{}: there are {} devices for {} tools, must be one per tool",
                                 devices.front().kind.where, devices.size(), hands));
  }
  for (const DeviceTable& device : devices) {
    const DeviceKind& kind = check_device_kind(device.kind);
    DeviceSetup& made = setup.devices.emplace_back(device.setup);
    made.kind = kind.name;
    if (made.kind == "emulated") made.dynamics = with_emulated_defaults(made.dynamics);
    made.path = check_device_path(device, kind, scene.task);
    made.path_speed = scene.path_speed;
    if (kind.path != DevicePath::kToolPath || made.path.empty())
      made.interpolation = PathInterpolation::kLinear;
  }
  for (const ToolTable& tool : scene.tools) setup.tools.push_back(load_instrument(tool, notes));
}

void set_noise(const SceneFile& scene, Scene& setup) {
  setup.noise = scene.noise;
  setup.noise.seed = scene.seed;
  if (setup.noise.rate_Hz <= scene.rate_Hz) return;
  if (!scene.noise_rate_location.empty()) {
    throw InputError(fmt::format("{} = {}: must be at most the loop's rate, {} Hz", scene.noise_rate_location,
                                 shortest(setup.noise.rate_Hz), shortest(scene.rate_Hz)));
  }
  setup.noise.rate_Hz = scene.rate_Hz;
}

void add_source(const LocatedString& stated, Scene& setup) {
  if (is_path(stated.value)) setup.files.push_back({stated.where, stated.file()});
}

void add_mesh_source(const LocatedString& stated, Scene& setup) {
  add_source(stated, setup);
  if (!is_path(stated.value)) return;
  for (const std::filesystem::path& buffer : geometry::gltf_buffer_files(stated.file())) {
    setup.files.push_back({"a buffer of " + stated.where, buffer});
  }
}

/// Lists all files that were read.
void add_sources(const Overrides& request, const SceneFile& scene, Scene& setup) {
  if (request.scene) setup.files.push_back({"the scene", *request.scene});
  if (scene.tissue) add_source(*scene.tissue, setup);
  if (scene.organ) add_mesh_source(*scene.organ, setup);
  if (scene.stiffness_map) setup.files.push_back({scene.stiffness_map->where, scene.stiffness_map->file()});
  for (const ToolTable& tool : scene.tools) {
    if (tool.mesh) add_mesh_source(*tool.mesh, setup);
    for (const JawTable& jaw : tool.jaws) add_mesh_source(jaw.mesh, setup);
  }
  for (std::size_t hand = 0; hand < scene.devices.size(); ++hand) {
    const DevicePath kind = find_device_kind(setup.devices[hand].kind)->path;
    if (setup.devices[hand].path.empty() || !names_file(kind)) continue;
    setup.files.push_back({scene.devices[hand].path->where, setup.devices[hand].path});
  }
}

}  // namespace

Scene load(const Overrides& request) {
  const SceneFile scene = describe(request);
  if (!request.files_below.empty()) require_files_below(request.files_below, scene);
  Scene setup;
  setup.name = scene.name;
  setup.task = scene.task;
  setup.rate_Hz = scene.rate_Hz;
  setup.seed = scene.seed;
  setup.organ_pose = scene.organ_pose;
  setup.organ_motion = scene.organ_motion;
  setup.safety = scene.safety;
  set_noise(scene, setup);
  setup.tissue = find_tissue(scene);
  apply_to_tissue(request.settings, setup.tissue);
  check_layers(scene, setup);
  MeshNotes notes;
  load_hands(scene, setup, notes);
  load_organ(scene, setup, notes);
  place_inclusions(scene.inclusions, setup);
  if (setup.task == Task::kPalpate) {
    setup.search = scene.search.setup;
    for (const DeviceSetup& device : setup.devices) {
      if (device.clutch_button != setup.search.mark_button) continue;
      throw InputError(fmt::format("{}.mark_button = {}: must differ from the device's clutch_button",
                                   scene.search.where, setup.search.mark_button));
    }
    hide_inclusions(scene.search, setup);
  }
  load_stiffness_map(scene, setup, notes);
  setup.repairs = std::move(notes.repairs);
  setup.remarks = std::move(notes.remarks);
  add_sources(request, scene, setup);
  return setup;
}

}  // namespace palpate::scene
