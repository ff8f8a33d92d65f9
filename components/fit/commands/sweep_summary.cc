#include "fit/commands/sweep_summary.h"

#include <cmath>

#include <fmt/core.h>

#include "core/base/text.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;

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

/// Quotes a name for a CSV field where CSV requires quotes.
std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string field = "\"";
  for (const char c : name) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + '"';
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

}  // namespace

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

std::string sweeps_csv(const std::vector<identify::Sweep>& sweeps) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(0);
  std::string text = "specimen,parameter,value,nrmse,deviance,within_95,k1_N_per_m,beta,q,limit_mm\n";
  for (const identify::Sweep& sweep : sweeps) {
    const identify::ParameterLabel& label = labels[sweep.parameter];
    for (const identify::SweepPoint& point : sweep.points) {
      text += (sweep.specimen.empty() ? "all together" : quoted(sweep.specimen)) + ',' + label.name + ',' +
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
