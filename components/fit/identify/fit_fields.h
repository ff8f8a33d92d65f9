#pragma once
// The fields of a fit's results. All outputs are rendered from these lists: --json, the summary, the report,
// Python and the lines of the results file.
#include <concepts>
#include <string>
#include <type_traits>
#include <vector>

#include "palpate/identify.h"

namespace palpate::identify {

/// Outputs, for ResultField::outputs.
enum Outputs : unsigned { kInJson = 1, kInPython = 2, kInRecord = 4, kEverywhere = 7 };

/// How one field of a result appears in the outputs.
struct ResultField {
  const char* key;                 // its name in --json, in Python and in the results file
  unsigned outputs = kEverywhere;  // those that contain it
  int place = 0;                   // position in the summary and in the report's table; 0: in neither
  const char* phrase = nullptr;    // in the summary, with {} for the value
  const char* column = nullptr;    // its heading in the report's table
  bool as_percent = false;         // in both
};

template <typename Fit, typename One>
concept Is = std::same_as<std::remove_const_t<Fit>, One>;

/// [any] Calls visit(field, value) for each field, in the order of --json.
template <Is<SpecimenFit> Fit, typename Visit>
void for_each_field(Fit& fit, const Visit& visit) {
  using F = ResultField;
  visit(F{.key = "name", .place = 1, .phrase = "{}", .column = "specimen"}, fit.name);
  visit(F{.key = "law", .place = 2, .phrase = ": {} law"}, fit.law);
  visit(F{.key = "layers", .place = 8, .phrase = " {} layers reached"}, fit.layers_allowed);
  visit(F{.key = "layers_reached", .place = 7, .phrase = ", {} of"}, fit.layers_reached);
  visit(F{.key = "terms", .outputs = kInRecord}, fit.terms);
  visit(F{.key = "parameters"}, fit.estimates);
  visit(F{.key = "rms_N", .place = 5, .phrase = " ({} N)"}, fit.rms);
  visit(F{.key = "nrmse",
          .place = 4,
          .phrase = ", error {} of the force range",
          .column = "error",
          .as_percent = true},
        fit.nrmse);
  visit(F{.key = "leave_out_nrmse",
          .place = 6,
          .phrase = ", {} on left-out points",
          .column = "on points left out",
          .as_percent = true},
        fit.cross_validation);
  visit(F{.key = "points", .place = 3, .phrase = ", {} points", .column = "points"}, fit.points);
  visit(F{.key = "rows", .outputs = kInJson | kInRecord}, fit.rows);
  visit(F{.key = "warnings"}, fit.warnings);
  visit(F{.key = "curve", .outputs = kInPython | kInRecord}, fit.curve);
  visit(F{.key = "shared", .outputs = kInRecord}, fit.shared);
  visit(F{.key = "own", .outputs = kInRecord}, fit.own);
  visit(F{.key = "local_optima", .outputs = kInRecord}, fit.local_optima);
}

/// [any] Calls visit(field, value) for each field of the pooled fit, which no results file contains.
template <Is<PooledFit> Fit, typename Visit>
void for_each_field(Fit& fit, const Visit& visit) {
  using F = ResultField;
  visit(F{.key = "law", .outputs = kInJson, .place = 2, .phrase = ": {} law"}, fit.tissue.law);
  visit(F{.key = "direction", .outputs = kInJson}, fit.direction);
  visit(F{.key = "specimens", .outputs = kInJson, .place = 1, .phrase = "Pooled fit of {} specimens"},
        fit.specimens);
  visit(F{.key = "layers", .outputs = kInJson}, fit.layers_allowed);
  visit(F{.key = "layers_reached", .outputs = kInJson}, fit.layers_reached);
  visit(F{.key = "parameters"}, fit.estimates);
  visit(F{.key = "rms_N"}, fit.rms);
  visit(F{.key = "nrmse", .place = 3, .phrase = ", error {} of the force range", .as_percent = true},
        fit.nrmse);
  visit(F{.key = "points"}, fit.points);
  visit(F{.key = "warnings"}, fit.warnings);
  visit(F{.key = "tissue", .outputs = kInPython}, fit.tissue);
}

template <Is<Curve> Fit, typename Visit>
void for_each_field(Fit& curve, const Visit& visit) {
  visit(ResultField{.key = "time", .outputs = kInRecord}, curve.time);
  visit(ResultField{.key = "displacement"}, curve.displacement);
  visit(ResultField{.key = "measured"}, curve.measured);
  visit(ResultField{.key = "fitted"}, curve.fitted);
  visit(ResultField{.key = "low"}, curve.low);
  visit(ResultField{.key = "high"}, curve.high);
}

template <Is<Estimate> Fit, typename Visit>
void for_each_field(Fit& estimate, const Visit& visit) {
  visit(ResultField{.key = "value"}, estimate.value);
  visit(ResultField{.key = "interval"}, estimate.interval);
  visit(ResultField{.key = "covariance"}, estimate.covariance);
  visit(ResultField{.key = "bootstrap"}, estimate.bootstrap);
  visit(ResultField{.key = "determined"}, estimate.determined);
}

/// A field of the summary or of the report's table.
struct ShownField {
  ResultField field;
  std::string text;  // its value
};

/// [setup] The fields with a position, in that order.
[[nodiscard]] std::vector<ShownField> shown_fields(const SpecimenFit& fit);

/// [setup] The summary of a fit: the phrases of its fields.
[[nodiscard]] std::string summary_of(const SpecimenFit& fit);
[[nodiscard]] std::string summary_of(const PooledFit& fit);

}  // namespace palpate::identify
