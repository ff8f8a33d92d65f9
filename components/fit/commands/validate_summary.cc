#include <algorithm>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/model/tissue_fields.h"
#include "palpate/error.h"
#include "palpate/units.h"

#include "app/numbers.h"
#include "app/output.h"
#include "fit/commands/fit_summary.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;

Json errors_json(const std::string& name, const char* kind, const validate::Errors& errors, double unit) {
  return {{"name", name},
          {"kind", kind},
          {"rms", errors.rms / unit},
          {"max", errors.max / unit},
          {"nrmse", errors.nrmse}};
}

/// Adds the results of the baseline models of --against, if any.
void add_baselines(Json& json, double cost_ns, const std::vector<report::BaselineResult>& baselines,
                   double unit) {
  if (baselines.empty()) return;
  json["evaluation_ns"] = cost_ns;
  json["against"] = Json::array();
  for (const report::BaselineResult& baseline : baselines) {
    json["against"].push_back({{"name", validate::to_string(baseline.fit.kind)},
                               {"parameters", baseline.fit.parameters},
                               {"rms", baseline.fit.errors.rms / unit},
                               {"max", baseline.fit.errors.max / unit},
                               {"nrmse", baseline.fit.errors.nrmse},
                               {"evaluation_ns", baseline.cost_ns}});
  }
}

Json zeros_json(const validate::ZeroedErrors& with) {
  return {{"first_contact_mm", with.zeros.first_contact / kMillimetre},
          {"offset_N", with.zeros.force},
          {"rms", with.errors.rms},
          {"max", with.errors.max},
          {"nrmse", with.errors.nrmse}};
}

Json force_json(const report::ForceSet& set) {
  const validate::ForceComparison& force = set.ours;
  Json json = errors_json(force.measured.name, "force", force.errors, 1.0);
  json["unit"] = "N";
  json["points"] = force.measured.size();
  json["rows"] = force.rows;
  json["within_jnd"] = force.within_jnd;
  json["extrapolated_points"] = force.beyond;
  json["zeros"] = set.zeros_fitted ? "fitted" : "given";
  json["zeros_given"] = zeros_json(set.given);
  json["zeros_fitted"] = zeros_json(set.fitted);
  json["zeros_fitted"]["at_limit"] = set.fitted.at_limit;
  add_baselines(json, set.cost_ns, set.baselines, 1.0);
  return json;
}

Json profile_json(const report::ProfileSet& set) {
  const validate::DeformationComparison& profile = set.ours;
  Json json = errors_json(profile.measured.name, "profile", profile.errors, kMillimetre);
  json["unit"] = "mm";
  json["points"] = profile.measured.size();
  json["depth_mm"] = profile.depth / kMillimetre;
  json["tip_radius_mm"] = profile.tip_radius / kMillimetre;
  json["as_drawn"] = profile.rule.as_drawn;
  if (profile.rule.as_drawn) json["surface_radius_mm"] = profile.rule.rest_radius / kMillimetre;
  add_baselines(json, set.cost_ns, set.baselines, kMillimetre);
  return json;
}

/// Calls `take(key, value)` for each falloff ratio, with its key in the tissue file.
template <typename Take>
void for_each_number(const model::FalloffRatios& reach, Take take) {
  model::TissueNumbers numbers;
  numbers.reach = reach;
  for (const model::TissueField& field : model::kTissueFields) {
    if (field.section == "reach") take(field.key, field.in_force(numbers));
  }
}

Json reach_json(const validate::FalloffFit& fit) {
  Json json;
  for_each_number(fit.reach, [&json](const char* key, double value) { json[key] = value; });
  json["depth_exponent_kept"] = fit.exponent_kept;
  json["at_limit"] = fit.at_limit;
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
  std::string text = fmt::format(
      "{}: force, {} points: RMS {} N, largest {} N; RMS {} of the force range; {} of the points within "
      "{} % of their force (just noticeable difference)\n",
      force.measured.name, force.measured.size(), brief(force.errors.rms), brief(force.errors.max),
      percent(force.errors.nrmse), percent(force.within_jnd), brief(100.0 * validate::kForceJnd));
  text += report::zeros_text(set);
  if (force.rows > force.measured.size()) {
    text += fmt::format("  averaged over neighbours from {} rows\n", force.rows);
  }
  if (force.beyond > 0) {
    text += fmt::format(
        "  ! {} points are deeper than the tissue's layers allow: the law stays at its largest force there\n",
        force.beyond);
  }
  return text + baselines_text(set.cost_ns, set.baselines, 1.0, "N");
}

// Describes the compared surface under the ball, for --as-drawn; otherwise empty.
std::string surface_text(const validate::SurfaceRule& rule) {
  if (!rule.as_drawn) return "";
  if (!(rule.rest_radius > 0.0)) return ", as drawn on a flat surface";
  return ", as drawn on a surface of " + brief(rule.rest_radius / kMillimetre) + " mm radius";
}

std::string profile_text(const report::ProfileSet& set) {
  const validate::DeformationComparison& profile = set.ours;
  return fmt::format(
      "{}: deformation, {} points, ball of {} mm at {} mm{}: RMS {} mm, largest {} mm; RMS {} of the depth\n"
      "{}",
      profile.measured.name, profile.measured.size(), brief(profile.tip_radius / kMillimetre),
      brief(profile.depth / kMillimetre), surface_text(profile.rule), brief(profile.errors.rms / kMillimetre),
      brief(profile.errors.max / kMillimetre), percent(profile.errors.nrmse),
      baselines_text(set.cost_ns, set.baselines, kMillimetre, "mm"));
}

std::string reach_text(const validate::FalloffFit& fit) {
  std::string text = "displacement profile ([tissue.reach]) fitted to all profiles together:\n";
  std::size_t i = 0;
  for_each_number(fit.reach, [&](const char* key, double value) {
    text += fmt::format(
        "  {} = {}{}", key, brief(value),
        fit.at_limit[i++] ? "  ! at the limit of the search: these profiles do not determine it\n" : "\n");
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
  for (const auto& profile : validation.profiles) json["sets"].push_back(profile_json(profile));
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
  return imaging::Photographs{flags.files[0], flags.files[1], flags.pixel, flags.fixed_camera};
}

nlohmann::ordered_json image_json(const report::ImageSet& set) {
  constexpr double kDegree = 0.017453292519943295;
  const imaging::ImageMeasurement& measured = set.measured;
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const imaging::ImagePoint& point : measured.points) {
    points.push_back({{"x_px", point.x},
                      {"y_px", point.y},
                      {"r_mm", (point.right ? point.r : -point.r) / kMillimetre},
                      {"u_mm", point.u / kMillimetre},
                      {"uncertainty_mm", point.uncertainty / kMillimetre}});
  }
  return {{"confidence", measured.confidence},
          {"confidence_text", measured.confidence_text},
          {"uncertainty_mm", measured.uncertainty / kMillimetre},
          {"far_uncertainty_mm", measured.far_uncertainty / kMillimetre},
          {"within_uncertainty", set.within_uncertainty},
          {"coverage", std::min(measured.before.coverage, measured.after.coverage)},
          {"tip_hidden", measured.tip_hidden},
          {"depth_fitted", set.depth_fitted},
          {"centre_x_px", measured.centre_x},
          {"centre_uncertainty_mm", measured.centre_uncertainty / kMillimetre},
          {"tilt_deg", measured.tilt / kDegree},
          {"turn_deg", measured.turn / kDegree},
          {"shift_mm", measured.shift / kMillimetre},
          {"asymmetry", measured.asymmetry},
          {"points", std::move(points)}};
}

}  // namespace palpate::app
