#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/signed_distance.h"
#include "io/scene/toml_reader.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// An [[organ.inclusion]] table, checked except for its position in the organ. SI units.
struct InclusionTable {
  InclusionSetup setup;         // its centre only with `has_centre`
  bool has_centre = false;      // position_mm was given
  std::optional<Vec3> under_S;  // a point on or near the surface; empty: where the default path touches
  double depth = 0.0;           // of the centre below that place [m]
  std::string where;            // "FILE:LINE: organ.inclusion", for errors
};

/// [setup] The preset of this name, without a position; empty for an unknown name.
[[nodiscard]] std::optional<InclusionTable> find_inclusion_preset(std::string_view name);

/// [setup] The names of all presets, for messages: "nodule, stone or cyst".
[[nodiscard]] std::string inclusion_preset_names();

/// [setup] The inclusions of an organ's table. @throws InputError as the other readers
[[nodiscard]] std::vector<InclusionTable> read_inclusions(const TomlTable& organ);

/// [setup] An inclusion by its flag: the name of a preset. @throws InputError that lists the presets
[[nodiscard]] std::vector<InclusionTable> inclusions_by_flags(const std::vector<std::string>& flags);

/// [setup] The unit outward normal of the surface around a point: the mean over the faces whose middles lie
/// within `radius` [m], on this side of the organ.
[[nodiscard]] Vec3 mean_normal(const geometry::TriangleMesh& organ, const geometry::NearestPoint& nearest,
                               double radius);

/// [setup] Finds the centres and sets the inclusions of a loaded scene.
/// @throws InputError for an inclusion that is not inside the organ
void place_inclusions(const std::vector<InclusionTable>& tables, Scene& scene);

}  // namespace palpate::scene
