#pragma once
// The fields of a fit's results. All outputs are rendered from these lists: --json, the summary, the report,
// Python and the lines of the results file.
#include <algorithm>
#include <concepts>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/identify.h"

namespace palpate::identify {

/// Outputs, for ResultField::outputs.
enum Outputs : unsigned { kInJson = 1, kInPython = 2, kInRecord = 4, kEverywhere = 7 };

/// How one field of a result appears in the outputs.
struct ResultField {
  const char* key = nullptr;       // its name in --json, in Python and in the results file
  unsigned outputs = kEverywhere;  // those that contain it
  int place = 0;                   // position in the summary and in the report's table; 0: in neither
  const char* phrase = nullptr;    // in the summary, with {} for the value
  const char* column = nullptr;    // its heading in the report's table
  bool as_percent = false;         // in both
  const char* json_key = nullptr;  // its name in --json where the unit differs; nullptr: `key`
  double unit = 1.0;               // of the value in --json, the summary and the report's table [SI]
  const char* unit_name = "";      // after the value in the summary and the report's table
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
  visit(F{.key = "poor", .outputs = kInRecord}, fit.poor);
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
  visit(F{.key = "size_exponent", .outputs = kInJson | kInPython}, fit.size);
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
  std::string text;  // its value with its unit
};

/// [setup] A value for readers; "" for lists, which have no position. @param digits of a number
template <typename Value>
std::string shown_value([[maybe_unused]] const ResultField& field, [[maybe_unused]] const Value& value,
                        [[maybe_unused]] int digits) {
  if constexpr (std::floating_point<Value>) {
    if (field.as_percent) return percent(value);
    return brief(value / field.unit, digits) + (*field.unit_name == '\0' ? "" : " ") + field.unit_name;
  }
  if constexpr (std::integral<Value>) return std::to_string(value);
  if constexpr (std::same_as<Value, std::string>) return value;
  if constexpr (std::same_as<Value, model::LawKind>) return model::to_string(value);
  return "";
}

/// [setup] The fields with a position, in that order.
template <typename Fit>
[[nodiscard]] std::vector<ShownField> shown_fields(const Fit& fit, int digits = 4) {
  std::vector<ShownField> fields;
  for_each_field(fit, [&](const ResultField& field, const auto& value) {
    if (field.place > 0) fields.push_back({field, shown_value(field, value, digits)});
  });
  std::stable_sort(fields.begin(), fields.end(),
                   [](const ShownField& a, const ShownField& b) { return a.field.place < b.field.place; });
  return fields;
}

/// [setup] The summary of a result: the phrases of its fields.
template <typename Fit>
[[nodiscard]] std::string summary_of(const Fit& fit) {
  std::string text;
  for (const ShownField& one : shown_fields(fit)) {
    if (one.field.phrase != nullptr) text += fmt::format(fmt::runtime(one.field.phrase), one.text);
  }
  return text;
}

}  // namespace palpate::identify
