#include "bindings/python/scene_arguments.h"

#include <array>
#include <string_view>

#include "io/record/tick_columns.h"
#include "palpate/error.h"
#include "palpate/organ_cache.h"

namespace palpate::python {

namespace fs = std::filesystem;

namespace {

/// The arguments of parse_scene_arguments() whose errors name the flag of `palpate run`; a longer name first.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kFlagArguments{{
    {"--organ-unit", "organ_unit"},
    {"--organ-motion", "organ_motion"},
    {"--organ-support", "organ_support"},
    {"--organ", "organ"},
    {"--tissue", "tissue"},
    {"--tool-unit", "tool_unit"},
    {"--tool", "tool"},
    {"--device", "device"},
    {"--rate-Hz", "rate_Hz"},
    {"--task", "task"},
}};

/// A message of scene::load() with the names of Python's arguments in place of flags.
std::string with_argument_names(std::string message) {
  for (const auto& [flag, argument] : kFlagArguments) {
    std::size_t at = 0;
    while ((at = message.find(flag, at)) != std::string::npos) {
      const std::size_t end = at + flag.size();
      const bool is_longer = end < message.size() && message[end] == '-';  // --organ-frame is no argument
      if (!is_longer) message.replace(at, flag.size(), argument);
      at += is_longer ? flag.size() : argument.size();
    }
  }
  // "tissue: tissue = ..." of a flag before the reader's own message
  const std::size_t colon = message.find(": ");
  if (colon != std::string::npos &&
      message.compare(colon + 2, colon + 3, message.substr(0, colon) + " = ") == 0) {
    message.erase(0, colon + 2);
  }
  return message;
}

/// [setup] Loads the scene. @throws InputError, ParameterError that name arguments, not flags
scene::Scene load_by_arguments(const scene::Overrides& request) {
  try {
    return scene::load(request);
  } catch (const ParameterError& error) {
    if (error.field() != "--rate-Hz") throw;
    const std::string message = error.what();
    const std::string_view want = ": must be ";
    throw ParameterError("rate_Hz", *request.rate_Hz, message.substr(message.find(want) + want.size()));
  } catch (const InputError& error) {
    throw InputError(with_argument_names(error.what()));
  }
}

}  // namespace

scene::Scene SceneArguments::load(bool cache) const {
  scene::Overrides with_cache = request;
  with_cache.store = preparation_of(cache).store;
  scene::Scene scene = load_by_arguments(with_cache);
  if (tissue) scene.tissue = *tissue;
  if (inclusions) set_inclusions(*inclusions, scene);
  if (stiffness) {
    scene.stiffness = stiffness->points;
    scene.remarks.insert(scene.remarks.end(), stiffness->remarks.begin(), stiffness->remarks.end());
  }
  return scene;
}

model::TissueParameters tissue_of(const TissueArgument& arguments) {
  if (const auto* name = std::get_if<std::string>(&arguments)) return scene::load_tissue(*name);
  auto tissue = std::get<model::TissueParameters>(arguments);
  model::validate(tissue);
  return tissue;
}

SceneArguments parse_scene_arguments(
    const std::optional<fs::path>& scene, const std::optional<std::string>& scene_text,
    const std::optional<std::string>& task, const std::optional<std::string>& organ,
    const std::optional<std::string>& organ_unit, const std::vector<std::string>& organ_motion,
    const std::optional<TissueArgument>& tissue,
    const std::optional<std::variant<std::string, std::vector<std::string>>>& tool,
    const std::optional<std::string>& tool_unit, const std::optional<std::string>& device,
    std::optional<double> rate_Hz, std::optional<std::uint64_t> seed, bool noise,
    std::optional<std::vector<InclusionArgument>> inclusions,
    const std::optional<StiffnessArgument>& stiffness_map, const std::vector<std::string>& organ_support) {
  if (scene && scene_text) throw InputError("scene and scene_text are both given, must be at most one");
  SceneArguments arguments;
  scene::Overrides& request = arguments.request;
  request.scene = scene;
  if (scene_text) request.scene_text = {*scene_text, {}};
  request.task = task;
  request.organ = organ;
  request.organ_unit = organ_unit;
  request.organ_motion = organ_motion;
  request.organ_support = organ_support;
  if (tissue && std::holds_alternative<std::string>(*tissue)) {
    request.tissue = std::get<std::string>(*tissue);
  } else if (tissue) {
    arguments.tissue = tissue_of(*tissue);
  }
  if (tool && std::holds_alternative<std::string>(*tool)) {
    request.tools = {std::get<std::string>(*tool)};
  } else if (tool) {
    request.tools = std::get<std::vector<std::string>>(*tool);
  }
  request.tool_unit = tool_unit;
  request.device = device;
  request.rate_Hz = rate_Hz;
  request.seed = seed;
  request.no_noise = !noise;
  arguments.inclusions = std::move(inclusions);
  if (stiffness_map) arguments.stiffness = stiffness_of(*stiffness_map);
  return arguments;
}

contact::Preparation preparation_of(bool cache) {
  contact::Preparation how;
  if (cache) scene::use_organ_cache(how);
  return how;
}

std::vector<std::string> remarks_of(const scene::Scene& scene) {
  std::vector<std::string> remarks = scene.repairs;
  remarks.insert(remarks.end(), scene.remarks.begin(), scene.remarks.end());
  return remarks;
}

py::dtype row_type() {
  py::list names;
  py::list formats;
  py::list offsets;
  for (const record::Column& column : record::tick_columns()) {
    names.append(column.name);
    offsets.append(column.offset);
    switch (column.type) {
      case record::ColumnType::kU32:
        formats.append("u4");
        break;
      case record::ColumnType::kU64:
        formats.append("u8");
        break;
      case record::ColumnType::kI64:
        formats.append("i8");
        break;
      case record::ColumnType::kF64:
        formats.append("f8");
        break;
    }
  }
  return py::dtype(names, formats, offsets, sizeof(haptics::TickRow));
}

}  // namespace palpate::python
