#include "fit/commands/fit_summary.h"

#include <cmath>
#include <functional>
#include <optional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"

#include "app/output.h"
#include "fit/commands/sweep_summary.h"

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

/// The parameters of the law by name, and the relaxation terms as a list. These parameters are shared by all
/// specimens in a pooled fit.
Json shared_json(const std::vector<Estimate>& estimates, std::size_t terms, const Part& part) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(terms);
  Json json;
  for (std::size_t i = 0; i < identify::kLawParameters; ++i) {
    json[labels[i].name] = part(estimates[i], labels[i].unit);
  }
  json["relaxation"] = Json::array();
  for (std::size_t i = identify::kLawParameters; i < identify::shared_count(terms); i += 2) {
    json["relaxation"].push_back(
        {{"share", part(estimates[i], 1.0)}, {"time_s", part(estimates[i + 1], 1.0)}});
  }
  return json;
}

/// All parameters of one specimen by name: the shared ones and the specimen's own offsets.
Json all_json(const identify::SpecimenFit& fit, const Part& part) {
  Json json = shared_json(fit.estimates, fit.terms, part);
  const std::vector<identify::ParameterLabel> labels = identify::labels(fit.terms);
  for (std::size_t i = identify::shared_count(fit.terms); i < labels.size(); ++i) {
    json[labels[i].name] = part(fit.estimates[i], labels[i].unit);
  }
  return json;
}

/// Names of the parameters that the data do not determine.
Json open_json(const std::vector<Estimate>& estimates, std::size_t terms) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(terms);
  Json names = Json::array();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (!estimates[i].determined) names.push_back(labels[i].name);
  }
  return names;
}

Json specimen_json(const identify::SpecimenFit& fit) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(fit.terms);
  const std::size_t own = identify::shared_count(fit.terms);
  Json json = {{"name", fit.name},
               {"law", model::to_string(fit.law)},
               {"layers", fit.layers_allowed},
               {"layers_reached", fit.layers_reached},
               {"parameters", shared_json(fit.estimates, fit.terms, value_part)}};
  for (std::size_t i = own; i < labels.size(); ++i) {
    json[labels[i].name] = fit.estimates[i].value / labels[i].unit;
  }
  json["interval_95"] = all_json(fit, interval_part);
  json["covariance_95"] = all_json(fit, covariance_part);
  if (fit.estimates.front().bootstrap) json["bootstrap_95"] = all_json(fit, bootstrap_part);
  json["not_determined"] = open_json(fit.estimates, fit.terms);
  json["rms_N"] = fit.rms;
  json["nrmse"] = fit.nrmse;
  json["leave_out_nrmse"] = fit.cross_validation;
  json["points"] = fit.points;
  json["rows"] = fit.rows;
  json["warnings"] = fit.warnings;
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

}  // namespace

std::string fit_json(const std::vector<identify::SpecimenFit>& fits, const identify::PooledFit& pooled,
                     const std::vector<identify::Sweep>& sweeps, const identify::Settings& settings) {
  Json json;
  json["specimens"] = Json::array();
  for (const identify::SpecimenFit& fit : fits) json["specimens"].push_back(specimen_json(fit));
  json["pooled"] = {{"law", model::to_string(settings.law)},
                    {"direction", settings.direction == model::Direction::kPull ? "pull" : "press"},
                    {"specimens", pooled.specimens},
                    {"layers", pooled.layers_allowed},
                    {"layers_reached", pooled.layers_reached},
                    {"parameters", shared_json(pooled.estimates, pooled.terms, value_part)},
                    {"interval_95", shared_json(pooled.estimates, pooled.terms, interval_part)},
                    {"not_determined", open_json(pooled.estimates, pooled.terms)},
                    {"rms_N", pooled.rms},
                    {"nrmse", pooled.nrmse},
                    {"points", pooled.points},
                    {"warnings", pooled.warnings}};
  if (!sweeps.empty()) json["sweeps"] = sweeps_json(sweeps);
  return json_text(json) + '\n';
}

std::string fit_text(const std::vector<identify::SpecimenFit>& fits, const identify::PooledFit& pooled,
                     const identify::Settings& settings) {
  std::string text;
  for (const identify::SpecimenFit& fit : fits) {
    text += fmt::format(
        "{}: {} law, {} points, error {} of the force range ({} N), {} on left-out points, {} of {} layers "
        "reached; parameter, best, 95 % interval:\n"
        "{}{}",
        fit.name, model::to_string(fit.law), fit.points, percent(fit.nrmse), brief(fit.rms),
        percent(fit.cross_validation), fit.layers_reached, fit.layers_allowed,
        estimate_lines(fit.estimates, fit.terms), warning_lines(fit.warnings));
  }
  if (fits.size() > 1) {
    text += fmt::format("Pooled fit of {} specimens: {} law, error {} of the force range:\n{}{}",
                        pooled.specimens, model::to_string(settings.law), percent(pooled.nrmse),
                        estimate_lines(pooled.estimates, pooled.terms), warning_lines(pooled.warnings));
  }
  return text;
}

}  // namespace palpate::app
