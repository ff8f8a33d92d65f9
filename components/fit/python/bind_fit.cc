// Fits of tissue parameters to measured force over displacement.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/system/plausible.h"
#include "palpate/error.h"
#include "palpate/identify.h"
#include "palpate/units.h"

#include "fit/identify/fit_fields.h"
#include "fit/identify/needle_fit.h"
#include "fit/python/docs.h"
#include "fit/python/module.h"

namespace palpate::python {
namespace {

using identify::Specimen;

std::vector<double> list_of(const Numbers& numbers, const char* name) {
  if (numbers.ndim() != 1) throw InputError(std::string(name) + ": must be one row of numbers");
  return {numbers.data(), numbers.data() + numbers.size()};
}

Specimen make_specimen(std::string name, const Numbers& displacement, const Numbers& force,
                       const std::optional<Numbers>& time, std::optional<double> tip_radius) {
  Specimen specimen{std::move(name), {}, list_of(displacement, "displacement"), list_of(force, "force")};
  if (time) specimen.time = list_of(*time, "time");
  if (tip_radius && !kTipRadius.possible.contains(*tip_radius)) {
    throw ParameterError("tip_radius", *tip_radius, "within 1e-06 and 1 (m)");
  }
  specimen.tip_radius = tip_radius.value_or(0.0);
  const std::size_t size = specimen.force.size();
  if (size < identify::kFewestPoints) {
    throw InputError("force: has " + std::to_string(size) + " points, must be at least " +
                     std::to_string(identify::kFewestPoints));
  }
  if (specimen.displacement.size() != size || (time && specimen.time.size() != size)) {
    throw InputError("displacement, force and time: must have the same length");
  }
  return specimen;
}

/// Maps each name to (value, low, high) in the unit that the name states.
py::dict parameters_of(const std::vector<identify::Estimate>& estimates, std::size_t terms) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(terms);
  py::dict parameters;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const double unit = labels[i].unit;
    const identify::Estimate& estimate = estimates[i];
    parameters[py::str(labels[i].name)] =
        py::make_tuple(estimate.value / unit, estimate.interval.low / unit, estimate.interval.high / unit);
  }
  return parameters;
}

/// Prony terms of a fit; a curve has none.
template <typename Fit>
std::size_t terms_of(const Fit& fit) {
  if constexpr (std::is_same_v<Fit, identify::Curve>) {
    return 0;
  } else {
    return fit.terms;
  }
}

/// Adds the fields of a specimen's fit or of the pooled fit, or those of a curve.
template <typename Fit>
void put_fields(const Fit& fit, py::dict& result) {
  const std::size_t terms = terms_of(fit);
  identify::for_each_field(fit, [&](const identify::ResultField& field, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if ((field.outputs & identify::kInPython) == 0) return;
    const py::str key(field.key);
    if constexpr (std::is_same_v<Value, std::vector<identify::Estimate>>) {
      result[key] = parameters_of(value, terms);
    } else if constexpr (std::is_same_v<Value, identify::Curve>) {
      put_fields(value, result);
    } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
      result[key] = array_of(value);
    } else if constexpr (std::is_same_v<Value, model::LawKind>) {
      result[key] = model::to_string(value);
    } else if constexpr (std::is_same_v<Value, model::TissueParameters>) {
      model::TissueParameters tissue = value;
      if (tissue.name.empty()) tissue.name = "fitted";  // a tissue file needs a name
      result[key] = tissue;
    } else if constexpr (std::is_same_v<Value, std::optional<identify::SizeExponent>>) {
      if (value) {
        result[key] = py::make_tuple(value->value, value->interval.low, value->interval.high);
      } else {
        result[key] = py::none();
      }
    } else {
      result[key] = value;
    }
  });
}

template <typename Fit>
py::dict dictionary_of(const Fit& fit) {
  py::dict result;
  put_fields(fit, result);
  return result;
}

py::dict fit_specimens(const std::vector<Specimen>& specimens, const std::string& law,
                       const std::string& direction, bool relaxation, double loop_period, double t1,
                       int bootstrap, std::uint64_t seed) {
  if (specimens.empty()) throw InputError("specimens: is empty, must have at least one");
  identify::Settings settings;
  settings.law = model::parse_law(law);
  settings.direction = direction_of(direction);
  settings.relaxation = relaxation;
  if (!(loop_period > 0.0)) throw ParameterError("loop_period", loop_period, "> 0 (s)");
  if (!(t1 > 0.0)) throw ParameterError("t1", t1, "> 0 (s)");
  if (bootstrap < 0) throw ParameterError("bootstrap", bootstrap, ">= 0");
  settings.period = loop_period;
  settings.t1 = t1;
  settings.bootstrap = bootstrap;
  settings.seed = seed;
  std::vector<identify::SpecimenFit> fits;
  identify::PooledFit pooled;
  {
    const py::gil_scoped_release others_may_run;
    const auto silent = [](double, const std::string&) {};
    for (const Specimen& specimen : specimens) {
      fits.push_back(
          identify::fit_specimen(specimen, settings, static_cast<std::uint32_t>(fits.size()), silent));
    }
    pooled = identify::fit_pooled(specimens, fits, settings, silent);
  }
  py::list each;
  for (const identify::SpecimenFit& one : fits) each.append(dictionary_of(one));
  py::dict result;
  result["specimens"] = each;
  result["pooled"] = dictionary_of(pooled);
  if (!identify::poor_fit(fits, pooled).empty()) result["pooled"]["tissue"] = py::none();
  return result;
}

/// Adds (value, low, high) of each parameter, by its name in the unit that it states.
void put_needle_values(const identify::NeedleFit& fit, py::dict& result) {
  py::dict parameters;
  std::vector<py::dict> layers(fit.layers);
  for (const identify::NeedleValue& value : fit.values) {
    const identify::Estimate& estimate = value.estimate;
    py::dict& into = value.layer > 0 ? layers[static_cast<std::size_t>(value.layer - 1)] : parameters;
    into[py::str(value.name)] = py::make_tuple(
        estimate.value / value.unit, estimate.interval.low / value.unit, estimate.interval.high / value.unit);
  }
  result["parameters"] = parameters;
  result["tissue_layers"] = layers;
}

py::dict repeat_of(const identify::NeedleRepeat& repeat) {
  py::list punctures;
  for (const identify::Puncture& one : repeat.punctures)
    punctures.append(py::make_tuple(one.time, one.depth, one.force, one.tip));
  py::dict result;
  result["name"] = repeat.name;
  result["nrmse"] = repeat.nrmse;
  result["predicted_nrmse"] = repeat.predicted_nrmse;
  result["punctures"] = punctures;
  result["time"] = array_of(repeat.record.time);
  result["displacement"] = array_of(repeat.record.depth);
  result["measured"] = array_of(repeat.record.force);
  result["fitted"] = array_of(repeat.fitted);
  return result;
}

py::dict fit_records(const std::vector<Specimen>& records, const std::string& law, double loop_period,
                     double t1) {
  if (records.empty()) throw InputError("records: is empty, must have at least one");
  identify::Settings settings;
  settings.law = model::parse_law(law);
  if (!(loop_period > 0.0)) throw ParameterError("loop_period", loop_period, "> 0 (s)");
  if (!(t1 > 0.0)) throw ParameterError("t1", t1, "> 0 (s)");
  settings.period = loop_period;
  settings.t1 = t1;
  identify::NeedleFit fit;
  {
    const py::gil_scoped_release others_may_run;
    std::vector<identify::Insertion> insertions;
    for (const Specimen& one : records) insertions.push_back(identify::insertion_of(one, one.name));
    fit = identify::fit_needle(insertions, settings, [](double, const std::string&) {});
  }
  py::dict result;
  result["layers"] = fit.layers;
  result["nrmse"] = fit.nrmse;
  put_needle_values(fit, result);
  py::list repeats;
  for (const identify::NeedleRepeat& one : fit.repeats) repeats.append(repeat_of(one));
  result["repeats"] = repeats;
  result["warnings"] = fit.warnings;
  result["tissue"] = fit.poor.empty() ? py::cast(fit.tissue) : py::object(py::none());
  return result;
}

std::vector<Specimen> read_records(const std::filesystem::path& file) {
  std::vector<Specimen> all;
  for (identify::Insertion& one : identify::read_insertions(file)) {
    all.push_back(
        {one.all.name, std::move(one.all.time), std::move(one.all.depth), std::move(one.all.force)});
  }
  return all;
}

}  // namespace

void bind_fit(py::module_& module) {
  py::class_<Specimen>(module, "Specimen", doc("Specimen"))
      .def(py::init(&make_specimen), py::arg("name"), py::arg("displacement"), py::arg("force"),
           py::arg("time") = py::none(), py::arg("tip_radius") = py::none())
      .def_readonly("name", &Specimen::name)
      .def_readonly("tip_radius", &Specimen::tip_radius, doc("Specimen::tip_radius"))
      .def_property_readonly(
          "displacement", [](const Specimen& one) { return array_of(one.displacement); },
          doc("Specimen::displacement"))
      .def_property_readonly(
          "force", [](const Specimen& one) { return array_of(one.force); }, doc("Specimen::force"))
      .def_property_readonly(
          "time", [](const Specimen& one) { return array_of(one.time); }, doc("Specimen::time"));
  module.def(
      "read_specimens", [](const FilesArgument& file) { return read_all(file, &identify::read_specimens); },
      py::arg("file"),
      (std::string(doc("read_specimens")) + " A list of files gives the specimens of all, for a pooled fit.")
          .c_str());
  module.def(
      "fit", &fit_specimens, py::arg("specimens"), py::kw_only(), py::arg("law") = "layered",
      py::arg("direction") = "press", py::arg("relaxation") = false, py::arg("loop_period") = 1e-3,
      py::arg("t1") = 1e-6, py::arg("bootstrap") = 0, py::arg("seed") = 1,
      "Fits each specimen and all specimens together, as `palpate fit` does. Returns a dictionary. "
      "`specimens` is a list with one dictionary per specimen: `parameters` (name to value, low and "
      "high end of the 95 % interval, in the unit of the name), rms_N, nrmse, leave_out_nrmse, points, "
      "warnings and the fitted curve in SI. `pooled` is the fit of all specimens; its `size_exponent` "
      "(value, low, high) comes from specimens with different tip_radius, else None; its `tissue` is "
      "named fitted, or None where the error is over 20 % of the force range. Raises InputError.");
  module.def(
      "read_insertions", [](const FilesArgument& file) { return read_all(file, &read_records); },
      py::arg("file"),
      "Reads records of needles from a CSV file with time_s, displacement_mm and force_N, for fit_needle(). "
      "A list of files gives the records of all. Raises InputError.");
  module.def(
      "fit_needle", &fit_records, py::arg("records"), py::kw_only(), py::arg("law") = "smooth",
      py::arg("loop_period") = 1e-3, py::arg("t1") = 1e-6,
      "Fits a tissue with layers to records of insertions, as `palpate fit --needle` does. `records` is a "
      "list of Specimen with times. Returns a dictionary: `layers`, `nrmse`, `parameters` of the tissue and "
      "a list `tissue_layers` (name to value, low and high end of the 95 % interval, in the unit of the "
      "name), `repeats` with the punctures (time, depth, force, force on the tip) and the curves in SI, "
      "`warnings`, and `tissue`, or None where the records allow none. Raises InputError.");
}

}  // namespace palpate::python
