#include "bindings/python/inclusion_argument.h"

#include <utility>

#include "io/scene/names.h"
#include "palpate/error.h"

namespace palpate::python {

scene::InclusionTable inclusion_preset(const std::string& name) {
  if (std::optional<scene::InclusionTable> found = scene::find_inclusion_preset(name))
    return *std::move(found);
  throw InputError("inclusion = \"" + name + "\": must be " + scene::inclusion_preset_names());
}

void set_inclusions(const std::vector<InclusionArgument>& arguments, scene::Scene& scene) {
  if (arguments.size() > model::kMaxInclusions) {
    throw InputError("inclusions: " + std::to_string(arguments.size()) + " are given, must be at most " +
                     std::to_string(model::kMaxInclusions));
  }
  std::vector<scene::InclusionTable> tables;
  for (const InclusionArgument& argument : arguments) {
    const auto* name = std::get_if<std::string>(&argument);
    tables.push_back(name != nullptr ? inclusion_preset(*name) : std::get<scene::InclusionTable>(argument));
    tables.back().where = "inclusions[" + std::to_string(tables.size() - 1) + "]";
    model::validate(tables.back().setup.inclusion);
  }
  scene.inclusions.clear();
  scene::place_inclusions(tables, scene);
}

scene::StiffnessMapFile stiffness_of(const StiffnessArgument& argument) {
  if (const auto* file = std::get_if<std::filesystem::path>(&argument))
    return scene::read_stiffness_map(*file);
  const Numbers& numbers = std::get<Numbers>(argument);
  if (numbers.ndim() != 2 || numbers.shape(1) != 4) {
    throw InputError("stiffness_map: must be an array of the shape (points, 4): x, y, z and factor");
  }
  if (static_cast<std::size_t>(numbers.shape(0)) > model::kMaxStiffnessPoints) {
    throw InputError("stiffness_map: has " + std::to_string(numbers.shape(0)) +
                     " points, must have at most " + std::to_string(model::kMaxStiffnessPoints));
  }
  scene::StiffnessMapFile map;
  for (py::ssize_t i = 0; i < numbers.shape(0); ++i) {
    map.points.push_back({{numbers.at(i, 0), numbers.at(i, 1), numbers.at(i, 2)}, numbers.at(i, 3)});
    model::validate(map.points.back(), "factor of stiffness_map[" + std::to_string(i) + "]");
  }
  return map;
}

std::vector<scene::InclusionTable> inclusion_tables(const scene::Scene& scene,
                                                    const std::vector<model::Inclusion>& now) {
  std::vector<scene::InclusionTable> tables;
  for (std::size_t i = 0; i < now.size(); ++i) {
    scene::InclusionTable table;
    table.setup = scene.inclusions[i];
    table.setup.inclusion = now[i];
    table.has_centre = true;
    tables.push_back(std::move(table));
  }
  return tables;
}

std::size_t inclusion_index(const scene::Scene& scene, const std::variant<std::size_t, std::string>& which) {
  const std::size_t count = scene.inclusions.size();
  if (const auto* index = std::get_if<std::size_t>(&which)) {
    if (*index < count) return *index;
    throw InputError("inclusion = " + std::to_string(*index) + ": must be less than the " +
                     std::to_string(count) + " inclusions");
  }
  const auto& name = std::get<std::string>(which);
  std::vector<std::string> names;
  std::size_t found = count;
  std::size_t matches = 0;
  for (std::size_t i = 0; i < count; ++i) {
    names.push_back(scene.inclusions[i].name);
    if (names.back() != name) continue;
    found = i;
    ++matches;
  }
  if (matches == 1) return found;
  throw InputError("inclusion = \"" + name + "\": " +
                   (matches > 1     ? "several have this name, give the number"
                    : names.empty() ? "the scene has no inclusions"
                                    : "must be " + scene::alternatives(names)));
}

haptics::LiveInclusion live_inclusion(std::size_t index, const model::Inclusion& now,
                                      const std::optional<Numbers>& position, std::optional<double> ratio) {
  model::Inclusion changed = now;
  if (position) changed.centre_S = position_of(*position, "position");
  changed.ratio = ratio.value_or(now.ratio);
  model::validate(changed);
  const Vec3& centre_S = changed.centre_S;
  return {static_cast<std::uint32_t>(index), {centre_S.x(), centre_S.y(), centre_S.z()}, changed.ratio};
}

Vec3 position_of(const Numbers& numbers, const char* name) {
  if (numbers.size() != 3) throw InputError(std::string(name) + ": must have three numbers");
  const Vec3 position(numbers.data()[0], numbers.data()[1], numbers.data()[2]);
  if (!position.allFinite()) throw InputError(std::string(name) + ": must be finite");
  return position;
}

}  // namespace palpate::python
