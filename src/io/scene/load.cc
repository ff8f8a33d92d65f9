#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/contact/tissue_laws.h"
#include "io/mesh_io/formats/formats.h"
#include "io/scene/device_kinds.h"
#include "io/scene/emulated_reader.h"
#include "io/scene/instrument.h"
#include "io/scene/mesh_source.h"
#include "io/scene/names.h"
#include "io/scene/organ_distance.h"
#include "io/scene/plausibility.h"
#include "io/scene/scene_file.h"
#include "io/scene/scene_keys.h"
#include "io/scene/scene_request.h"
#include "io/scene/stiffness_map_reader.h"
#include "io/scene/variation_reader.h"
#include "io/system/file_exists.h"
#include "io/system/path_text.h"
#include "io/system/plausible.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

bool is_client(const DeviceSetup& device) {
  return find_device_kind(device.kind)->path == DevicePath::kClient;
}

/// The frame that the scene states, else that of the file's header, else RAS. It matters for OpenIGTLink
/// alone. @param space of mesh_io::LoadedMesh
void set_organ_frame(const SceneFile& scene_file, const std::string& space, Scene& scene, MeshNotes& notes) {
  const OrganFrame declared = space == "LPS" ? OrganFrame::kLps : OrganFrame::kRas;
  scene.organ_frame = scene_file.organ_frame.value_or(declared);
  const bool has_clients =
      scene_file.igtl || std::any_of(scene.devices.begin(), scene.devices.end(), is_client);
  if (!has_clients || space.empty() || (space == "RAS" && scene.organ_frame == declared)) return;
  const bool is_known = space == "LPS" || space == "RAS";
  const std::string header = fmt::format("{}: its header says SPACE={}", scene.organ_name, space);
  if (scene_file.organ_frame && (!is_known || declared != scene.organ_frame)) {
    notes.remarks.push_back(header + ": the scene's frame is used, " + to_string(scene.organ_frame));
  } else if (!is_known) {
    notes.remarks.push_back(header +
                            ", which is neither RAS nor LPS: taken as RAS (--organ-frame, organ.frame)");
  } else {
    notes.remarks.push_back(header +
                            ": OpenIGTLink clients get it in RAS, with the signs of x and y changed");
  }
}

/// Poses of an OpenIGTLink client are in RAS, as those to it. A base that the scene gives counts instead.
void turn_clients(const SceneFile& scene_file, Scene& scene, MeshNotes& notes) {
  if (scene.organ_frame != OrganFrame::kLps) return;
  for (std::size_t hand = 0; hand < scene.devices.size(); ++hand) {
    DeviceSetup& device = scene.devices[hand];
    if (!is_client(device)) continue;
    constexpr double kHalfTurn = 1.0 - 1e-9;  // |z| of the quaternion of half a turn about z
    if (!scene_file.devices[hand].has_base) {
      device.base.rotation = Quat(0.0, 0.0, 0.0, 1.0);  // half a turn about z
    } else if (std::abs(device.base.rotation.z()) < kHalfTurn) {
      notes.remarks.push_back(fmt::format(
          "device {}: its base is used as given: OpenIGTLink clients send poses in RAS, and the organ is in "
          "LPS; rotation_deg = [0, 0, 180] in the base turns RAS to LPS",
          device.kind));
    }
  }
}

void load_organ(const SceneFile& scene_file, const contact::OrganStore* store, Scene& scene,
                MeshNotes& notes) {
  const LocatedString& organ = *scene_file.organ;
  scene.organ_name = organ.value;
  if (is_path(organ.value)) {
    contact::ReadOrgan loaded = read_organ_source(organ, scene_file.organ_unit, store, notes);
    scene.organ = std::move(loaded.mesh);
    set_organ_frame(scene_file, loaded.space, scene, notes);
    return;
  }
  set_organ_frame(scene_file, {}, scene, notes);
  const std::vector<std::string>& known = geometry::builtin_organ_names();
  if (std::find(known.begin(), known.end(), organ.value) == known.end()) {
    const std::string near = nearest_word(organ.value, known);
    organ.fail(fmt::format("must be {}, or a file (with a / or an extension such as .stl){}",
                           alternatives(known), near.empty() ? "" : "; did you mean " + near + "?"));
  }
  scene.organ = geometry::make_organ(organ.value);
}

void load_stiffness_map(const SceneFile& scene_file, Scene& scene, MeshNotes& notes) {
  if (!scene_file.stiffness_map) return;
  StiffnessMapOptions options = scene_file.stiffness_map_options;
  options.unit = scene_file.organ_unit.value_or(LengthUnit::kMillimetre);
  with_location(*scene_file.stiffness_map, [&] {
    StiffnessMapFile map = read_stiffness_map(scene_file.stiffness_map->file(), options);
    const geometry::SignedDistance surface = organ_distance_of(scene);
    for (std::size_t i = 0; i < map.points.size(); ++i) {
      const double distance = std::abs(surface.nearest(map.points[i].point_S).distance);
      if (distance <= model::kFarthestStiffnessPoint) continue;
      throw InputError(fmt::format(
          "{}: {}: the point is {} mm from the organ's surface: must be at most {} mm, in the organ's frame",
          to_text(scene_file.stiffness_map->file()), map.name_of(i), brief(distance / kMillimetre, 3),
          brief(model::kFarthestStiffnessPoint / kMillimetre, 3)));
    }
    scene.stiffness = std::move(map.points);
    notes.remarks.insert(notes.remarks.end(), map.remarks.begin(), map.remarks.end());
  });
}

/// @throws InputError where the tissue has a layer that is too stiff for a tick (contact::TissueLaws)
void check_layers(const SceneFile& scene_file, const Scene& scene) {
  try {
    static_cast<void>(contact::TissueLaws(scene.tissue, 1.0 / scene.rate_Hz));
  } catch (const ParameterError& error) {
    throw InputError(fmt::format("{}tissue '{}': {}",
                                 scene_file.tissue ? scene_file.tissue->where + ": " : "", scene.tissue.name,
                                 error.what()));
  }
}

/// The requested tissue; else the built-in one of the organ's name ("heart" for heart-30k); else the task's.
model::TissueParameters find_tissue(const SceneFile& scene_file) {
  if (const auto& tissue = scene_file.tissue) {
    return with_location(*tissue, [&tissue] {
      return load_tissue(is_path(tissue->value) ? to_text(tissue->file()) : tissue->value);
    });
  }
  if (scene_file.task == Task::kInsert) {
    return model::tissue_preset(scene_file.organ->value.starts_with("liver") ? "liver-capsule"
                                                                             : "skin-fat-muscle");
  }
  if (!is_path(scene_file.organ->value)) {
    try {
      return model::tissue_preset(scene_file.organ->value.substr(0, scene_file.organ->value.find('-')));
    } catch (const InputError&) {  // an organ without its own tissue, such as the box
    }
  }
  return model::tissue_preset(scene_file.task == Task::kPull ? "heart" : "gallbladder");
}

/// @throws InputError where the task needs a needle or layers that are not there
void check_needle(const SceneFile& scene_file, Scene& scene, MeshNotes& notes) {
  const bool layered = !scene.tissue.layers.empty();
  std::size_t needles = 0;
  for (std::size_t hand = 0; hand < scene.tools.size(); ++hand) {
    if (scene.tools[hand].needle) {
      ++needles;
    } else if (scene.task == Task::kInsert) {
      const std::string tool =
          "tool \"" + scene.tools[hand].name + "\" is no needle, which task insert needs";
      throw InputError(tool +
                       ": must be needle, needle:SIZE,LENGTH_MM,TIP such as needle:18G,90,bevel, or a mesh "
                       "with [tool.needle]");
    }
  }
  if (layered || needles == 0) return;
  const std::string tissue = "tissue '" + scene.tissue.name + "' has no [[tissue.layer]]";
  if (scene.task != Task::kInsert) {
    notes.remarks.push_back(tissue + ": the needle presses and does not go in");
    return;
  }
  std::vector<std::string> with_layers;
  for (const char* name : model::tissue_preset_names()) {
    if (!model::tissue_preset(name).layers.empty()) with_layers.emplace_back(name);
  }
  throw InputError((scene_file.tissue ? scene_file.tissue->where + ": " : "") + tissue +
                   ", which task insert needs: must be " + alternatives(with_layers) +
                   ", or a file with layers");
}

const DeviceKind& check_device_kind(const LocatedString& kind) {
  if (const DeviceKind* found = find_device_kind(kind.value)) return *found;
  std::vector<std::string> names;
  for (const DeviceKind& known : device_kinds()) {
    if (known.name != "host") names.emplace_back(known.name);  // no run can open the host's device
  }
  const std::string_view near = device_kind_of_product(kind.value);
  kind.fail("must be " + alternatives(names) +
            (near.empty() ? "" : "; did you mean " + std::string(near) + "?"));
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
std::string check_device_path(const DeviceTable& device, const DeviceKind& kind) {
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
  return to_text(file);
}

using PathSummaries = std::vector<std::optional<PathSummary>>;  // one a hand; empty: no path from a file

bool has_path_file(const DeviceSetup& device) {
  return find_device_kind(device.kind)->path == DevicePath::kToolPath && !device.path.empty();
}

/// Starts the paths of several hands at the earliest of their first rows.
/// @throws InputError when the first rows are too far apart, as Unix time and other times are
void set_common_start(const std::vector<DeviceTable>& devices, Scene& scene) {
  if (std::count_if(scene.devices.begin(), scene.devices.end(), has_path_file) < 2) return;
  double earliest = std::numeric_limits<double>::infinity();
  double latest = -earliest;
  for (std::size_t hand = 0; hand < devices.size(); ++hand) {
    if (!has_path_file(scene.devices[hand])) continue;
    const LocatedString& path = *devices[hand].path;
    const double first = with_location(path, [&] { return first_path_time(path.file()); });
    earliest = std::min(earliest, first);
    latest = std::max(latest, first);
    if (latest - earliest <= kLongestTimes) continue;
    path.fail(fmt::format(
        "its first row is at {} s, that of another hand's path at {} s: must count from the same start",
        shortest(first), shortest(first == latest ? earliest : latest)));
  }
  for (DeviceSetup& device : scene.devices) device.earliest_row = earliest;
}

PathSummaries load_paths(const std::vector<DeviceTable>& devices, Scene& scene, MeshNotes& notes) {
  set_common_start(devices, scene);
  PathSummaries paths(devices.size());
  for (std::size_t hand = 0; hand < devices.size(); ++hand) {
    DeviceSetup& device = scene.devices[hand];
    if (!has_path_file(device)) continue;
    const ToolPath path = with_location(*devices[hand].path, [&] {
      ToolPath read =
          read_tool_path(device.path, PathInterpolation::kLinear, &notes.remarks, device.earliest_row);
      if (scene.task == Task::kPull && !read.has_gripper()) {
        throw InputError(device.path + ":1: gripper: missing, a pull needs this column (1 open, 0 closed)");
      }
      return read;
    });
    paths[hand] = summary_of(path);
    if (!devices[hand].interpolation && paths[hand]->is_sampled) {
      device.interpolation = PathInterpolation::kCubic;
      notes.remarks.push_back(device.path +
                              ": cubics join its rows; interpolation = \"linear\" under [device] joins them "
                              "by straight lines");
    }
  }
  return paths;
}

PathSummaries load_hands(const SceneFile& scene_file, Scene& scene, MeshNotes& notes) {
  const std::size_t hands = scene_file.tools.size();
  if (hands > kMaxHands) {
    throw InputError(fmt::format("{}: there are {} tools, must be at most {}", scene_file.tool_location,
                                 hands, kMaxHands));
  }
  std::vector<DeviceTable> devices = scene_file.devices;
  if (devices.empty()) devices.resize(hands);
  if (devices.size() != hands) {
    throw InputError(fmt::format("{}: there are {} devices for {} tools, must be one per tool",
                                 devices.front().kind.where, devices.size(), hands));
  }
  for (const DeviceTable& device : devices) {
    const DeviceKind& kind = check_device_kind(device.kind);
    DeviceSetup& made = scene.devices.emplace_back(device.setup);
    made.kind = kind.name;
    if (made.kind == "emulated") made.dynamics = with_emulated_defaults(made.dynamics);
    made.path = check_device_path(device, kind);
    made.path_speed = scene_file.path_speed;
    made.interpolation = device.interpolation.value_or(PathInterpolation::kLinear);
  }
  PathSummaries paths = load_paths(devices, scene, notes);
  for (const ToolTable& tool : scene_file.tools) scene.tools.push_back(load_instrument(tool, notes));
  return paths;
}

/// Questions about numbers that are probably in another unit (plausibility.h).
void add_questions(const SceneFile& scene_file, const PathSummaries& paths, Scene& scene, MeshNotes& notes) {
  const auto add = [&notes](std::string remark) {
    if (!remark.empty()) notes.remarks.push_back(std::move(remark));
  };
  const geometry::Bounds organ_W = organ_box(scene);
  add(organ_distance_remark(organ_W, scene_file.organ->where));
  for (std::string& remark : tissue_remarks(scene.tissue)) add(std::move(remark));
  for (std::size_t hand = 0; hand < paths.size(); ++hand) {
    if (paths[hand]) add(far_path_remark(scene, organ_W, hand, *paths[hand]));
  }
}

void set_noise(const SceneFile& scene_file, Scene& scene) {
  scene.noise = scene_file.noise;
  scene.noise.seed = scene_file.seed;
  if (scene.noise.rate_Hz <= scene_file.rate_Hz) return;
  if (!scene_file.noise_rate_location.empty()) {
    throw InputError(fmt::format("{} = {}: must be at most the loop's rate, {} Hz",
                                 scene_file.noise_rate_location, shortest(scene.noise.rate_Hz),
                                 shortest(scene_file.rate_Hz)));
  }
  scene.noise.rate_Hz = scene_file.rate_Hz;
}

void add_source(const LocatedString& stated, Scene& scene) {
  if (is_path(stated.value)) scene.files.push_back({stated.where, stated.file()});
}

void add_mesh_source(const LocatedString& stated, Scene& scene) {
  add_source(stated, scene);
  if (!is_path(stated.value)) return;
  for (const std::filesystem::path& buffer : mesh_io::gltf_buffer_files(stated.file())) {
    scene.files.push_back({"a buffer of " + stated.where, buffer});
  }
}

/// Lists all files that were read.
void add_sources(const Overrides& request, const SceneFile& scene_file, Scene& scene) {
  if (request.scene) scene.files.push_back({"the scene", *request.scene});
  if (scene_file.tissue) add_source(*scene_file.tissue, scene);
  if (scene_file.organ) add_mesh_source(*scene_file.organ, scene);
  if (scene_file.stiffness_map)
    scene.files.push_back({scene_file.stiffness_map->where, scene_file.stiffness_map->file()});
  if (scene_file.support && !scene_file.support->painted.empty())
    scene.files.push_back({scene_file.support->where, scene_file.support->painted});
  for (const ToolTable& tool : scene_file.tools) {
    if (tool.mesh) add_mesh_source(*tool.mesh, scene);
    for (const JawTable& jaw : tool.jaws) add_mesh_source(jaw.mesh, scene);
  }
  for (std::size_t hand = 0; hand < scene_file.devices.size(); ++hand) {
    const DevicePath kind = find_device_kind(scene.devices[hand].kind)->path;
    if (scene.devices[hand].path.empty() || !names_file(kind)) continue;
    scene.files.push_back({scene_file.devices[hand].path->where, scene.devices[hand].path});
  }
}

}  // namespace

Scene load(const Overrides& request) {
  const SceneFile scene_file = describe(request);
  Scene scene;
  scene.name = scene_file.name;
  scene.task = scene_file.task;
  scene.rate_Hz = scene_file.rate_Hz;
  scene.seed = scene_file.seed;
  scene.organ_pose = scene_file.organ_pose;
  scene.organ_motion = scene_file.organ_motion;
  scene.safety = scene_file.safety;
  set_noise(scene_file, scene);
  scene.tissue = find_tissue(scene_file);
  apply_to_tissue(request.settings, scene.tissue);
  check_layers(scene_file, scene);
  MeshNotes notes;
  const PathSummaries paths = load_hands(scene_file, scene, notes);
  check_needle(scene_file, scene, notes);
  load_organ(scene_file, request.store.get(), scene, notes);
  turn_clients(scene_file, scene, notes);
  if (scene_file.support) {
    LocatedSupport stated = *scene_file.support;
    read_painted(stated, scene_file.organ_unit.value_or(LengthUnit::kMillimetre));
    check_support(stated, scene.organ);
    scene.support = stated.support;
  }
  add_questions(scene_file, paths, scene, notes);
  place_inclusions(scene_file.inclusions, scene);
  if (scene.task == Task::kPalpate) {
    scene.search = scene_file.search.setup;
    for (const DeviceSetup& device : scene.devices) {
      if (device.clutch_button != scene.search.mark_button) continue;
      throw InputError(fmt::format("{}.mark_button = {}: must differ from the device's clutch_button",
                                   scene_file.search.where, scene.search.mark_button));
    }
    hide_inclusions(scene_file.search, scene);
  }
  if (scene.task == Task::kInsert) {
    scene.target = target_of(scene_file.target, scene);
    if (scene_file.search.given) hide_inclusions(scene_file.search, scene);
  }
  load_stiffness_map(scene_file, scene, notes);
  scene.repairs = std::move(notes.repairs);
  scene.remarks = std::move(notes.remarks);
  add_sources(request, scene_file, scene);
  return scene;
}

}  // namespace palpate::scene
