// Inclusions: spheres in the organ of another stiffness.
#include <optional>
#include <string>
#include <vector>

#include "palpate/error.h"

#include "bindings/python/binding.h"
#include "bindings/python/docs.h"
#include "bindings/python/inclusion_argument.h"

namespace palpate::python {
namespace {

using scene::InclusionTable;

InclusionTable make_inclusion(const std::optional<std::string>& preset,
                              const std::optional<Numbers>& position, const std::optional<Numbers>& under,
                              std::optional<double> depth, std::optional<double> radius,
                              std::optional<double> ratio, const std::optional<std::string>& name,
                              bool visible, std::optional<double> pulse, std::optional<double> pulse_period) {
  if (!preset && !(radius && ratio)) {
    throw InputError("Inclusion: needs radius and stiffness_ratio, or a preset");
  }
  if (position && (under || depth)) throw InputError("Inclusion: position excludes under and depth");
  if (!preset && !position && !depth) throw InputError("Inclusion: needs position or depth");
  InclusionTable made = preset ? inclusion_preset(*preset) : InclusionTable{};
  made.setup.name = name.value_or(preset.value_or("inclusion"));
  made.setup.visible = visible;
  made.has_centre = position.has_value();
  model::Inclusion& inclusion = made.setup.inclusion;
  if (position) inclusion.centre_S = position_of(*position, "position");
  if (under) made.under_S = position_of(*under, "under");
  made.depth = depth.value_or(made.depth);
  inclusion.radius = radius.value_or(inclusion.radius);
  inclusion.ratio = ratio.value_or(inclusion.ratio);
  inclusion.pulse = pulse.value_or(inclusion.pulse);
  inclusion.pulse_period = pulse_period.value_or(inclusion.pulse_period);
  model::validate(inclusion);
  return made;
}

}  // namespace

void bind_inclusions(py::module_& module) {
  const py::none none;
  py::class_<InclusionTable>(module, "Inclusion", doc("Inclusion"))
      .def(py::init(&make_inclusion), py::arg("preset") = none, py::kw_only(), py::arg("position") = none,
           py::arg("under") = none, py::arg("depth") = none, py::arg("radius") = none,
           py::arg("stiffness_ratio") = none, py::arg("name") = none, py::arg("visible") = true,
           py::arg("pulse") = none, py::arg("pulse_period") = none,
           "preset: a name of inclusion_presets(); the other arguments replace its values. position: centre "
           "in the organ frame in m; or depth: of the centre below the surface at the point nearest to "
           "`under`, or where the scene's path touches. radius in m; stiffness_ratio: Young's modulus "
           "divided by that of the tissue; pulse: rise with each heartbeat in m; pulse_period in s. "
           "visible=False: pictures do not show it. Raises InputError, ParameterError.")
      .def_property_readonly("name", [](const InclusionTable& self) { return self.setup.name; })
      .def_property_readonly(
          "visible", [](const InclusionTable& self) { return self.setup.visible; },
          "Whether pictures show it.")
      .def_property_readonly(
          "position",
          [](const InclusionTable& self) -> std::optional<py::array_t<double>> {
            if (!self.has_centre) return std::nullopt;
            return array_of(self.setup.inclusion.centre_S);
          },
          "Centre in the organ frame [m]; None until a scene places it.")
      .def_property_readonly(
          "radius", [](const InclusionTable& self) { return self.setup.inclusion.radius; }, "m")
      .def_property_readonly(
          "stiffness_ratio", [](const InclusionTable& self) { return self.setup.inclusion.ratio; },
          "Young's modulus divided by that of the tissue.")
      .def_property_readonly(
          "pulse", [](const InclusionTable& self) { return self.setup.inclusion.pulse; },
          "m, how far it rises towards the surface with each heartbeat.")
      .def_property_readonly(
          "pulse_period", [](const InclusionTable& self) { return self.setup.inclusion.pulse_period; }, "s");
  module.def(
      "inclusion_names",
      [] {
        std::vector<std::string> names;
        for (const model::InclusionPreset& preset : model::inclusion_presets())
          names.emplace_back(preset.name);
        return names;
      },
      "The names of the built-in inclusions, for Inclusion() and the argument inclusions.");
  module.def(
      "inclusion_presets",
      [] {
        py::dict presets;
        for (const model::InclusionPreset& preset : model::inclusion_presets()) {
          const std::string name(preset.name);
          presets[name.c_str()] = inclusion_preset(name);
        }
        return presets;
      },
      "The built-in inclusions by name: nodule, stone, plaque, vessel, cyst. They have no position; a scene "
      "places them at their usual depth where its path touches.");
}

}  // namespace palpate::python
