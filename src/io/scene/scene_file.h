#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/scene/search.h"
#include "io/scene/stiffness_map_reader.h"
#include "io/scene/support_reader.h"
#include "io/scene/variation_reader.h"
#include "io/system/path_text.h"
#include "palpate/organ_motion.h"
#include "palpate/pose.h"
#include "palpate/scene.h"
#include "palpate/touch_noise.h"
#include "palpate/units.h"

namespace palpate::scene {

/// A name or file as a user wrote it, with its source for error messages.
struct LocatedString {
  std::string value;
  std::string where;             // "FILE:LINE: organ.mesh", or a flag: "--organ"
  std::filesystem::path folder;  // base of a relative path
  bool by_flag = false;          // from the command line or a caller's argument, not from a scene file

  /// [setup] The value as a path.
  [[nodiscard]] std::filesystem::path file() const { return folder / to_path(value); }
  /// [setup] @throws InputError "where = "value": want", always.
  [[noreturn]] void fail(const std::string& want) const;
};

/// [setup] Reads the file that `stated` names. @throws InputError of `read`, with where it was written
template <typename Read>
auto with_location(const LocatedString& stated, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(stated.where + ": " + error.what());
  }
}

struct JawTable {
  LocatedString mesh;
  Vec3 pivot = Vec3::Zero();  // m
  Vec3 axis = Vec3::UnitY();  // unit
  double open_angle = 0.0;    // rad
};

/// A mesh that is a straight needle.
struct NeedleTable {
  std::string where;          // location and field, for messages
  Vec3 axis = Vec3::UnitZ();  // unit, from the hub to the tip, in the mesh's frame
  double diameter = 0.0;      // m
  double length = 0.0;        // m, of the shaft
};

struct ToolTable {
  std::optional<LocatedString> mesh;
  std::optional<LengthUnit> unit;
  Pose mount;
  std::optional<double> tip_radius;  // m
  std::optional<NeedleTable> needle;
  std::vector<JawTable> jaws;
  bool jaws_by_flags = false;  // choose the axis and sign of the opening so that the jaws open apart
};

struct DeviceTable {
  LocatedString kind = {"scripted", "", {}};
  std::optional<LocatedString> path;
  std::optional<PathInterpolation> interpolation;  // of a tool path; empty: by its rows
  DeviceSetup setup;                               // except kind, path and interpolation
  bool has_base = false;                           // the scene gives setup.base
};

/// The [target] table.
struct TargetTable {
  std::optional<LocatedString> layer;
  std::vector<LocatedString> forbidden;
};

/// The content of a scene file, checked except for the files that it names. SI units.
struct SceneFile {
  std::string name;
  Task task = Task::kPress;
  double rate_Hz = 1000.0;
  std::uint64_t seed = 1;
  std::optional<LocatedString> organ;
  std::optional<LengthUnit> organ_unit;
  std::optional<OrganFrame> organ_frame;  // empty: that of the mesh file's header, else RAS
  bool igtl = false;                      // `igtl` of Overrides
  std::optional<LocatedString> tissue;
  Pose organ_pose;
  std::vector<model::OrganMotionParameters> organ_motion;  // empty: the organ does not move
  std::vector<InclusionTable> inclusions;
  std::optional<LocatedSupport> support;
  std::optional<LocatedString> stiffness_map;
  SearchTable search;
  TargetTable target;
  StiffnessMapOptions stiffness_map_options;
  std::vector<ToolTable> tools;
  double path_speed = 1.0;  // factor of all tool paths
  std::vector<DeviceTable> devices;
  noise::NoiseSettings noise;       // without its seed
  std::string noise_rate_location;  // "FILE:LINE: noise.rate_Hz" if the file has that key, else empty
  SafetySetup safety;
  std::string organ_location;  // "FILE:LINE: organ.mesh", for the error when it is missing
  std::string tool_location;
};

/// [setup] Reads and checks a scene file. @param settings override the file's values @throws InputError in
/// one line, "FILE:LINE: field = value: what would be right"; for an unknown key with the nearest valid one.
[[nodiscard]] SceneFile read_scene_file(const std::filesystem::path& file,
                                        std::span<const Setting> settings = {});

/// [setup] Reads and checks the text of a scene. @param folder base of relative paths in it
[[nodiscard]] SceneFile read_scene_text(const std::string& text, const std::filesystem::path& folder,
                                        std::span<const Setting> settings = {});

/// [setup] @param scene with organ, tissue and tools @throws InputError for a layer that the tissue does not
/// have or the organ has no room for, a target that no needle reaches, or one that is forbidden
[[nodiscard]] TargetSetup target_of(const TargetTable& table, const Scene& scene);

/// [setup] The task that `stated` names. @throws InputError naming where `stated` was written.
[[nodiscard]] Task parse_task(const LocatedString& stated);

/// [setup] The length unit that `stated` names. @throws InputError naming where `stated` was written.
[[nodiscard]] LengthUnit parse_unit(const LocatedString& stated);

/// [setup] "ras" or "lps". @throws InputError naming where `stated` was written.
[[nodiscard]] OrganFrame parse_organ_frame(const LocatedString& stated);

}  // namespace palpate::scene
