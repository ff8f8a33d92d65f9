#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "palpate/units.h"

#include "app/output.h"
#include "fit/commands/fit_summary.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;
using identify::LayerEvidence;
using identify::NeedleFit;
using identify::NeedleRepeat;
using identify::NeedleValue;
using identify::Puncture;

Json value_json(const NeedleValue& value) {
  const identify::Interval& interval = value.estimate.interval;
  return {{"value", value.estimate.value / value.unit},
          {"interval_95", Json::array({interval.low / value.unit, interval.high / value.unit})},
          {"determined", value.estimate.determined}};
}

Json repeat_json(const NeedleRepeat& repeat) {
  Json punctures = Json::array();
  for (const Puncture& one : repeat.punctures) {
    punctures.push_back({{"time_s", one.time},
                         {"depth_mm", one.depth / kMillimetre},
                         {"force_N", one.force},
                         {"puncture_force_N", one.tip}});
  }
  return {{"name", repeat.name},
          {"rms_N", repeat.rms},
          {"nrmse", repeat.nrmse},
          {"predicted_nrmse", repeat.predicted_nrmse ? Json(*repeat.predicted_nrmse) : Json(nullptr)},
          {"offset_mm", repeat.contact / kMillimetre},
          {"offset_N", repeat.zero},
          {"punctures", std::move(punctures)}};
}

std::string repeat_text(const NeedleRepeat& repeat) {
  std::string text = fmt::format("{}: error {} of the force range ({} N)", repeat.name, percent(repeat.nrmse),
                                 brief(repeat.rms, 3));
  if (repeat.predicted_nrmse) {
    text += fmt::format(", {} as the other records predict it", percent(*repeat.predicted_nrmse));
  }
  text += '\n';
  for (const Puncture& one : repeat.punctures) {
    text +=
        fmt::format("  puncture at {} mm, {} s: {} N, {} N of it on the tip\n",
                    brief(one.depth / kMillimetre), brief(one.time), brief(one.force, 3), brief(one.tip, 3));
  }
  return text;
}

}  // namespace

std::string needle_json(const NeedleFit& fit) {
  Json json = {{"layers", fit.layers}, {"law", model::to_string(fit.tissue.law)}, {"nrmse", fit.nrmse}};
  Json parameters = Json::object();
  Json relaxation = Json::array();
  std::vector<Json> layers(fit.layers, Json::object());
  for (const NeedleValue& value : fit.values) {
    if (value.layer > 0) {
      layers[static_cast<std::size_t>(value.layer - 1)][value.name] = value_json(value);
    } else if (value.name.starts_with("relaxation")) {
      const bool is_share = value.name.ends_with("share");
      if (is_share) relaxation.push_back(Json::object());
      relaxation.back()[is_share ? "share" : "time_s"] = value_json(value);
    } else {
      parameters[value.name] = value_json(value);
    }
  }
  json["parameters"] = std::move(parameters);
  json["relaxation"] = std::move(relaxation);
  json["tissue_layers"] = std::move(layers);
  json["evidence"] = Json::array();
  for (const LayerEvidence& one : fit.evidence) {
    json["evidence"].push_back(
        {{"layers", one.layers}, {"records", one.votes}, {"tried_on", one.records}, {"nrmse", one.nrmse}});
  }
  json["repeats"] = Json::array();
  for (const NeedleRepeat& repeat : fit.repeats) json["repeats"].push_back(repeat_json(repeat));
  json["warnings"] = fit.warnings;
  return json_text(json) + '\n';
}

std::string needle_text(const NeedleFit& fit) {
  std::string text;
  for (const NeedleRepeat& repeat : fit.repeats) text += repeat_text(repeat);
  text +=
      fmt::format("{} by evidence; error with each number tried:", counted(fit.layers, "layer", "layers"));
  for (const LayerEvidence& one : fit.evidence)
    text += fmt::format(" {}: {}", one.layers, percent(one.nrmse));
  text += fmt::format("\none tissue for all, {} law, error {}; parameter, best, 95 % interval:\n",
                      model::to_string(fit.tissue.law), percent(fit.nrmse));
  int layer = 0;
  for (const NeedleValue& value : fit.values) {
    if (value.layer != layer) text += fmt::format(" layer {}\n", value.layer);
    layer = value.layer;
    const auto [best, interval] = shown(value);
    text += fmt::format("  {:24}{:16}{}\n", value.name, best, interval);
  }
  for (const std::string& warning : fit.warnings) text += "  ! " + warning + '\n';
  return text;
}

}  // namespace palpate::app
