#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/organ_motion.h"
#include "palpate/pose.h"
#include "palpate/scene.h"
#include "palpate/touch_noise.h"
#include "palpate/units.h"

namespace palpate::scene {

/// A name or file as a user typed it, with where, so that what is found wrong with it later can be told.
struct Stated {
  std::string value;
  std::string where;             // "FILE:LINE: organ.mesh", or a flag: "--organ"
  std::filesystem::path folder;  // that a relative path starts from
  bool by_flag = false;          // from the command line or a caller's argument, not from a scene

  /// [setup] The file meant by the value.
  [[nodiscard]] std::filesystem::path file() const { return folder / value; }
  /// [setup] @throws InputError "where = "value": want".
  [[noreturn]] void fail(const std::string& want) const;
};

struct JawDescription {
  Stated mesh;
  Vec3 pivot = Vec3::Zero();  // m
  Vec3 axis = Vec3::UnitY();  // unit
  double open_angle = 0.0;    // rad
};

struct ToolDescription {
  std::optional<Stated> mesh;
  std::optional<LengthUnit> unit;
  Pose mount;
  std::optional<double> tip_radius;  // m
  std::vector<JawDescription> jaws;
  bool jaws_by_flags = false;  // axis and sign of the opening are chosen so that the jaws open apart
};

struct DeviceDescription {
  Stated kind = {"scripted", "", {}};
  std::optional<Stated> path;
  DeviceSetup setup;  // all but kind and path
};

/// What a scene file says, checked as far as it goes without the files it names. SI.
struct SceneDescription {
  std::string name;
  Task task = Task::kPress;
  double rate_Hz = 1000.0;
  std::uint64_t seed = 1;
  std::optional<Stated> organ;
  std::optional<LengthUnit> organ_unit;
  std::optional<Stated> tissue;
  Pose organ_pose;
  std::vector<model::OrganMotionParameters> organ_motion;  // empty: the organ lies still
  std::vector<ToolDescription> tools;
  double path_speed = 1.0;  // of every tool path
  std::vector<DeviceDescription> devices;
  noise::NoiseSettings noise;    // its seed is not set yet
  std::string noise_rate_place;  // "FILE:LINE: noise.rate_Hz" when it stands there, else empty
  SafetySetup safety;
  std::string organ_place;  // "FILE:LINE: organ.mesh", for when it is missing
  std::string tool_place;
};

/// [setup] Reads and checks a scene file. @throws InputError: one line, FILE:LINE: field = value: what would
/// be right; unknown keys too, with the nearest known one. @param settings take
/// the place of what the file has
[[nodiscard]] SceneDescription read_scene_file(const std::filesystem::path& file,
                                               std::span<const Setting> settings = {});

/// [setup] The same from a text. @param folder that relative paths in it start from
[[nodiscard]] SceneDescription read_scene_text(const std::string& text, const std::filesystem::path& folder,
                                               std::span<const Setting> settings = {});

/// [setup] "press" or "pull". @throws InputError through `stated`.
[[nodiscard]] Task parse_task(const Stated& stated);

/// [setup] The unit named by `stated`. @throws InputError through it.
[[nodiscard]] LengthUnit parse_unit(const Stated& stated);

/// [setup] "linear" or "cubic". @throws InputError naming where it stands
[[nodiscard]] PathInterpolation parse_interpolation(const Stated& stated);

}  // namespace palpate::scene
