#include "io/scene/scene_file.h"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/infinity.h"
#include "core/base/text.h"
#include "io/scene/emulated_reader.h"
#include "io/scene/names.h"
#include "io/scene/organ_distance.h"
#include "io/scene/organ_motion_reader.h"
#include "io/scene/scene_keys.h"
#include "io/scene/toml_reader.h"
#include "io/system/file_content.h"
#include "palpate/error.h"

namespace palpate::scene {
namespace {

constexpr double kMillisecondsPerSecond = 1000.0;  // slew rates are given per millisecond

constexpr Range kPosition{-1e6, 1e6};        // mm: a kilometre
constexpr Range kRotation{-3600.0, 3600.0};  // deg: ten turns

PathInterpolation parse_interpolation(const LocatedString& stated) {
  if (const auto known = interpolation_of(stated.value)) return *known;
  stated.fail("must be linear or cubic");
}

/// Reads one scene file.
class SceneReader final {
 public:
  SceneReader(TomlTable root, std::filesystem::path folder)
      : root_(std::move(root)), folder_(std::move(folder)) {}

  SceneFile read(const std::string& default_name) {
    SceneFile scene;
    scene.name = default_name;
    root_.allow_only(
        {"scene", "organ", "search", "target", "tool", "path", "device", "noise", "safety", "probes"});
    if (auto table = root_.table("probes")) {  // of palpate fit --map, for palpate validate --map
      table->allow_only({"first_contact_mm"});
      (void)table->required_number("first_contact_mm");
    }
    if (auto table = root_.table("scene")) read_scene(*table, scene);
    read_organ(scene);
    scene.search = read_search(root_.table("search"));
    if (auto table = root_.table("target")) read_target(*table, scene.target);
    for (const TomlTable& table : root_.tables("tool")) scene.tools.push_back(read_tool(table));
    scene.tool_location = root_.location("tool") + ": tool.mesh";
    if (auto table = root_.table("path")) {
      table->allow_only(keys_in("path"));
      scene.path_speed = number_in(*table, "speed").value_or(scene.path_speed);
    }
    for (const TomlTable& table : root_.tables("device")) scene.devices.push_back(read_device(table));
    if (auto table = root_.table("noise")) read_noise(*table, scene);
    if (auto table = root_.table("safety")) scene.safety = read_safety(*table);
    return scene;
  }

 private:
  std::optional<LocatedString> stated(const TomlTable& table, std::string_view key) const {
    const std::optional<std::string> text = table.text(key);
    if (!text) return std::nullopt;
    return LocatedString{*text, table.location(key) + ": " + table.field(key), folder_};
  }

  static Pose read_pose(const TomlTable& parent, std::string_view key) {
    Pose pose;
    const std::optional<TomlTable> table = parent.table(key);
    if (!table) return pose;
    table->allow_only({"position_mm", "rotation_deg"});
    if (const auto position = table->vector("position_mm", kPosition))
      pose.position = *position * kMillimetre;
    if (const auto rotation = table->vector("rotation_deg", kRotation)) {
      pose.rotation = rotation_from_degrees(*rotation);
    }
    return pose;
  }

  std::optional<LengthUnit> read_unit(const TomlTable& table) const {
    const std::optional<LocatedString> unit = stated(table, "unit");
    if (!unit) return std::nullopt;
    return parse_unit(*unit);
  }

  void read_scene(const TomlTable& table, SceneFile& scene) const {
    table.allow_only(keys_in("scene"));
    scene.name = table.text("name", kLongestName).value_or(scene.name);
    if (const auto task = stated(table, "task")) scene.task = parse_task(*task);
    scene.rate_Hz = number_in(table, "rate_Hz").value_or(scene.rate_Hz);
    scene.seed = table.whole_number("seed").value_or(scene.seed);
  }

  void read_organ(SceneFile& scene) {
    scene.organ_location = root_.location("organ") + ": organ.mesh";
    const std::optional<TomlTable> table = root_.table("organ");
    if (!table) return;
    table->allow_only(keys_in("organ", {"pose", "motion", "inclusion", "stiffness", "support"}));
    scene.organ = stated(*table, "mesh");
    scene.organ_unit = read_unit(*table);
    if (const auto frame = stated(*table, "frame")) scene.organ_frame = parse_organ_frame(*frame);
    scene.tissue = stated(*table, "tissue");
    scene.organ_pose = read_pose(*table, "pose");
    scene.organ_motion = read_organ_motions(*table);
    scene.inclusions = read_inclusions(*table);
    scene.support = read_support(*table, folder_);
    if (const std::optional<TomlTable> stiffness = table->table("stiffness")) {
      stiffness->allow_only(keys_in("organ.stiffness"));
      scene.stiffness_map = stated(*stiffness, "map");
      if (!scene.stiffness_map) stiffness->fail_missing("map", "must be a CSV or PLY file (docs/lumps.md)");
      scene.stiffness_map_options.factor_at_black = number_in(*stiffness, "factor_at_black");
      scene.stiffness_map_options.factor_at_white = number_in(*stiffness, "factor_at_white");
    }
  }

  static std::optional<Vec3> read_axis(const TomlTable& table) {
    const auto axis = table.vector("axis", kPosition);
    if (!axis) return std::nullopt;
    if (axis->norm() < 1e-9) table.fail("axis", "must be a direction, not zero");
    return axis->normalized();
  }

  void read_target(const TomlTable& table, TargetTable& target) const {
    table.allow_only(keys_in("target", {"forbidden"}));
    target.layer = stated(table, "layer");
    for (const std::string& layer : table.texts("forbidden").value_or(std::vector<std::string>{})) {
      target.forbidden.push_back(
          {layer, table.location("forbidden") + ": " + table.field("forbidden"), folder_});
    }
  }

  JawTable read_jaw(const TomlTable& table) const {
    constexpr double kDefaultOpening = 15.0;  // deg
    JawTable jaw;
    table.allow_only(keys_in("tool.jaw", {"pivot_mm", "axis"}));
    std::optional<LocatedString> mesh = stated(table, "mesh");
    if (!mesh) table.fail_missing("mesh", "a jaw needs its mesh, a file");
    jaw.mesh = *mesh;
    if (const auto pivot = table.vector("pivot_mm", kPosition)) jaw.pivot = *pivot * kMillimetre;
    if (const auto axis = read_axis(table)) jaw.axis = *axis;
    jaw.open_angle = number_in(table, "open_deg").value_or(kDefaultOpening) * kRadiansPerDegree;
    return jaw;
  }

  static std::optional<NeedleTable> read_needle(const TomlTable& tool) {
    const std::optional<TomlTable> table = tool.table("needle");
    if (!table) return std::nullopt;
    table->allow_only(keys_in("tool.needle", {"axis"}));
    const auto length_of = [&table](const char* key, const char* what) {
      const std::optional<double> value = number_in(*table, key);
      if (!value) table->fail_missing(key, what);
      return *value * kMillimetre;
    };
    NeedleTable needle;
    needle.where = tool.location("needle") + ": " + tool.field("needle");
    needle.diameter = length_of("diameter_mm", "the outer diameter of the shaft");
    needle.length = length_of("length_mm", "the length of the shaft, from the tip to the hub");
    if (const auto axis = read_axis(*table)) needle.axis = *axis;
    return needle;
  }

  ToolTable read_tool(const TomlTable& table) const {
    ToolTable tool;
    table.allow_only(keys_in("tool", {"mount", "jaw", "needle"}));
    tool.mesh = stated(table, "mesh");
    tool.unit = read_unit(table);
    tool.mount = read_pose(table, "mount");
    if (const auto radius = number_in(table, "tip_radius_mm")) tool.tip_radius = *radius * kMillimetre;
    for (const TomlTable& jaw : table.tables("jaw")) tool.jaws.push_back(read_jaw(jaw));
    tool.needle = read_needle(table);
    if (!tool.mesh && tool.jaws.empty()) {
      table.fail_missing("mesh", "a tool needs a mesh (a built-in name, a file or sphere:R) or jaws");
    }
    return tool;
  }

  DeviceTable read_device(const TomlTable& table) const {
    DeviceTable device;
    table.allow_only(keys_in("device", {"base", "fault"}));
    if (const auto kind = stated(table, "kind")) device.kind = *kind;
    if (device.kind.where.empty()) device.kind.where = table.location("kind") + ": " + table.field("kind");
    device.path = stated(table, "path");
    DeviceSetup& setup = device.setup;
    if (const auto name = stated(table, "interpolation")) device.interpolation = parse_interpolation(*name);
    setup.workspace_scale = number_in(table, "workspace_scale").value_or(setup.workspace_scale);
    setup.base = read_pose(table, "base");
    device.has_base = table.table("base").has_value();
    setup.dynamics.damping = number_in(table, "damping_N_s_per_m");
    setup.dynamics.friction = number_in(table, "friction_N");
    if (const auto resolution = number_in(table, "resolution_mm")) {
      setup.dynamics.resolution = *resolution * kMillimetre;
    }
    setup.emulated = read_emulated_hand(table, device.kind.value);
    setup.fit = table.truth("fit").value_or(false);
    if (const auto button = table.whole_number("clutch_button")) {
      if (*button > kLastButton) {
        table.fail("clutch_button", "must be a button's number from 0 to " + std::to_string(kLastButton));
      }
      setup.clutch_button = static_cast<std::uint32_t>(*button);
    }
    return device;
  }

  static double read_gain(const TomlTable& table, double threshold_distance, double default_gain) {
    constexpr double kDefaultShare =
        0.6;  // of the user's threshold: near the optimum of published experiments
    const std::optional<double> gain = table.number("gain_N_m");
    const std::optional<double> user_threshold = table.number("user_threshold_N");
    const std::optional<double> share = table.number("share_of_threshold");
    if (user_threshold && gain) table.fail("gain_N_m", "excludes user_threshold_N, give only one of them");
    if (share && !user_threshold) table.fail("share_of_threshold", "needs user_threshold_N beside it");
    if (!user_threshold) return gain.value_or(default_gain);
    return noise::gain_from_threshold(*user_threshold, share.value_or(kDefaultShare), threshold_distance);
  }

  static void read_noise(const TomlTable& table, SceneFile& scene) {
    noise::NoiseSettings& settings = scene.noise;
    table.allow_only(keys_in("noise"));
    settings.enabled = table.truth("enabled").value_or(settings.enabled);
    if (const auto threshold = number_in(table, "threshold_mm")) {
      settings.threshold = *threshold * kMillimetre;
    }
    if (const auto rate = number_in(table, "rate_Hz")) {
      settings.rate_Hz = *rate;
      scene.noise_rate_location = table.location("rate_Hz") + ": " + table.field("rate_Hz");
    }
    try {
      settings.gain = read_gain(table, settings.threshold, settings.gain);
      noise::validate(settings, kFastestRate);
    } catch (const ParameterError& error) {
      table.fail(error);
    }
  }

  static SafetySetup read_safety(const TomlTable& table) {
    SafetySetup safety;
    table.allow_only(keys_in("safety"));
    const auto read = [&table](const char* key, double unit, double& value) {
      if (const auto given = number_in(table, key)) value = *given * unit;
    };
    read("max_force_N", 1.0, safety.max_force);
    read("max_slew_N_per_ms", kMillisecondsPerSecond, safety.max_slew);
    read("max_torque_N_m", 1.0, safety.max_torque);
    read("max_slew_N_m_per_ms", kMillisecondsPerSecond, safety.max_torque_slew);
    return safety;
  }

  TomlTable root_;
  std::filesystem::path folder_;
};

}  // namespace

void LocatedString::fail(const std::string& want) const {
  throw InputError(fmt::format("{} = \"{}\": {}", where, excerpt(value, kLongestName), want));
}

TargetSetup target_of(const TargetTable& table, const Scene& scene) {
  const auto mm = [](double length) { return brief(length / kMillimetre, 3) + " mm"; };
  const auto begin_of = [&](const LocatedString& stated) {
    std::vector<std::string> names;
    double begin = 0.0;  // m, of the layer below the surface
    for (const model::TissueLayer& layer : scene.tissue.layers) {
      if (layer.name == stated.value) {
        const double deepest = begin > 0.0 ? deepest_point(scene, begin) : kInfinity;
        if (deepest > begin) return begin;
        stated.fail("begins " + mm(begin) + " below the surface, and the organ's deepest point is " +
                    mm(deepest) + " below it: must be a layer nearer to the surface, or a thicker organ");
      }
      names.push_back(layer.name);
      begin += layer.thickness;
    }
    stated.fail("must be a layer of the tissue '" + scene.tissue.name + "': " + alternatives(names));
  };
  TargetSetup target;
  if (table.layer) {
    target.layer = table.layer->value;
    const double begin = begin_of(*table.layer);
    double longest = 0.0;  // m, of the needles
    for (const geometry::Tool& tool : scene.tools) longest = std::max(longest, tool.needle->length);
    if (longest <= begin) {
      table.layer->fail("begins " + mm(begin) +
                        " below the surface: must be less than the needle's length, " + mm(longest));
    }
  }
  for (const LocatedString& one : table.forbidden) {
    static_cast<void>(begin_of(one));
    if (one.value == target.layer) one.fail("is the target too: must be another layer");
    target.forbidden.push_back(one.value);
  }
  return target;
}

Task parse_task(const LocatedString& stated) {
  if (const auto task = find_task(stated.value)) return *task;
  stated.fail("must be press, pull, palpate or insert");
}

OrganFrame parse_organ_frame(const LocatedString& stated) {
  if (const auto frame = find_organ_frame(stated.value)) return *frame;
  stated.fail("must be ras or lps");
}

LengthUnit parse_unit(const LocatedString& stated) {
  for (const LengthUnit unit :
       {LengthUnit::kMillimetre, LengthUnit::kCentimetre, LengthUnit::kMetre, LengthUnit::kInch}) {
    if (stated.value == to_string(unit)) return unit;
  }
  stated.fail("must be mm, cm, m or in");
}

SceneFile read_scene_file(const std::filesystem::path& file, std::span<const Setting> settings) {
  try {
    TomlFile toml = read_toml(file);
    apply_to_scene(settings, toml.root);
    return SceneReader(TomlTable(toml), file.parent_path()).read(to_text(file.stem()));
  } catch (const InputError&) {
    refuse_other_content(file, FileContent::kScene, "a scene");
    throw;
  }
}

SceneFile read_scene_text(const std::string& text, const std::filesystem::path& folder,
                          std::span<const Setting> settings) {
  TomlFile toml = parse_toml(text, "scene text");
  apply_to_scene(settings, toml.root);
  return SceneReader(TomlTable(toml), folder).read("scene");
}

}  // namespace palpate::scene
