// `palpate validate --map`: predicts probes from what `palpate fit --map` wrote.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/scene/names.h"
#include "io/scene/scene_file.h"
#include "io/scene/stiffness_map_reader.h"
#include "io/scene/toml_reader.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/spring_law.h"
#include "palpate/units.h"

#include "app/output.h"
#include "fit/commands/fit_summary.h"
#include "fit/identify/map_check.h"
#include "fit/identify/map_choice.h"

namespace palpate::app {
namespace {

using identify::FittedMap;
using identify::MapRow;

/// What a scene of `palpate fit --map` says, and the deepest depth of its rows [m].
struct WrittenMap {
  FittedMap map;
  double deepest = std::numeric_limits<double>::infinity();
};

/// @throws InputError for a scene without tissue, ball or first contact
WrittenMap read_written_map(const std::string& file) {
  const scene::SceneFile scene = scene::read_scene_file(to_path(file));
  const auto needed = [&file](const std::string& what) -> InputError {
    return InputError(file + ": " + what +
                      ": missing, must be a scene that palpate fit --map wrote with --out");
  };
  if (!scene.tissue) throw needed("organ.tissue");
  if (!scene.stiffness_map) throw needed("organ.stiffness.map");
  if (scene.tools.empty() || !scene.tools.front().tip_radius) throw needed("tool.tip_radius_mm");
  const scene::TomlFile toml = scene::read_toml(to_path(file));
  const auto probes = scene::TomlTable(toml).table("probes");
  if (!probes) throw needed("probes.first_contact_mm");
  WrittenMap written;
  written.map.first_depth = -probes->required_number("first_contact_mm", {-1000.0, 0.0}) * kMillimetre;
  written.map.tip_radius = *scene.tools.front().tip_radius;
  const std::string tissue_name =
      scene::is_path(scene.tissue->value) ? to_text(scene.tissue->file()) : scene.tissue->value;
  const model::TissueParameters tissue = scene::load_tissue(tissue_name);
  constexpr double kPeriod = 1e-3;  // s, of the loop
  const model::SpringLaw law(model::for_tool(tissue, written.map.tip_radius), model::Direction::kPress,
                             kPeriod);
  written.map.uniform = [law](double depth) {
    return std::pair(law.force_at(depth).force, law.energy_at(depth));
  };
  if (tissue.max_depth) written.deepest = *tissue.max_depth - written.map.first_depth;
  written.map.stiffness =
      scene::read_stiffness_map(scene.stiffness_map->file(), scene.stiffness_map_options).points;
  for (const scene::InclusionTable& table : scene.inclusions) {
    if (!table.has_centre) {
      throw InputError(table.where +
                       ".position_mm: missing, must be the centre: there is no organ to place it under");
    }
    written.map.inclusions.push_back(table.setup.inclusion);
  }
  return written;
}

/// Distance [m] of a point to the nearest probe of the fitted map.
double distance_to(const std::vector<model::StiffnessPoint>& points, const Vec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const model::StiffnessPoint& one : points) least = std::min(least, (one.point_S - point).norm());
  return least;
}

}  // namespace

MapValidation validate_map(const std::string& data, const std::string& scene_file) {
  const WrittenMap written = read_written_map(scene_file);
  std::vector<MapRow> rows = identify::read_map(to_path(data));
  MapValidation made;
  try {
    made.warnings = identify::check_map(rows, written.map.tip_radius);
  } catch (const InputError& error) {
    throw InputError(data + ": " + error.what());
  }
  const std::vector<double> forces = identify::predicted_forces(written.map, rows, rows);
  std::set<int> probes;
  std::set<int> outside;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double sum = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double error = std::abs(forces[i] - rows[i].force);
    sum += error * error;
    made.largest = std::max(made.largest, error);
    low = std::min(low, rows[i].force);
    high = std::max(high, rows[i].force);
    if (rows[i].depth > written.deepest + 1e-6) ++made.deeper_rows;
    if (probes.insert(rows[i].probe).second &&
        distance_to(written.map.stiffness, rows[i].point) > model::kFarthestStiffnessPoint) {
      outside.insert(rows[i].probe);
    }
  }
  made.rows = rows.size();
  made.probes = probes.size();
  made.outside_probes = outside.size();
  made.range = high - low;
  made.rms = std::sqrt(sum / static_cast<double>(rows.size()));
  if (!std::isfinite(made.rms)) throw InputError(data + ": the map predicts no number for a force");
  if (!(made.range > 0.0)) throw InputError(data + ": force_N is the same in all rows");
  if (made.outside_probes == made.probes) {
    throw InputError(
        fmt::format("{}: all {} probes are more than {} mm from every probe of {}: must be in the "
                    "frame of the fitted map",
                    data, made.probes, brief(model::kFarthestStiffnessPoint / kMillimetre, 3), scene_file));
  }
  return made;
}

std::string map_validation_text(const MapValidation& map, const std::vector<std::string>& missed) {
  std::string text = fmt::format(
      "{} probes, {} rows, force range {} N\nRMS error {} N, {} of the range; largest error {} N\n",
      map.probes, map.rows, brief(map.range, 3), brief(map.rms, 3), percent(map.rms / map.range, 1),
      brief(map.largest, 3));
  if (map.outside_probes > 0) {
    text +=
        fmt::format("{} probes are more than 5 mm from every fitted probe: their forces are extrapolated\n",
                    map.outside_probes);
  }
  if (map.deeper_rows > 0) {
    text += fmt::format("{} rows are deeper than the fitted ones: their forces are extrapolated\n",
                        map.deeper_rows);
  }
  for (const std::string& one : map.warnings) text += "! " + one + '\n';
  for (const std::string& one : missed) text += "missed: " + one + '\n';
  return text;
}

std::string map_validation_json(const MapValidation& map, const std::vector<std::string>& missed) {
  const nlohmann::ordered_json json = {{"map",
                                        {{"probes", map.probes},
                                         {"rows", map.rows},
                                         {"range_N", map.range},
                                         {"rms_N", map.rms},
                                         {"nrmse", map.rms / map.range},
                                         {"max_error_N", map.largest},
                                         {"probes_outside", map.outside_probes},
                                         {"rows_deeper", map.deeper_rows}}},
                                       {"warnings", map.warnings},
                                       {"missed", missed}};
  return json_text(json) + '\n';
}

}  // namespace palpate::app
