// Comparison of a tissue with measurements: force curves, surface profiles, photographs.
#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/text.h"
#include "palpate/error.h"

#include "bindings/python/scene_arguments.h"
#include "fit/imaging/compare.h"
#include "fit/imaging/validation_fields.h"
#include "fit/python/docs.h"
#include "fit/python/module.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using validate::Deformation;

/// One value for all profiles, or one per profile; metres or newtons.
using PerProfile = std::optional<std::variant<double, std::vector<double>>>;

Deformation make_deformation(std::string name, const Numbers& distance, const Numbers& displacement,
                             double depth) {
  const auto list = [](const Numbers& numbers, const char* what) {
    if (numbers.ndim() != 1) throw InputError(std::string(what) + ": must be one row of numbers");
    return std::vector<double>(numbers.data(), numbers.data() + numbers.size());
  };
  Deformation made{std::move(name), depth, list(distance, "distance"), list(displacement, "displacement")};
  if (made.distance.size() != made.displacement.size()) {
    throw InputError("distance and displacement: must have the same length");
  }
  if (!(depth >= 0.0)) throw ParameterError("depth", depth, ">= 0 (m; 0: not known)");
  validate::check_deformation(made, "deformation '" + made.name + "'");
  return made;
}

void bind_deformation(py::module_& module) {
  py::class_<Deformation>(module, "Deformation", doc("Deformation"))
      .def(py::init(&make_deformation), py::arg("name"), py::arg("distance"), py::arg("displacement"),
           py::arg("depth") = 0.0)
      .def_readonly("name", &Deformation::name)
      .def_readonly("depth", &Deformation::depth, doc("Deformation::depth"))
      .def_property_readonly(
          "distance", [](const Deformation& one) { return array_of(one.distance); },
          doc("Deformation::distance"))
      .def_property_readonly(
          "displacement", [](const Deformation& one) { return array_of(one.displacement); },
          doc("Deformation::displacement"));
  module.def(
      "read_deformations",
      [](const FilesArgument& file) { return read_all(file, &validate::read_deformations); }, py::arg("file"),
      py::call_guard<py::gil_scoped_release>(),
      (std::string(doc("read_deformations")) + " A list of files gives the profiles of all.").c_str());
}

constexpr imaging::RequestNames kArgumentNames = {
    "depth",
    "force",
    "tip_radius",
    "nothing to compare with: give forces, profiles or image",
    "zeros, first_contact and offset: are of force curves, need forces",
    "zeros = \"fitted\": finds the zeros, first_contact and offset give them: one of the two",
    "as_drawn: is of a ball pressed in, needs profiles and direction = \"press\"",
    "depth, force and tip_radius: are of profiles, need profiles or image"};

/// The values of an argument, each > 0.
std::optional<std::vector<double>> positive_list(const char* name, const PerProfile& given) {
  if (!given) return std::nullopt;
  const double* one = std::get_if<double>(&*given);
  const std::vector<double> values =
      one != nullptr ? std::vector<double>{*one} : std::get<std::vector<double>>(*given);
  for (const double value : values) {
    if (!(value > 0.0)) throw ParameterError(name, value, "> 0");
  }
  return values;
}

void require_positive(const char* name, const std::optional<double>& value, const char* want) {
  if (value && !(*value > 0.0)) throw ParameterError(name, *value, want);
}

template <typename Result, typename... Of>
py::dict result_dictionary(const Result& result, const Of&... of);

template <typename Value>
py::object result_object(const identify::ResultField& field, const Value& value) {
  if constexpr (std::same_as<Value, std::vector<double>>) {
    return array_of(value);
  } else if constexpr (std::same_as<Value, std::vector<validate::BaselineResult>>) {
    py::list all;
    for (const validate::BaselineResult& baseline : value) all.append(result_dictionary(baseline, field));
    return all;
  } else if constexpr (std::same_as<Value, validate::ZeroedErrors>) {
    return result_dictionary(value);
  } else {
    return py::cast(value);
  }
}

/// The fields of a result, in SI units. @param of of its set, for a baseline model's
template <typename Result, typename... Of>
py::dict result_dictionary(const Result& result, const Of&... of) {
  py::dict fields;
  for_each_field(result, of..., [&fields](const identify::ResultField& field, const auto& value) {
    if ((field.outputs & identify::kInPython) != 0) fields[field.key] = result_object(field, value);
  });
  return fields;
}

py::dict image_dictionary(const imaging::ImageSet& image) {
  std::vector<double> r;
  std::vector<double> u;
  std::vector<double> uncertainty;
  for (const imaging::ImagePoint& point : image.measured.points) {
    r.push_back(point.right ? point.r : -point.r);
    u.push_back(point.u);
    uncertainty.push_back(point.uncertainty);
  }
  py::dict result = result_dictionary(image);
  result["r"] = array_of(r);
  result["u"] = array_of(u);
  result["u_uncertainty"] = array_of(uncertainty);
  return result;
}

py::dict reach_dictionary(const validate::FalloffFit& fit) {
  py::dict result;
  py::list at_limit;
  for_each_ratio(fit, [&](const char* key, double ratio, bool is_at_limit) {
    result[key] = ratio;
    if (is_at_limit) at_limit.append(key);
  });
  result["at_limit"] = at_limit;
  result["depth_exponent_kept"] = fit.exponent_kept;
  return result;
}

py::dict validation_dictionary(const imaging::Validation& validation) {
  py::list forces;
  py::list profiles;
  for (const validate::ForceSet& set : validation.forces) forces.append(result_dictionary(set));
  for (const validate::ProfileSet& set : validation.profiles) profiles.append(result_dictionary(set));
  py::dict result;
  result["tissue"] = validation.law.tissue;
  result["forces"] = forces;
  result["profiles"] = profiles;
  if (validation.reach) result["reach"] = reach_dictionary(*validation.reach);
  if (validation.image) result["image"] = image_dictionary(*validation.image);
  return result;
}

py::dict validate(const TissueArgument& tissue, std::vector<identify::Specimen> forces,
                  std::vector<Deformation> profiles,
                  const std::optional<std::pair<fs::path, fs::path>>& image, double pixel, bool fixed_camera,
                  const std::optional<std::string>& law, const std::string& direction, double loop_period,
                  double first_contact, double offset, const std::string& zeros, const PerProfile& depth,
                  const PerProfile& force, std::optional<double> tip_radius, bool fit_reach, bool as_drawn,
                  std::optional<double> surface_radius, const std::vector<std::string>& against) {
  if (!(loop_period > 0.0)) throw ParameterError("loop_period", loop_period, "> 0 (s)");
  if (zeros != "given" && zeros != "fitted")
    throw InputError("zeros = \"" + zeros + "\": must be given or fitted");
  if (surface_radius && !as_drawn) throw InputError("surface_radius: needs as_drawn");
  require_positive("surface_radius", surface_radius, "> 0 (m)");
  require_positive("tip_radius", tip_radius, "> 0 (m)");
  if (depth && force) throw InputError("depth and force are both given, must be at most one");
  if (fit_reach && profiles.empty()) throw InputError("fit_reach: needs profiles");
  imaging::Request request;
  request.law = {tissue_of(tissue), direction_of(direction), loop_period};
  if (law) request.law.tissue.law = model::parse_law(*law);
  request.forces = std::move(forces);
  request.profiles = std::move(profiles);
  if (image) {
    require_positive("pixel", pixel, "> 0 (m a pixel)");
    request.photographs = imaging::Photographs{image->first, image->second, pixel, fixed_camera};
  }
  request.zeros_fitted = zeros == "fitted";
  if (first_contact != 0.0) request.first_contact = first_contact;
  if (offset != 0.0) request.offset = offset;
  request.depths = positive_list(kArgumentNames.depths, depth);
  request.loads = positive_list(kArgumentNames.loads, force);
  request.tip_radius = tip_radius;
  request.fit_reach = fit_reach;
  request.rule = {as_drawn, surface_radius.value_or(0.0)};
  request.baselines = validate::parse_baselines(joined(against, ","));
  imaging::Validation validation;
  {
    const py::gil_scoped_release others_may_run;
    validation = imaging::compare(request, kArgumentNames);
  }
  return validation_dictionary(validation);
}

}  // namespace

void bind_validate(py::module_& module) {
  bind_deformation(module);
  const py::none none;
  module.def(
      "validate", &validate, py::arg("tissue"), py::kw_only(),
      py::arg("forces") = std::vector<identify::Specimen>{}, py::arg("profiles") = std::vector<Deformation>{},
      py::arg("image") = none, py::arg("pixel") = 0.0, py::arg("fixed_camera") = false, py::arg("law") = none,
      py::arg("direction") = "press", py::arg("loop_period") = 1e-3, py::arg("first_contact") = 0.0,
      py::arg("offset") = 0.0, py::arg("zeros") = "given", py::arg("depth") = none, py::arg("force") = none,
      py::arg("tip_radius") = none, py::arg("fit_reach") = false, py::arg("as_drawn") = false,
      py::arg("surface_radius") = none, py::arg("against") = std::vector<std::string>{},
      "Compares a tissue (a Tissue, a built-in name or a tissue file) with measurements, as `palpate "
      "validate` does (docs/validation.md). forces: from read_specimens(); first_contact (m) and offset "
      "(N) are their zeros, or zeros='fitted' finds them. profiles: from read_deformations(); depth (m) or "
      "force (N), one value or one per profile, unless the profiles state a depth; tip_radius (m), unless "
      "the tissue's source states it; as_drawn: compare with the visible surface, which is never above the "
      "ball; surface_radius (m): radius of a surface that is convex at rest. image: two photographs, before "
      "and after, with pixel (m). against: hertz, linear, exponential, mass-spring. Returns a dictionary in "
      "SI units: tissue, forces (each with zeros_given and zeros_fitted) and profiles, each with rms, max, "
      "nrmse, measured, computed and against; reach and image if requested. Raises InputError.");
}

}  // namespace palpate::python
