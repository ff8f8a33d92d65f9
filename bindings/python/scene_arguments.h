#pragma once
// Arguments of Python calls that select a scene.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/preparation.h"
#include "palpate/scene.h"
#include "palpate/tick_row.h"

#include "bindings/python/binding.h"
#include "bindings/python/inclusion_argument.h"

namespace palpate::python {

/// Arguments of a call that override the scene file.
struct SceneArguments {
  scene::Overrides request;
  std::optional<model::TissueParameters> tissue;             // replaces a name or file
  std::optional<std::vector<InclusionArgument>> inclusions;  // replace the scene's
  std::optional<scene::StiffnessMapFile> stiffness;          // replaces the scene's

  /// [setup] @param cache use the user's cache of organs @throws InputError as scene::load() does,
  /// ParameterError for an invalid tissue
  [[nodiscard]] scene::Scene load(bool cache) const;
};

/// Tissue argument: an object, or the name of a built-in tissue or a tissue file.
using TissueArgument = std::variant<model::TissueParameters, std::string>;

/// [setup] @throws InputError as scene::load_tissue() does, ParameterError for an invalid tissue
[[nodiscard]] model::TissueParameters tissue_of(const TissueArgument& arguments);

/// [setup] @throws InputError if two scenes are given
[[nodiscard]] SceneArguments parse_scene_arguments(
    const std::optional<std::filesystem::path>& scene, const std::optional<std::string>& scene_text,
    const std::optional<std::string>& task, const std::optional<std::string>& organ,
    const std::optional<std::string>& organ_unit, const std::vector<std::string>& organ_motion,
    const std::optional<TissueArgument>& tissue,
    const std::optional<std::variant<std::string, std::vector<std::string>>>& tool,
    const std::optional<std::string>& tool_unit, const std::optional<std::string>& device,
    std::optional<double> rate_Hz, std::optional<std::uint64_t> seed, bool noise,
    std::optional<std::vector<InclusionArgument>> inclusions,
    const std::optional<StiffnessArgument>& stiffness_map, const std::vector<std::string>& organ_support);

/// Options for preparing the organ, with or without the user's cache.
[[nodiscard]] contact::Preparation preparation_of(bool cache);

/// Remarks on a scene for the user: mesh repairs, then warnings.
[[nodiscard]] std::vector<std::string> remarks_of(const scene::Scene& scene);

/// NumPy type of a TickRow, with the column names of a recording.
[[nodiscard]] py::dtype row_type();

/// Names and defaults of the arguments of parse_scene_arguments(), in order; `second` after the first one.
template <typename... Second>
[[nodiscard]] auto scene_arguments(const Second&... second) {
  const py::none none;
  return std::make_tuple(py::arg("scene") = none, second..., py::kw_only(), py::arg("scene_text") = none,
                         py::arg("task") = none, py::arg("organ") = none, py::arg("organ_unit") = none,
                         py::arg("organ_motion") = std::vector<std::string>{}, py::arg("tissue") = none,
                         py::arg("tool") = none, py::arg("tool_unit") = none, py::arg("device") = none,
                         py::arg("rate_Hz") = none, py::arg("seed") = none, py::arg("noise") = true,
                         py::arg("inclusions") = none, py::arg("stiffness_map") = none,
                         py::arg("organ_support") = std::vector<std::string>{});
}

/// The function behind of_a_scene(): `Second` stands after the first argument of `parse`, `More` after all.
template <typename... Second, typename... More, typename Function, typename Scene, typename... Others>
auto with_scene_arguments(std::tuple<Second...>*, std::tuple<More...>*, Function function,
                          SceneArguments (*parse)(Scene, Others...)) {
  return [function, parse](Scene scene, Second... second, Others... others, More... more) {
    return function(parse(scene, std::forward<Others>(others)...), std::move(second)..., std::move(more)...);
  };
}

/// Wraps a function of a scene and `More` arguments: the result takes the arguments of
/// parse_scene_arguments() and then `More`.
template <typename... More, typename Function>
auto of_a_scene(Function function) {
  return with_scene_arguments(static_cast<std::tuple<>*>(nullptr), static_cast<std::tuple<More...>*>(nullptr),
                              function, &parse_scene_arguments);
}

/// As of_a_scene(), with an argument `Second` after the first one, the scene.
template <typename Second, typename... More, typename Function>
auto of_a_scene_and(Function function) {
  return with_scene_arguments(static_cast<std::tuple<Second>*>(nullptr),
                              static_cast<std::tuple<More...>*>(nullptr), function, &parse_scene_arguments);
}

}  // namespace palpate::python
