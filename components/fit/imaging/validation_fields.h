#pragma once
// The fields of a validation's results. --json, Python, the summary and the report's table are rendered from
// these lists.
#include <algorithm>
#include <numbers>
#include <string>

#include "core/model/tissue_fields.h"
#include "palpate/units.h"

#include "fit/identify/fit_fields.h"
#include "fit/imaging/image_compare.h"

namespace palpate::validate {

using identify::kInJson;
using identify::kInPython;
using identify::ResultField;

static_assert(kForceJnd == 0.07, "phrases and headings say 7 %");

// clang-format off
/// [any] Calls visit(field, value) for each error. @param of unit of the measured curve
template <typename Visit>
void for_each_error(const Errors& errors, const ResultField& of, const char* of_what, const Visit& visit) {
  using F = ResultField;
  visit(F{.key = "rms", .place = 5, .phrase = ": RMS {}", .column = "RMS", .unit = of.unit,
          .unit_name = of.unit_name}, errors.rms);
  visit(F{.key = "max", .place = 6, .phrase = ", largest {}", .column = "largest", .unit = of.unit,
          .unit_name = of.unit_name}, errors.max);
  visit(F{.key = "nrmse", .place = 7, .phrase = "; RMS {} ", .column = "RMS, relative to", .as_percent = true}, errors.nrmse);
  visit(F{.outputs = 0, .place = 8, .phrase = "{}", .column = ""}, std::string(of_what));
}

/// [any] @param of unit of the data
template <typename Visit>
void for_each_field(const BaselineResult& baseline, const ResultField& of, const Visit& visit) {
  using F = ResultField;
  visit(F{.key = "name"}, std::string(to_string(baseline.fit.kind)));
  visit(F{.key = "parameters"}, baseline.fit.parameters);
  for_each_error(baseline.fit.errors, of, "", visit);
  visit(F{.key = "computed", .outputs = kInPython}, baseline.fit.computed);
  visit(F{.key = "evaluation_ns"}, baseline.cost_ns);
}

template <typename Visit>
void for_each_field(const ZeroedErrors& with, const Visit& visit) {
  using F = ResultField;
  visit(F{.key = "first_contact", .json_key = "first_contact_mm", .unit = kMillimetre}, with.zeros.first_contact);
  visit(F{.key = "offset", .json_key = "offset_N"}, with.zeros.force);
  for_each_error(with.errors, {}, "", visit);
  visit(F{.key = "at_limit"}, with.at_limit);
}

/// [any] The results of the baseline models, if any.
template <typename Set, typename Visit>
void for_each_baseline(const Set& set, const ResultField& of, const Visit& visit) {
  if (set.baselines.empty()) return;
  visit(ResultField{.key = "evaluation_ns"}, set.cost_ns);
  visit(ResultField{.key = "against", .unit = of.unit, .unit_name = of.unit_name}, set.baselines);
}

/// [any] Calls visit(field, value) for the fields that every data set begins with. @param phrase of the name
template <typename Comparison, typename Visit>
void for_each_first_field(const Comparison& ours, const char* kind, const char* phrase, const ResultField& of,
                          const char* of_what, const Visit& visit) {
  using F = ResultField;
  visit(F{.key = "name", .place = 1, .phrase = phrase, .column = "data set"}, ours.measured.name);
  visit(F{.key = "kind", .outputs = kInJson}, std::string(kind));
  for_each_error(ours.errors, of, of_what, visit);
  visit(F{.key = "unit", .outputs = kInJson}, std::string(of.unit_name));
  visit(F{.key = "points", .outputs = kInJson, .place = 2, .phrase = ", {} points", .column = "points"}, ours.measured.size());
}

template <typename Visit>
void for_each_field(const ForceSet& set, const Visit& visit) {
  using F = ResultField;
  const F newtons{.unit_name = "N"};
  const ForceComparison& ours = set.ours;
  for_each_first_field(ours, "force", "{}: force", newtons, "of the force range", visit);
  visit(F{.key = "rows"}, ours.rows);
  visit(F{.key = "within_jnd", .place = 9, .phrase = "; {} of the points within 7 % of their force (just noticeable difference)",
          .column = "within 7 %", .as_percent = true}, ours.within_jnd);
  visit(F{.key = "extrapolated_points"}, ours.beyond);
  visit(F{.key = "warnings"}, ours.measured.preparation.notes);
  visit(F{.key = "zeros"}, std::string(set.zeros_fitted ? "fitted" : "given"));
  visit(F{.key = "zeros_given"}, set.given);
  visit(F{.key = "zeros_fitted"}, set.fitted);
  visit(F{.key = "time", .outputs = kInPython}, ours.measured.time);
  visit(F{.key = "displacement", .outputs = kInPython}, ours.measured.displacement);
  visit(F{.key = "measured", .outputs = kInPython}, ours.measured.force);
  visit(F{.key = "computed", .outputs = kInPython}, ours.computed);
  for_each_baseline(set, newtons, visit);
}

/// [setup] The compared surface under the ball, for SurfaceRule::as_drawn; otherwise empty.
[[nodiscard]] inline std::string surface_text(const SurfaceRule& rule) {
  if (!rule.as_drawn) return "";
  if (!(rule.rest_radius > 0.0)) return ", as drawn on a flat surface";
  return ", as drawn on a surface of " + brief(rule.rest_radius / kMillimetre) + " mm radius";
}

template <typename Visit>
void for_each_field(const ProfileSet& set, const Visit& visit) {
  using F = ResultField;
  const F mm{.unit = kMillimetre, .unit_name = "mm"};
  const DeformationComparison& ours = set.ours;
  for_each_first_field(ours, "profile", "{}: deformation", mm, "of the depth", visit);
  visit(F{.key = "depth", .place = 4, .phrase = " at {}", .json_key = "depth_mm",
          .unit = mm.unit, .unit_name = mm.unit_name}, ours.depth);
  visit(F{.key = "tip_radius", .place = 3, .phrase = ", ball of {}", .json_key = "tip_radius_mm",
          .unit = mm.unit, .unit_name = mm.unit_name}, ours.tip_radius);
  visit(F{.outputs = 0, .place = 4, .phrase = "{}"}, surface_text(ours.rule));
  visit(F{.key = "as_drawn"}, ours.rule.as_drawn);
  if (ours.rule.as_drawn) visit(F{.key = "surface_radius", .json_key = "surface_radius_mm", .unit = mm.unit}, ours.rule.rest_radius);
  visit(F{.outputs = 0, .place = 9, .column = "within 7 %"}, std::string());  // for forces alone
  visit(F{.key = "distance", .outputs = kInPython}, ours.measured.distance);
  visit(F{.key = "measured", .outputs = kInPython}, ours.measured.displacement);
  visit(F{.key = "computed", .outputs = kInPython}, ours.computed);
  for_each_baseline(set, mm, visit);
}
// clang-format on

/// [any] Calls take(key, ratio, at_limit) for each falloff ratio, with its key in the tissue file.
template <typename Take>
void for_each_ratio(const FalloffFit& fit, const Take& take) {
  model::TissueNumbers numbers;
  numbers.reach = fit.reach;
  std::size_t i = 0;
  for (const model::TissueField& field : model::kTissueFields) {
    if (field.section == "reach") take(field.key, field.in_force(numbers), fit.at_limit[i++]);
  }
}

}  // namespace palpate::validate

namespace palpate::imaging {

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

template <typename Visit>
void for_each_field(const ImageSet& set, const Visit& visit) {
  using F = identify::ResultField;
  using identify::kInJson;
  const ImageMeasurement& measured = set.measured;
  // clang-format off
  visit(F{.key = "confidence"}, measured.confidence);
  visit(F{.key = "confidence_text"}, measured.confidence_text);
  visit(F{.key = "uncertainty", .json_key = "uncertainty_mm", .unit = kMillimetre}, measured.uncertainty);
  visit(F{.key = "far_uncertainty", .json_key = "far_uncertainty_mm", .unit = kMillimetre}, measured.far_uncertainty);
  visit(F{.key = "within_uncertainty"}, set.within_uncertainty);
  visit(F{.key = "coverage", .outputs = kInJson}, std::min(measured.before.coverage, measured.after.coverage));
  visit(F{.key = "tip_hidden"}, measured.tip_hidden);
  visit(F{.key = "depth_fitted"}, set.depth_fitted);
  visit(F{.key = "centre_x_px", .outputs = kInJson}, measured.centre_x);
  visit(F{.key = "centre_uncertainty_mm", .outputs = kInJson, .unit = kMillimetre}, measured.centre_uncertainty);
  visit(F{.key = "tilt_deg", .outputs = kInJson, .unit = kRadiansPerDegree}, measured.tilt);
  visit(F{.key = "turn_deg", .outputs = kInJson, .unit = kRadiansPerDegree}, measured.turn);
  visit(F{.key = "shift_mm", .outputs = kInJson, .unit = kMillimetre}, measured.shift);
  visit(F{.key = "asymmetry"}, measured.asymmetry);
  // clang-format on
}

}  // namespace palpate::imaging
