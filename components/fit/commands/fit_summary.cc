#include "fit/commands/fit_summary.h"

#include <cmath>
#include <functional>
#include <type_traits>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "palpate/units.h"

#include "app/output.h"
#include "fit/identify/fit_fields.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;
using identify::Estimate;
using identify::Interval;

/// Returns one part of an estimate as JSON, divided by `unit`: the value (a number), an interval (two
/// numbers) or null where the estimate lacks it.
using Part = std::function<Json(const Estimate&, double unit)>;

Json pair_json(const Interval& interval, double unit) {
  return Json::array({interval.low / unit, interval.high / unit});
}

Json value_part(const Estimate& estimate, double unit) { return estimate.value / unit; }
Json interval_part(const Estimate& estimate, double unit) { return pair_json(estimate.interval, unit); }
Json covariance_part(const Estimate& estimate, double unit) {
  return estimate.covariance ? pair_json(*estimate.covariance, unit) : Json(nullptr);
}
Json bootstrap_part(const Estimate& estimate, double unit) {
  return estimate.bootstrap ? pair_json(*estimate.bootstrap, unit) : Json(nullptr);
}

/// The parameters of the law by name, and the relaxation terms as a list. A pooled fit has no other
/// parameters; a specimen's are followed by its own offsets if `own`.
Json parameters_json(const std::vector<Estimate>& estimates, std::size_t terms, const Part& part, bool own) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(terms);
  const std::size_t shared = identify::shared_count(terms);
  Json json;
  for (std::size_t i = 0; i < identify::kLawParameters; ++i) {
    json[labels[i].name] = part(estimates[i], labels[i].unit);
  }
  json["relaxation"] = Json::array();
  for (std::size_t i = identify::kLawParameters; i < shared; i += 2) {
    json["relaxation"].push_back(
        {{"share", part(estimates[i], 1.0)}, {"time_s", part(estimates[i + 1], 1.0)}});
  }
  for (std::size_t i = shared; own && i < estimates.size(); ++i) {
    json[labels[i].name] = part(estimates[i], labels[i].unit);
  }
  return json;
}

/// Adds the best values, the intervals and the names of the parameters that the data do not determine.
void put_estimates(const std::vector<Estimate>& estimates, std::size_t terms, Json& json) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(terms);
  const std::size_t shared = identify::shared_count(terms);
  const bool own = estimates.size() > shared;  // of a specimen
  json["parameters"] = parameters_json(estimates, terms, value_part, false);
  for (std::size_t i = shared; i < estimates.size(); ++i) {
    json[labels[i].name] = estimates[i].value / labels[i].unit;
  }
  json["interval_95"] = parameters_json(estimates, terms, interval_part, own);
  if (own) json["covariance_95"] = parameters_json(estimates, terms, covariance_part, own);
  if (own && estimates.front().bootstrap) {
    json["bootstrap_95"] = parameters_json(estimates, terms, bootstrap_part, own);
  }
  Json& open = json["not_determined"] = Json::array();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (!estimates[i].determined) open.push_back(labels[i].name);
  }
}

Json size_json(const std::optional<identify::SizeExponent>& size) {
  if (!size) return nullptr;
  return {{"value", size->value},
          {"interval_95", pair_json(size->interval, 1.0)},
          {"determined", size->determined},
          {"reference_radius_mm", size->reference_radius / kMillimetre}};
}

std::string size_line(const std::optional<identify::SizeExponent>& size) {
  if (!size) return "";
  return fmt::format("  size_exponent = {} ({} to {}){}: the force grows as (radius / {} mm)^{}\n",
                     brief(size->value), brief(size->interval.low), brief(size->interval.high),
                     size->determined ? "" : ", not determined", brief(size->reference_radius / kMillimetre),
                     brief(size->value));
}

/// The fields of a specimen's fit or of the pooled fit.
template <typename Fit>
Json fields_json(const Fit& fit) {
  Json json;
  identify::for_each_field(fit, [&](const identify::ResultField& field, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if ((field.outputs & identify::kInJson) == 0) return;
    if constexpr (std::is_same_v<Value, std::vector<Estimate>>) {
      put_estimates(value, fit.terms, json);
    } else if constexpr (std::is_same_v<Value, std::optional<identify::SizeExponent>>) {
      json[field.key] = size_json(value);
    } else if constexpr (std::is_same_v<Value, model::LawKind>) {
      json[field.key] = model::to_string(value);
    } else if constexpr (std::is_same_v<Value, model::Direction>) {
      json[field.key] = value == model::Direction::kPull ? "pull" : "press";
    } else if constexpr (std::is_constructible_v<Json, const Value&>) {
      json[field.key] = value;
    }
  });
  return json;
}

std::string padded(const std::string& text, std::size_t width) {
  return text.size() < width ? text + std::string(width - text.size(), ' ') : text + ' ';
}

std::string estimate_lines(const std::vector<Estimate>& estimates, std::size_t terms) {
  constexpr std::size_t kNameWidth = 24;
  constexpr std::size_t kValueWidth = 12;
  const std::vector<identify::ParameterLabel> labels = identify::labels(terms);
  std::string text;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const double unit = labels[i].unit;
    text += fmt::format("  {}{}{} to {}{}", padded(labels[i].name, kNameWidth),
                        padded(brief(estimates[i].value / unit), kValueWidth),
                        brief(estimates[i].interval.low / unit), brief(estimates[i].interval.high / unit),
                        estimates[i].determined ? "\n" : ", not determined\n");
  }
  return text;
}

std::string warning_lines(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += "  ! " + warning + '\n';
  return text;
}

Json relaxation_json(const identify::SweepPoint& point) {
  Json terms = Json::array();
  for (std::size_t i = identify::kLawParameters; i + 1 < point.others.size(); i += 2) {
    terms.push_back({{"share", point.others[i]}, {"time_s", point.others[i + 1]}});
  }
  return terms;
}

Json point_json(const identify::SweepPoint& point, double unit) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(0);
  Json parameters;
  for (std::size_t i = 0; i < identify::kLawParameters; ++i) {
    parameters[labels[i].name] = point.others[i] / labels[i].unit;
  }
  parameters["relaxation"] = relaxation_json(point);
  return {{"value", point.value / unit},
          {"nrmse", point.nrmse},
          {"deviance", std::isfinite(point.deviance) ? Json(point.deviance) : Json(nullptr)},
          {"within_95", point.within_95},
          {"parameters", std::move(parameters)}};
}

std::string verdict(const identify::Sweep& sweep, double unit) {
  double low = 0.0;
  double high = 0.0;
  bool any = false;
  for (const identify::SweepPoint& point : sweep.points) {
    if (!point.within_95) continue;
    if (!any) low = point.value;
    high = point.value;
    any = true;
  }
  if (sweep.open_below && sweep.open_above) return "the data do not determine it";
  if (!any) return "the data allow none of these values";
  if (low == high) return "the data allow only " + brief(low / unit) + " of these values";
  return fmt::format("the data allow {} to {}{}{}", brief(low / unit), brief(high / unit),
                     sweep.open_below ? ", and perhaps less" : "",
                     sweep.open_above ? ", and perhaps more" : "");
}

Json sweeps_json(const std::vector<identify::Sweep>& sweeps) {
  Json json = Json::array();
  for (const identify::Sweep& sweep : sweeps) {
    const identify::ParameterLabel label = identify::labels(0)[sweep.parameter];
    Json points = Json::array();
    for (const identify::SweepPoint& point : sweep.points) points.push_back(point_json(point, label.unit));
    json.push_back({{"specimen", sweep.specimen.empty() ? Json(nullptr) : Json(sweep.specimen)},
                    {"parameter", label.name},
                    {"best", sweep.best / label.unit},
                    {"best_nrmse", sweep.best_nrmse},
                    {"open_below", sweep.open_below},
                    {"open_above", sweep.open_above},
                    {"found_better", sweep.found_better},
                    {"points", std::move(points)}});
  }
  return json;
}

}  // namespace

std::string fit_json(const std::vector<identify::SpecimenFit>& fits, const identify::PooledFit& pooled,
                     const std::vector<identify::Sweep>& sweeps) {
  Json json;
  json["specimens"] = Json::array();
  for (const identify::SpecimenFit& fit : fits) json["specimens"].push_back(fields_json(fit));
  json["pooled"] = fields_json(pooled);
  if (!sweeps.empty()) json["sweeps"] = sweeps_json(sweeps);
  return json_text(json) + '\n';
}

std::string fit_text(const std::vector<identify::SpecimenFit>& fits, const identify::PooledFit& pooled) {
  std::string text;
  for (const identify::SpecimenFit& fit : fits) {
    text += summary_of(fit) + "; parameter, best, 95 % interval:\n" +
            estimate_lines(fit.estimates, fit.terms) + warning_lines(fit.warnings);
  }
  if (fits.size() > 1) {
    text += summary_of(pooled) + ":\n" + estimate_lines(pooled.estimates, pooled.terms) +
            size_line(pooled.size) + warning_lines(pooled.warnings);
  }
  return text;
}

std::string sweeps_csv(const std::vector<identify::Sweep>& sweeps) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(0);
  std::string text = "specimen,parameter,value,nrmse,deviance,within_95,k1_N_per_m,beta,q,limit_mm\n";
  for (const identify::Sweep& sweep : sweeps) {
    const identify::ParameterLabel& label = labels[sweep.parameter];
    for (const identify::SweepPoint& point : sweep.points) {
      text += (sweep.specimen.empty() ? "all together" : csv_cell(sweep.specimen)) + ',' + label.name + ',' +
              shortest(point.value / label.unit) + ',' + shortest(point.nrmse) + ',' +
              (std::isfinite(point.deviance) ? shortest(point.deviance) : "") + ',' +
              (point.within_95 ? '1' : '0');
      for (std::size_t i = 0; i < identify::kLawParameters; ++i) {
        text += ',' + shortest(point.others[i] / labels[i].unit);
      }
      text += '\n';
    }
  }
  return text;
}

std::string sweeps_text(const std::vector<identify::Sweep>& sweeps) {
  std::string text;
  for (const identify::Sweep& sweep : sweeps) {
    const identify::ParameterLabel label = identify::labels(0)[sweep.parameter];
    text += fmt::format("Sweep of {}, {}, {} values from {} to {}: {}\n", label.name,
                        sweep.specimen.empty() ? "all together" : sweep.specimen, sweep.points.size(),
                        brief(sweep.points.front().value / label.unit),
                        brief(sweep.points.back().value / label.unit), verdict(sweep, label.unit));
    if (sweep.found_better) {
      text +=
          "  ! one of these values fits clearly better than the fitted value, so the fit is only a local "
          "optimum: use that value and the other parameters in its row of --sweep-csv or --json\n";
    }
  }
  return text;
}

}  // namespace palpate::app
