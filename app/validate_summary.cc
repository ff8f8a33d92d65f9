#include "app/validate_summary.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "palpate/base/text.h"
#include "palpate/base/units.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;

std::string brief(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", 100.0 * share);
  return text;
}

Json errors_json(const std::string& name, const char* kind, const fit::Errors& errors, double unit) {
  return {{"name", name},
          {"kind", kind},
          {"rms", errors.rms / unit},
          {"max", errors.max / unit},
          {"nrmse", errors.nrmse}};
}

Json force_json(const fit::ForceComparison& force) {
  Json json = errors_json(force.measured.name, "force", force.errors, 1.0);
  json["unit"] = "N";
  json["points"] = force.measured.size();
  json["rows"] = force.rows;
  json["within_jnd"] = force.within_jnd;
  json["extrapolated_points"] = force.beyond;
  return json;
}

Json profile_json(const fit::DeformationComparison& profile) {
  Json json = errors_json(profile.measured.name, "profile", profile.errors, kMillimetre);
  json["unit"] = "mm";
  json["points"] = profile.measured.size();
  json["depth_mm"] = profile.depth / kMillimetre;
  json["tip_radius_mm"] = profile.tip_radius / kMillimetre;
  return json;
}

std::string force_text(const fit::ForceComparison& force) {
  std::string text = force.measured.name + ": force, " + std::to_string(force.measured.size()) +
                     " points: RMS " + brief(force.errors.rms) + " N, largest " + brief(force.errors.max) +
                     " N; RMS " + percent(force.errors.nrmse) + " of the force range; " +
                     percent(force.within_jnd) + " of the points within a hand's " +
                     brief(100.0 * fit::kForceJnd) + " %\n";
  if (force.rows > force.measured.size()) {
    text += "  of " + std::to_string(force.rows) + " rows, means of neighbours\n";
  }
  if (force.beyond > 0) {
    text += "  ! " + std::to_string(force.beyond) +
            " points are deeper than the tissue's layers go: the law holds its largest force there\n";
  }
  return text;
}

std::string profile_text(const fit::DeformationComparison& profile) {
  return profile.measured.name + ": deformation, " + std::to_string(profile.measured.size()) +
         " points, ball of " + brief(profile.tip_radius / kMillimetre) + " mm at " +
         brief(profile.depth / kMillimetre) + " mm: RMS " + brief(profile.errors.rms / kMillimetre) +
         " mm, largest " + brief(profile.errors.max / kMillimetre) + " mm; RMS " +
         percent(profile.errors.nrmse) + " of the depth\n";
}

}  // namespace

std::string validation_json(const Validation& validation) {
  const fit::Law& law = validation.law;
  Json json = {{"tissue", law.tissue.name},
               {"law", model::to_string(law.tissue.law)},
               {"direction", law.direction == model::Direction::kPull ? "pull" : "press"},
               {"sets", Json::array()}};
  for (const auto& force : validation.forces) json["sets"].push_back(force_json(force));
  for (const auto& profile : validation.profiles) json["sets"].push_back(profile_json(profile));
  json["missed"] = validation.missed;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string validation_text(const Validation& validation) {
  const fit::Law& law = validation.law;
  std::string text = law.tissue.name + ", " + model::to_string(law.tissue.law) + " law, " +
                     (law.direction == model::Direction::kPull ? "pull" : "press") + '\n';
  for (const auto& force : validation.forces) text += force_text(force);
  for (const auto& profile : validation.profiles) text += profile_text(profile);
  for (const std::string& goal : validation.missed) text += "missed: " + goal + '\n';
  return text;
}

}  // namespace palpate::app
