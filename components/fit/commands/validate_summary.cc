#include <concepts>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/units.h"

#include "app/numbers.h"
#include "app/output.h"
#include "fit/commands/fit_summary.h"
#include "fit/imaging/validation_fields.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;

template <typename Result, typename... Of>
Json result_json(const Result& result, const Of&... of);

template <typename Value>
Json value_json(const identify::ResultField& field, const Value& value) {
  if constexpr (std::floating_point<Value>) {
    return value / field.unit;
  } else if constexpr (std::same_as<Value, std::vector<validate::BaselineResult>>) {
    Json all = Json::array();
    for (const validate::BaselineResult& baseline : value) all.push_back(result_json(baseline, field));
    return all;
  } else if constexpr (std::same_as<Value, validate::ZeroedErrors>) {
    return result_json(value);
  } else {
    return value;
  }
}

/// The fields of a result. @param of of its set, for a baseline model's
template <typename Result, typename... Of>
Json result_json(const Result& result, const Of&... of) {
  Json json;
  for_each_field(result, of..., [&json](const identify::ResultField& field, const auto& value) {
    if ((field.outputs & identify::kInJson) == 0) return;
    json[field.json_key != nullptr ? field.json_key : field.key] = value_json(field, value);
  });
  return json;
}

Json force_json(const report::ForceSet& set) {
  Json json = result_json(set);
  json["zeros_given"].erase("at_limit");  // of a search
  return json;
}

Json reach_json(const validate::FalloffFit& fit) {
  Json json;
  for_each_ratio(fit, [&json](const char* key, double ratio, bool) { json[key] = ratio; });
  json["depth_exponent_kept"] = fit.exponent_kept;
  json["at_limit"] = fit.at_limit;
  return json;
}

Json image_json(const report::ImageSet& set) {
  Json json = result_json(set);
  json["points"] = Json::array();
  for (const imaging::ImagePoint& point : set.measured.points) {
    json["points"].push_back({{"x_px", point.x},
                              {"y_px", point.y},
                              {"r_mm", (point.right ? point.r : -point.r) / kMillimetre},
                              {"u_mm", point.u / kMillimetre},
                              {"uncertainty_mm", point.uncertainty / kMillimetre}});
  }
  return json;
}

std::string baselines_text(double cost_ns, const std::vector<report::BaselineResult>& baselines, double unit,
                           const char* unit_name) {
  if (baselines.empty()) return "";
  std::string text =
      "  one evaluation " + brief(cost_ns) + " ns; baseline models, each fitted to these data:\n";
  for (const report::BaselineResult& baseline : baselines) {
    const validate::Errors& errors = baseline.fit.errors;
    text += fmt::format("    {}: RMS {} {}, largest {} {}; RMS {}; one evaluation {} ns ({})\n",
                        validate::to_string(baseline.fit.kind), brief(errors.rms / unit), unit_name,
                        brief(errors.max / unit), unit_name, percent(errors.nrmse), brief(baseline.cost_ns),
                        baseline.fit.parameters);
  }
  return text;
}

std::string force_text(const report::ForceSet& set) {
  const validate::ForceComparison& force = set.ours;
  std::string text = identify::summary_of(set) + '\n';
  text += report::zeros_text(set);
  if (force.rows > force.measured.size()) {
    text += fmt::format("  averaged over neighbours from {} rows\n", force.rows);
  }
  if (force.beyond > 0) {
    text += fmt::format(
        "  ! {} points are deeper than the tissue's layers allow: the law stays at its largest force there\n",
        force.beyond);
  }
  for (const std::string& note : force.measured.preparation.notes) text += "  ! " + note + '\n';
  return text + baselines_text(set.cost_ns, set.baselines, 1.0, "N");
}

std::string profile_text(const report::ProfileSet& set) {
  return identify::summary_of(set) + '\n' + baselines_text(set.cost_ns, set.baselines, kMillimetre, "mm");
}

std::string reach_text(const validate::FalloffFit& fit) {
  std::string text = "displacement profile ([tissue.reach]) fitted to all profiles together:\n";
  for_each_ratio(fit, [&text](const char* key, double ratio, bool at_limit) {
    text +=
        fmt::format("  {} = {}{}", key, brief(ratio),
                    at_limit ? "  ! at the limit of the search: these profiles do not determine it\n" : "\n");
  });
  if (fit.exponent_kept) {
    text.insert(text.size() - 1, ", from the tissue: to determine it, measure at depths that differ more");
  }
  return text;
}

}  // namespace

std::string validation_json(const report::Validation& validation) {
  const validate::Law& law = validation.law;
  Json json = {{"tissue", law.tissue.name},
               {"law", model::to_string(law.tissue.law)},
               {"direction", law.direction == model::Direction::kPull ? "pull" : "press"},
               {"sets", Json::array()}};
  for (const auto& force : validation.forces) json["sets"].push_back(force_json(force));
  for (const auto& profile : validation.profiles) json["sets"].push_back(result_json(profile));
  if (validation.reach) json["reach"] = reach_json(*validation.reach);
  if (validation.image) json["image"] = image_json(*validation.image);
  json["missed"] = validation.missed;
  return json_text(json) + '\n';
}

std::string validation_text(const report::Validation& validation) {
  const validate::Law& law = validation.law;
  std::string text = fmt::format("{}, {} law, {}\n", law.tissue.name, model::to_string(law.tissue.law),
                                 law.direction == model::Direction::kPull ? "pull" : "press");
  if (validation.reach) text += reach_text(*validation.reach);
  for (const auto& force : validation.forces) text += force_text(force);
  for (const auto& profile : validation.profiles) text += profile_text(profile);
  if (validation.image) text += report::image_text(*validation.image);
  for (const std::string& goal : validation.missed) text += "missed: " + goal + '\n';
  return text;
}

void add_image_flags(CLI::App& command, ImageFlags& flags) {
  CLI::Option* image =
      command
          .add_option("--image", flags.files,
                      "two photographs from the side (PNG or JPEG), before and during the press or pull: the "
                      "tissue is at the bottom, the tool comes from above")
          ->expected(2);
  add_number(command, "--scale-mm-per-px", flags.pixel, Numbers::kPositive,
             "size of a pixel of the photographs in millimetres", kMillimetre)
      ->needs(image);
  command
      .add_flag("--fixed-camera", flags.fixed_camera,
                "the camera did not move between the photographs: correct no rotation or shift")
      ->needs(image);
}

std::optional<imaging::Photographs> photographs_of(const ImageFlags& flags) {
  if (flags.files.empty()) return std::nullopt;
  if (flags.pixel == 0.0) throw InputError("--scale-mm-per-px: missing, --image needs it");
  return imaging::Photographs{to_path(flags.files[0]), to_path(flags.files[1]), flags.pixel,
                              flags.fixed_camera};
}

}  // namespace palpate::app
