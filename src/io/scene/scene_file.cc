#include "io/scene/scene_file.h"

#include <fmt/core.h>

#include "io/scene/emulated_reader.h"
#include "io/scene/organ_motion_reader.h"
#include "io/scene/toml_reader.h"
#include "palpate/error.h"

namespace palpate::scene {
namespace {

constexpr double kMillisecondsPerSecond = 1000.0;  // slew is given a millisecond

constexpr Range kPosition{-1e6, 1e6};        // mm: a kilometre
constexpr Range kRotation{-3600.0, 3600.0};  // deg: ten turns
constexpr Range kOpening{-180.0, 180.0};     // deg
constexpr Range kLoopRate{kSlowestRate, kFastestRate};
constexpr Range kNoiseRate{1e-3, kFastestRate};
constexpr Range kWorkspaceScale{0.0, 1000.0, true};
constexpr std::uint64_t kLastButton = 31;       // of DeviceState::buttons
constexpr Range kTipRadius{0.0, 1000.0, true};  // mm

/// Reads one scene file; holds what every part of it needs.
class SceneReader final {
 public:
  SceneReader(TomlTable root, std::filesystem::path folder)
      : root_(std::move(root)), folder_(std::move(folder)) {}

  SceneDescription read(const std::string& default_name) {
    SceneDescription scene;
    scene.name = default_name;
    root_.allow_only({"scene", "organ", "tool", "device", "noise", "safety"});
    if (auto table = root_.table("scene")) read_scene(*table, scene);
    read_organ(scene);
    for (const TomlTable& table : root_.tables("tool")) scene.tools.push_back(read_tool(table));
    scene.tool_place = root_.place("tool") + ": tool.mesh";
    for (const TomlTable& table : root_.tables("device")) scene.devices.push_back(read_device(table));
    if (auto table = root_.table("noise")) read_noise(*table, scene);
    if (auto table = root_.table("safety")) scene.safety = read_safety(*table);
    return scene;
  }

 private:
  std::optional<Stated> stated(const TomlTable& table, std::string_view key) const {
    const std::optional<std::string> text = table.text(key);
    if (!text) return std::nullopt;
    return Stated{*text, table.place(key) + ": " + table.field(key), folder_};
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
    const std::optional<Stated> unit = stated(table, "unit");
    if (!unit) return std::nullopt;
    return parse_unit(*unit);
  }

  void read_scene(const TomlTable& table, SceneDescription& scene) const {
    table.allow_only({"name", "task", "rate_Hz", "seed"});
    scene.name = table.text("name").value_or(scene.name);
    if (const auto task = stated(table, "task")) scene.task = parse_task(*task);
    scene.rate_Hz = table.number("rate_Hz", kLoopRate).value_or(scene.rate_Hz);
    scene.seed = table.whole_number("seed").value_or(scene.seed);
  }

  void read_organ(SceneDescription& scene) {
    scene.organ_place = root_.place("organ") + ": organ.mesh";
    const std::optional<TomlTable> table = root_.table("organ");
    if (!table) return;
    table->allow_only({"mesh", "unit", "tissue", "pose", "motion"});
    scene.organ = stated(*table, "mesh");
    scene.organ_unit = read_unit(*table);
    scene.tissue = stated(*table, "tissue");
    scene.organ_pose = read_pose(*table, "pose");
    scene.organ_motion = read_organ_motions(*table);
  }

  JawDescription read_jaw(const TomlTable& table) const {
    constexpr double kDefaultOpening = 15.0;  // deg
    JawDescription jaw;
    table.allow_only({"mesh", "pivot_mm", "axis", "open_deg"});
    std::optional<Stated> mesh = stated(table, "mesh");
    if (!mesh) table.fail_missing("mesh", "a jaw needs its mesh, a file");
    jaw.mesh = *mesh;
    if (const auto pivot = table.vector("pivot_mm", kPosition)) jaw.pivot = *pivot * kMillimetre;
    if (const auto axis = table.vector("axis", kPosition)) {
      if (axis->norm() < 1e-9) table.fail("axis", "must be a direction, not zero");
      jaw.axis = axis->normalized();
    }
    jaw.open_angle = table.number("open_deg", kOpening).value_or(kDefaultOpening) * kRadiansPerDegree;
    return jaw;
  }

  ToolDescription read_tool(const TomlTable& table) const {
    ToolDescription tool;
    table.allow_only({"mesh", "unit", "mount", "tip_radius_mm", "jaw"});
    tool.mesh = stated(table, "mesh");
    tool.unit = read_unit(table);
    tool.mount = read_pose(table, "mount");
    if (const auto radius = table.number("tip_radius_mm", kTipRadius))
      tool.tip_radius = *radius * kMillimetre;
    for (const TomlTable& jaw : table.tables("jaw")) tool.jaws.push_back(read_jaw(jaw));
    if (!tool.mesh && tool.jaws.empty()) {
      table.fail_missing("mesh", "a tool needs a mesh (a built-in name, a file or sphere:R) or jaws");
    }
    return tool;
  }

  DeviceDescription read_device(const TomlTable& table) const {
    DeviceDescription device;
    table.allow_only({"kind", "path", "interpolation", "workspace_scale", "base", "damping_N_s_per_m",
                      "friction_N", "resolution_mm", "clutch_button", "fit", "mass_kg", "grip",
                      "grip_N_per_m", "grip_N_s_per_m", "fault"});
    if (const auto kind = stated(table, "kind")) device.kind = *kind;
    if (device.kind.where.empty()) device.kind.where = table.place("kind") + ": " + table.field("kind");
    device.path = stated(table, "path");
    DeviceSetup& setup = device.setup;
    if (const auto name = stated(table, "interpolation")) setup.interpolation = parse_interpolation(*name);
    setup.workspace_scale = table.number("workspace_scale", kWorkspaceScale).value_or(setup.workspace_scale);
    setup.base = read_pose(table, "base");
    setup.dynamics.damping = table.number("damping_N_s_per_m", kNotNegative);
    setup.dynamics.friction = table.number("friction_N", kNotNegative);
    if (const auto resolution = table.number("resolution_mm", kNotNegative)) {
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
        0.6;  // of the user's threshold: about where published work finds the best
    const std::optional<double> gain = table.number("gain_N_m");
    const std::optional<double> user_threshold = table.number("user_threshold_N");
    const std::optional<double> share = table.number("share_of_threshold");
    if (user_threshold && gain)
      table.fail("gain_N_m", "stands beside user_threshold_N, give only one of them");
    if (share && !user_threshold) table.fail("share_of_threshold", "needs user_threshold_N beside it");
    if (!user_threshold) return gain.value_or(default_gain);
    return noise::gain_from_threshold(*user_threshold, share.value_or(kDefaultShare), threshold_distance);
  }

  static void read_noise(const TomlTable& table, SceneDescription& scene) {
    noise::NoiseSettings& settings = scene.noise;
    table.allow_only(
        {"enabled", "gain_N_m", "threshold_mm", "rate_Hz", "user_threshold_N", "share_of_threshold"});
    settings.enabled = table.truth("enabled").value_or(settings.enabled);
    if (const auto threshold = table.number("threshold_mm", kPositive)) {
      settings.threshold = *threshold * kMillimetre;
    }
    if (const auto rate = table.number("rate_Hz", kNoiseRate)) {
      settings.rate_Hz = *rate;
      scene.noise_rate_place = table.place("rate_Hz") + ": " + table.field("rate_Hz");
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
    table.allow_only({"max_force_N", "max_slew_N_per_ms", "max_torque_N_m", "max_slew_N_m_per_ms"});
    const auto read = [&table](const char* key, double unit, double most, double& value) {
      const auto given = table.number(key, {0.0, most / unit, true});
      if (given) value = *given * unit;
    };
    read("max_force_N", 1.0, SafetySetup::kMostForce, safety.max_force);
    read("max_slew_N_per_ms", kMillisecondsPerSecond, SafetySetup::kMostSlew, safety.max_slew);
    read("max_torque_N_m", 1.0, SafetySetup::kMostTorque, safety.max_torque);
    read("max_slew_N_m_per_ms", kMillisecondsPerSecond, SafetySetup::kMostTorqueSlew, safety.max_torque_slew);
    return safety;
  }

  TomlTable root_;
  std::filesystem::path folder_;
};

}  // namespace

void Stated::fail(const std::string& want) const {
  throw InputError(fmt::format("{} = \"{}\": {}", where, value, want));
}

Task parse_task(const Stated& stated) {
  if (stated.value == "press") return Task::kPress;
  if (stated.value == "pull") return Task::kPull;
  stated.fail("must be press or pull");
}

PathInterpolation parse_interpolation(const Stated& stated) {
  if (const auto known = interpolation_of(stated.value)) return *known;
  stated.fail("must be linear or cubic");
}

LengthUnit parse_unit(const Stated& stated) {
  for (const LengthUnit unit :
       {LengthUnit::kMillimetre, LengthUnit::kCentimetre, LengthUnit::kMetre, LengthUnit::kInch}) {
    if (stated.value == to_string(unit)) return unit;
  }
  stated.fail("must be mm, cm, m or in");
}

SceneDescription read_scene_file(const std::filesystem::path& file) {
  const TomlFile toml = read_toml(file);
  return SceneReader(TomlTable(toml), file.parent_path()).read(file.stem().string());
}

SceneDescription read_scene_text(const std::string& text, const std::filesystem::path& folder) {
  const TomlFile toml = parse_toml(text, "scene text");
  return SceneReader(TomlTable(toml), folder).read("scene");
}

}  // namespace palpate::scene
