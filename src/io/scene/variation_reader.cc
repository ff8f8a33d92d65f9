#include "io/scene/variation_reader.h"

#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/default_path.h"
#include "io/scene/names.h"
#include "io/scene/organ_distance.h"
#include "io/scene/scene_keys.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

constexpr Range kPlace{-1e6, 1e6};  // mm

InclusionTable read_one(const TomlTable& table, std::size_t number) {
  table.allow_only(keys_in("organ.inclusion", {"position_mm", "under"}));
  InclusionTable made;
  const std::optional<std::string> preset = table.text("preset");
  if (preset) {
    const std::optional<InclusionTable> found = find_inclusion_preset(*preset);
    if (!found) table.fail("preset", "must be " + inclusion_preset_names());
    made = *found;
  } else {
    made.setup.name = "inclusion " + std::to_string(number);
  }
  made.where = table.location("") + ": organ.inclusion";
  model::Inclusion& inclusion = made.setup.inclusion;
  made.setup.name = table.text("name", kLongestName).value_or(made.setup.name);
  made.setup.visible = table.truth("visible").value_or(true);
  const auto read = [&table](const char* key, double unit, double& value) {
    if (const auto given = number_in(table, key)) value = *given * unit;
  };
  const bool numbers = table.has("radius_mm") && table.has("stiffness_ratio");
  if (!preset && !numbers) {
    table.fail_missing(
        table.has("radius_mm") ? "stiffness_ratio" : "radius_mm",
        "an inclusion needs radius_mm and stiffness_ratio, or a preset (" + inclusion_preset_names() + ")");
  }
  read("radius_mm", kMillimetre, inclusion.radius);
  read("stiffness_ratio", 1.0, inclusion.ratio);
  read("pulse_mm", kMillimetre, inclusion.pulse);
  read("pulse_period_s", 1.0, inclusion.pulse_period);
  read("depth_mm", kMillimetre, made.depth);
  if (const auto centre = table.vector("position_mm", kPlace)) {
    if (table.has("under")) table.fail("under", "excludes position_mm, give only one of them");
    if (table.has("depth_mm")) table.fail("depth_mm", "excludes position_mm, give only one of them");
    inclusion.centre_S = *centre * kMillimetre;
    made.has_centre = true;
  } else if (!preset && !table.has("depth_mm")) {
    table.fail_missing("position_mm", "an inclusion needs its place: position_mm, or under and depth_mm");
  }
  if (const auto under = table.vector("under", kPlace)) made.under_S = *under * kMillimetre;
  try {
    model::validate(inclusion);
  } catch (const ParameterError& error) {
    table.fail(error);
  }
  return made;
}

}  // namespace

Vec3 mean_normal(const geometry::TriangleMesh& organ, const geometry::NearestPoint& nearest, double radius) {
  Vec3 sum = nearest.normal * (1e-6 * radius * radius);
  for (const geometry::Triangle& triangle : organ.triangles) {
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t v : triangle) middle += organ.vertices[static_cast<std::size_t>(v)] / 3.0;
    if ((middle - nearest.point).squaredNorm() > radius * radius) continue;
    const Vec3 area = geometry::area_vector_doubled(organ, triangle);
    if (area.dot(nearest.normal) > 0.0) sum += area;
  }
  return sum.normalized();
}

std::optional<InclusionTable> find_inclusion_preset(std::string_view name) {
  for (const model::InclusionPreset& preset : model::inclusion_presets()) {
    if (name != preset.name) continue;
    InclusionTable made;
    made.setup.name = name;
    made.setup.inclusion = preset.inclusion;
    made.depth = preset.depth;
    return made;
  }
  return std::nullopt;
}

std::string inclusion_preset_names() {
  std::vector<std::string> names;
  for (const model::InclusionPreset& preset : model::inclusion_presets()) names.emplace_back(preset.name);
  return alternatives(names);
}

std::vector<InclusionTable> read_inclusions(const TomlTable& organ) {
  std::vector<InclusionTable> inclusions;
  for (const TomlTable& table : organ.tables("inclusion")) {
    if (inclusions.size() == model::kMaxInclusions) {
      throw InputError(fmt::format("{}: organ.inclusion: one too many, must be at most {}",
                                   table.location(""), model::kMaxInclusions));
    }
    inclusions.push_back(read_one(table, inclusions.size() + 1));
  }
  return inclusions;
}

std::vector<InclusionTable> inclusions_by_flags(const std::vector<std::string>& flags) {
  std::vector<InclusionTable> inclusions;
  for (const std::string& flag : flags) {
    if (flag == "none") continue;
    std::optional<InclusionTable> made = find_inclusion_preset(flag);
    if (!made) {
      throw InputError(
          fmt::format("--inclusion = \"{}\": must be {} or none", flag, inclusion_preset_names()));
    }
    made->where = "--inclusion " + flag;
    inclusions.push_back(std::move(*made));
  }
  if (inclusions.size() > model::kMaxInclusions) {
    throw InputError(fmt::format("--inclusion: given {} times, must be at most {}", inclusions.size(),
                                 model::kMaxInclusions));
  }
  return inclusions;
}

void place_inclusions(const std::vector<InclusionTable>& tables, Scene& scene) {
  if (tables.empty()) return;
  const geometry::SignedDistance surface = organ_distance_of(scene);
  std::optional<Vec3> touch_S;  // found once, because that takes longest
  for (const InclusionTable& table : tables) {
    InclusionSetup made = table.setup;
    model::Inclusion& inclusion = made.inclusion;
    if (!table.has_centre) {
      if (!table.under_S && !touch_S) touch_S = scene.organ_pose.inverse() * default_touch(scene, 0);
      const geometry::NearestPoint nearest = surface.nearest(table.under_S ? *table.under_S : *touch_S);
      inclusion.centre_S = nearest.point - table.depth * mean_normal(scene.organ, nearest, table.depth);
    }
    const double depth = -surface.nearest(inclusion.centre_S).distance;
    const double needed = inclusion.radius + inclusion.pulse;
    if (!(depth >= needed)) {
      throw InputError(fmt::format(
          "{}: the centre of '{}' is {} mm {}: must be at least {} mm below the surface, its radius{}",
          table.where, made.name, brief(std::abs(depth) / kMillimetre, 3),
          depth > 0.0 ? "below the surface" : "outside the organ", brief(needed / kMillimetre, 3),
          inclusion.pulse > 0.0 ? " and pulse" : ""));
    }
    scene.inclusions.push_back(std::move(made));
  }
}

std::vector<model::Inclusion> visible_inclusions(const std::vector<InclusionSetup>& inclusions) {
  std::vector<model::Inclusion> visible;
  for (const InclusionSetup& one : inclusions) {
    if (one.visible) visible.push_back(one.inclusion);
  }
  return visible;
}

}  // namespace palpate::scene
