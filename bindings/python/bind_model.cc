// Tissues, force laws and touch noise.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "core/model/layer_fields.h"
#include "core/model/tissue_fields.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/spring_law.h"
#include "palpate/touch_noise.h"

#include "bindings/python/binding.h"
#include "bindings/python/docs.h"

namespace palpate::python {
namespace {

using model::LayeredSpringLaw;
using model::SmoothSpringLaw;
using model::TissueParameters;
using noise::TouchNoise;

/// Result of a force law as a row of a structured array.
struct Response {
  double depth;
  double force;
  double stiffness;
  std::int32_t cutoff_layer;
  bool saturated;
  double deformation[LayeredSpringLaw::kMaxLayers];
};

Response response_of(const LayeredSpringLaw::LayerState& state) {
  Response response{state.depth, state.force, state.stiffness, state.cutoff_layer, state.saturated, {}};
  std::copy(state.deformation.begin(), state.deformation.end(), response.deformation);
  return response;
}

/// Layers as dictionaries with the C++ names, SI units; the last one's thickness is infinite.
py::list layers_of(const TissueParameters& tissue) {
  py::list layers;
  for (const model::TissueLayer& layer : tissue.layers) {
    py::dict made;
    made["name"] = layer.name;
    made["thickness"] = layer.thickness;
    for (const model::LayerField& field : model::kLayerFields) made[field.name] = layer.*field.at;
    layers.append(made);
  }
  return layers;
}

void set_layers(TissueParameters& tissue, const std::vector<py::dict>& layers) {
  std::vector<model::TissueLayer> made;
  for (const py::dict& given : layers) {
    model::TissueLayer layer;
    for (const auto& [key, value] : given) {
      const auto name = py::cast<std::string>(key);
      const auto* const field = std::find_if(model::kLayerFields.begin(), model::kLayerFields.end(),
                                             [&](const model::LayerField& one) { return name == one.name; });
      if (name == "name") {
        layer.name = py::cast<std::string>(value);
      } else if (name == "thickness") {
        layer.thickness = py::cast<double>(value);
      } else if (field != model::kLayerFields.end()) {
        layer.*field->at = py::cast<double>(value);
      } else {
        throw InputError("layers: \"" + name + "\" is no number of a layer");
      }
    }
    made.push_back(std::move(layer));
  }
  model::validate_layers(made);
  tissue.layers = std::move(made);
}

/// Binds one of the two laws, which have the same functions.
template <typename Law>
void bind_law(py::module_& module, const char* name, const char* class_doc, const char* init_doc) {
  py::class_<Law>(module, name, class_doc)
      .def(py::init([](const TissueParameters& tissue, const std::string& direction, double loop_period) {
             return Law(tissue, direction_of(direction), loop_period);
           }),
           py::arg("tissue"), py::arg("direction") = "press", py::arg("loop_period") = 1e-3, init_doc)
      .def(
          "deformation_at",
          [](const Law& law, const Numbers& depth) -> RowOrRows {
            return vectorised<Response>(depth,
                                        [&](double one) { return response_of(law.deformation_at(one)); });
          },
          py::arg("depth"), doc("LayeredSpringLaw::deformation_at"))
      .def(
          "deformation_under",
          [](const Law& law, const Numbers& force) -> RowOrRows {
            return vectorised<Response>(force,
                                        [&](double one) { return response_of(law.deformation_under(one)); });
          },
          py::arg("force"), doc("LayeredSpringLaw::deformation_under"))
      .def(
          "force_at",
          [](const Law& law, const Numbers& depth) -> NumberOrArray {
            return vectorised<double>(depth, [&](double one) { return law.force_at(one).force; });
          },
          py::arg("depth"),
          "Contact force [N] at a penetration depth [m]; stiffness_at() gives the tangent stiffness. A depth "
          "<= 0 gives 0. Beyond the tissue's max_depth the force goes on by its tangent there; beyond the "
          "last layer it stays constant. NaN gives NaN.")
      .def(
          "stiffness_at",
          [](const Law& law, const Numbers& depth) -> NumberOrArray {
            return vectorised<double>(depth, [&](double one) { return law.force_at(one).stiffness; });
          },
          py::arg("depth"),
          "Tangent stiffness dF/dD [N/m] at a penetration depth [m]; at the end of a layer that of this "
          "layer; 0 beyond the last layer.")
      .def(
          "depth_under",
          [](const Law& law, const Numbers& force) -> NumberOrArray {
            return vectorised<double>(force, [&](double one) { return law.deformation_under(one).depth; });
          },
          py::arg("force"),
          "Penetration depth [m] under a contact force [N]: the inverse of force_at(). A force <= 0 gives 0.")
      .def_property_readonly("layers_allowed", &Law::layers_allowed, doc("LayeredSpringLaw::layers_allowed"))
      .def_property_readonly("max_depth", &Law::max_depth, doc("LayeredSpringLaw::max_depth"))
      .def_property_readonly("max_force", &Law::max_force,
                             "Force [N] at max_depth; infinite when the law goes on by its tangent.");
}

/// Binds each numeric tissue parameter as a property.
void bind_tissue_numbers(py::class_<TissueParameters>& tissue) {
  for (const model::TissueField& field : model::kTissueFields) {
    const std::string unit = *field.unit.si_text == '\0' ? "" : "[" + std::string(field.unit.si_text) + "] ";
    const auto& at = field.at;
    if (field.optional()) {
      tissue.def_property(
          field.name, [at](const TissueParameters& of) { return at.get(of); },
          [at](TissueParameters& of, std::optional<double> value) { at.set(of, value); },
          (unit + field.meaning + "; None: " + field.derived_text).c_str());
    } else {
      tissue.def_property(
          field.name, [at](const TissueParameters& of) { return *at.get(of); },
          [at](TissueParameters& of, double value) { at.set(of, value); }, (unit + field.meaning).c_str());
    }
  }
}

void bind_tissue(py::module_& module) {
  py::class_<TissueParameters> bound(module, "Tissue", doc("TissueParameters"));
  bind_tissue_numbers(bound);
  bound.def(py::init<>())
      .def_readwrite("name", &TissueParameters::name)
      .def_property(
          "law", [](const TissueParameters& tissue) { return model::to_string(tissue.law); },
          [](TissueParameters& tissue, const std::string& law) { tissue.law = model::parse_law(law); },
          doc("LawKind"))
      .def_property(
          "relaxation",
          [](const TissueParameters& tissue) {
            std::vector<std::pair<double, double>> terms;
            for (const model::RelaxationTerm& term : tissue.relaxation) terms.emplace_back(term.g, term.tau);
            return terms;
          },
          [](TissueParameters& tissue, const std::vector<std::pair<double, double>>& terms) {
            model::RelaxationTerms made;
            for (const auto& [share, time] : terms) made.push_back({share, time});
            model::validate_relaxation(made);
            tissue.relaxation = made;
          },
          doc("RelaxationTerm"))
      .def_property("layers", &layers_of, &set_layers, doc("TissueLayer"))
      .def_property(
          "reach",
          [](const TissueParameters& tissue) {
            const model::FalloffRatios& reach = tissue.reach;
            return std::tuple(reach.contact_ratio, reach.first_bar_ratio, reach.bar_ratio,
                              reach.weight_ratio);
          },
          [](TissueParameters& tissue, const std::tuple<double, double, double, double>& ratios) {
            const auto& [c, a, s, g] = ratios;
            tissue.reach = {c, a, s, g, tissue.reach.depth_exponent};
          },
          "Falloff ratios of the displacement profile around a contact (docs/model.md, section 3): "
          "contact_ratio c, first_bar_ratio a, bar_ratio s and weight_ratio g, without unit.")
      .def(
          "first_limit",
          [](const TissueParameters& tissue, const std::string& direction) {
            return tissue.first_limit(direction_of(direction));
          },
          py::arg("direction"), doc("TissueNumbers::first_limit"))
      .def(
          "validate", [](const TissueParameters& tissue) { model::validate(tissue); }, doc("validate"))
      .def("to_toml", &scene::to_toml, doc("to_toml"))
      .def("__copy__", [](const TissueParameters& tissue) { return tissue; })
      .def(
          "__deepcopy__", [](const TissueParameters& tissue, const py::dict&) { return tissue; },
          py::arg("memo"));
  module.def(
      "tissue_names",
      [] {
        const auto names = model::tissue_preset_names();
        return std::vector<std::string>(names.begin(), names.end());
      },
      doc("tissue_preset_names"));
  module.def("tissue_preset", &model::tissue_preset, py::arg("name"), doc("tissue_preset"));
  module.def("load_tissue", &scene::load_tissue, py::arg("name_or_file"), doc("load_tissue"));
}

/// The steady noise of the samples first .. first + count.
py::array_t<double> noise_forces(const TouchNoise& noise, std::size_t count, double distance,
                                 std::uint32_t hand, std::uint64_t first) {
  if (std::isnan(distance)) throw ParameterError("distance", distance, "a number (m)");
  py::array_t<double> forces(static_cast<py::ssize_t>(count));
  double* to = forces.mutable_data();
  const py::gil_scoped_release others_may_run;
  TouchNoise::State state;
  for (std::size_t i = 0; i < count; ++i) to[i] = noise.force(state, true, hand, first + i, distance);
  return forces;
}

void bind_noise(py::module_& module) {
  const noise::NoiseSettings usual;
  py::class_<TouchNoise>(module, "TouchNoise", doc("TouchNoise"))
      .def(py::init([](double gain, double threshold, std::uint64_t seed, double rate_Hz,
                       double loop_rate_Hz) {
             return TouchNoise(
                 {.enabled = true, .gain = gain, .threshold = threshold, .rate_Hz = rate_Hz, .seed = seed},
                 loop_rate_Hz);
           }),
           py::arg("gain") = usual.gain, py::arg("threshold") = usual.threshold, py::arg("seed") = usual.seed,
           py::arg("rate_Hz") = usual.rate_Hz, py::arg("loop_rate_Hz") = usual.rate_Hz,
           doc("TouchNoise::TouchNoise"))
      .def(
          "sigma",
          [](const TouchNoise& noise, const Numbers& distance) -> NumberOrArray {
            return vectorised<double>(distance, [&](double one) {
              if (std::isnan(one)) throw ParameterError("distance", one, "a number (m)");
              return noise.sigma(one);
            });
          },
          py::arg("distance"), doc("TouchNoise::sigma"))
      .def("forces", &noise_forces, py::arg("count"), py::arg("distance") = 0.0, py::arg("hand") = 0,
           py::arg("first") = 0, doc("TouchNoise::force"));
  module.def("gain_from_threshold", &noise::gain_from_threshold, py::arg("user_threshold"), py::arg("share"),
             py::arg("threshold_distance"), doc("gain_from_threshold"));
}

}  // namespace

void bind_model(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(Response, depth, force, stiffness, cutoff_layer, saturated, deformation);
  bind_tissue(module);
  bind_law<LayeredSpringLaw>(module, "LayeredSpringLaw", doc("LayeredSpringLaw"),
                             doc("LayeredSpringLaw::LayeredSpringLaw"));
  bind_law<SmoothSpringLaw>(module, "SmoothSpringLaw", doc("SmoothSpringLaw"),
                            doc("SmoothSpringLaw::SmoothSpringLaw"));
  module.def(
      "spring_law",
      [](const TissueParameters& tissue, const std::string& direction,
         double loop_period) -> std::variant<LayeredSpringLaw, SmoothSpringLaw> {
        if (tissue.law == model::LawKind::kSmooth) {
          return SmoothSpringLaw(tissue, direction_of(direction), loop_period);
        }
        return LayeredSpringLaw(tissue, direction_of(direction), loop_period);
      },
      py::arg("tissue"), py::arg("direction") = "press", py::arg("loop_period") = 1e-3,
      "The law that the tissue has: a LayeredSpringLaw or a SmoothSpringLaw, as `tissue.law` says.");
  bind_noise(module);
}

}  // namespace palpate::python
