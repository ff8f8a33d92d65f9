// Comparison of a tissue with measurements: force curves, surface profiles, photographs.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/error.h"

#include "bindings/python/scene_arguments.h"
#include "fit/imaging/compare.h"
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
  module.def("read_deformations", &validate::read_deformations, py::arg("file"),
             py::call_guard<py::gil_scoped_release>(), doc("read_deformations"));
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

void put(const validate::Errors& errors, py::dict& result) {
  result["rms"] = errors.rms;
  result["max"] = errors.max;
  result["nrmse"] = errors.nrmse;
}

/// Adds the baseline models' results for the same data, if any.
void put(const std::vector<validate::BaselineResult>& baselines, double cost_ns, py::dict& result) {
  if (baselines.empty()) return;
  py::list others;
  for (const validate::BaselineResult& baseline : baselines) {
    py::dict other;
    other["name"] = validate::to_string(baseline.fit.kind);
    other["parameters"] = baseline.fit.parameters;
    put(baseline.fit.errors, other);
    other["computed"] = array_of(baseline.fit.computed);
    other["evaluation_ns"] = baseline.cost_ns;
    others.append(other);
  }
  result["evaluation_ns"] = cost_ns;
  result["against"] = others;
}

py::dict dictionary_of(const validate::ZeroedErrors& with) {
  py::dict result;
  result["first_contact"] = with.zeros.first_contact;
  result["offset"] = with.zeros.force;
  put(with.errors, result);
  result["at_limit"] = with.at_limit;
  return result;
}

py::dict dictionary_of(const validate::ForceSet& set) {
  const validate::ForceComparison& ours = set.ours;
  py::dict result;
  result["name"] = ours.measured.name;
  put(ours.errors, result);
  result["within_jnd"] = ours.within_jnd;
  result["extrapolated_points"] = ours.beyond;
  result["rows"] = ours.rows;
  result["zeros"] = set.zeros_fitted ? "fitted" : "given";
  result["zeros_given"] = dictionary_of(set.given);
  result["zeros_fitted"] = dictionary_of(set.fitted);
  result["time"] = array_of(ours.measured.time);
  result["displacement"] = array_of(ours.measured.displacement);
  result["measured"] = array_of(ours.measured.force);
  result["computed"] = array_of(ours.computed);
  put(set.baselines, set.cost_ns, result);
  return result;
}

py::dict dictionary_of(const validate::ProfileSet& set) {
  const validate::DeformationComparison& ours = set.ours;
  py::dict result;
  result["name"] = ours.measured.name;
  put(ours.errors, result);
  result["depth"] = ours.depth;
  result["tip_radius"] = ours.tip_radius;
  result["as_drawn"] = ours.rule.as_drawn;
  if (ours.rule.as_drawn) result["surface_radius"] = ours.rule.rest_radius;
  result["distance"] = array_of(ours.measured.distance);
  result["measured"] = array_of(ours.measured.displacement);
  result["computed"] = array_of(ours.computed);
  put(set.baselines, set.cost_ns, result);
  return result;
}

py::dict dictionary_of(const imaging::ImageSet& image) {
  const imaging::ImageMeasurement& measured = image.measured;
  std::vector<double> r;
  std::vector<double> u;
  std::vector<double> uncertainty;
  for (const imaging::ImagePoint& point : measured.points) {
    r.push_back(point.right ? point.r : -point.r);
    u.push_back(point.u);
    uncertainty.push_back(point.uncertainty);
  }
  py::dict result;
  result["r"] = array_of(r);
  result["u"] = array_of(u);
  result["u_uncertainty"] = array_of(uncertainty);
  result["confidence"] = measured.confidence;
  result["confidence_text"] = measured.confidence_text;
  result["uncertainty"] = measured.uncertainty;
  result["far_uncertainty"] = measured.far_uncertainty;
  result["within_uncertainty"] = image.within_uncertainty;
  result["tip_hidden"] = measured.tip_hidden;
  result["depth_fitted"] = image.depth_fitted;
  result["asymmetry"] = measured.asymmetry;
  return result;
}

py::dict dictionary_of(const validate::FalloffFit& fit) {
  static constexpr std::array kNames = {"contact_ratio", "first_bar_ratio", "bar_ratio", "weight_ratio",
                                        "depth_exponent"};
  const std::array values = {fit.reach.contact_ratio, fit.reach.first_bar_ratio, fit.reach.bar_ratio,
                             fit.reach.weight_ratio, fit.reach.depth_exponent};
  py::dict result;
  py::list at_limit;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    result[kNames[i]] = values[i];
    if (fit.at_limit[i]) at_limit.append(kNames[i]);
  }
  result["at_limit"] = at_limit;
  result["depth_exponent_kept"] = fit.exponent_kept;
  return result;
}

py::dict dictionary_of(const imaging::Validation& validation) {
  py::list forces;
  py::list profiles;
  for (const validate::ForceSet& set : validation.forces) forces.append(dictionary_of(set));
  for (const validate::ProfileSet& set : validation.profiles) profiles.append(dictionary_of(set));
  py::dict result;
  result["tissue"] = validation.law.tissue;
  result["forces"] = forces;
  result["profiles"] = profiles;
  if (validation.reach) result["reach"] = dictionary_of(*validation.reach);
  if (validation.image) result["image"] = dictionary_of(*validation.image);
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
  std::string names;
  for (const std::string& name : against) names += (names.empty() ? "" : ",") + name;
  request.baselines = validate::parse_baselines(names);
  imaging::Validation validation;
  {
    const py::gil_scoped_release others_may_run;
    validation = imaging::compare(request, kArgumentNames);
  }
  return dictionary_of(validation);
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
