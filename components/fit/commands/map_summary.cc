#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "palpate/units.h"

#include "app/output.h"
#include "fit/commands/fit_summary.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;
using identify::DescribedMap;
using identify::Estimate;
using identify::FoundInclusion;

std::string in_mm(double metres) { return brief(metres / kMillimetre, 3); }

/// Examples: "5.1 mm (4.8 to 5.4)", "40 (7.5 or more)"; "40: not determined" without an interval.
std::string estimate_text(const Estimate& estimate, double unit, const char* name) {
  if (std::isinf(estimate.interval.low)) {
    return fmt::format("{}{}: not determined", brief(estimate.value / unit, 3), name);
  }
  if (std::isinf(estimate.interval.high)) {
    return fmt::format("{}{} ({} or more)", brief(estimate.value / unit, 3), name,
                       brief(estimate.interval.low / unit, 3));
  }
  return fmt::format("{}{} ({} to {})", brief(estimate.value / unit, 3), name,
                     brief(estimate.interval.low / unit, 3), brief(estimate.interval.high / unit, 3));
}

/// An end that the search did not find is null; an interval without ends is null.
Json estimate_json(const Estimate& estimate, double unit) {
  const auto end = [unit](double value) { return std::isinf(value) ? Json() : Json(value / unit); };
  Json interval;
  if (!std::isinf(estimate.interval.low)) {
    interval = Json::array({end(estimate.interval.low), end(estimate.interval.high)});
  }
  return {{"value", estimate.value / unit}, {"interval", interval}, {"determined", estimate.determined}};
}

/// The bounds that an inclusion ended at, in words.
std::string bounds_text(const FoundInclusion& found) {
  std::string text;
  for (const std::string& key : found.at_bounds) {
    if (!text.empty()) text += ", ";
    if (key == "place") text += "the edge of the map";
    if (key == "depth_mm") text += fmt::format("depth {} mm", in_mm(found.depth.value));
    if (key == "radius_mm")
      text += "radius " + percent(found.radius.value / found.depth.value, 0) + " of the depth";
    if (key == "stiffness_ratio") text += "stiffness ratio " + brief(found.ratio.value, 3);
  }
  return text;
}

std::string inclusion_text(const FoundInclusion& found, std::size_t number) {
  const bool bounded = !found.at_bounds.empty();
  std::string text = fmt::format(
      "inclusion {}: centre {}, {}, {} mm; {}\n", number, in_mm(found.centre[0].value),
      in_mm(found.centre[1].value), in_mm(found.centre[2].value),
      bounded ? "undetermined, without intervals: the search ended at its bound, " + bounds_text(found)
              : "95 % intervals in brackets");
  const char* const axes[] = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    text += fmt::format("  {:16} {}\n", axes[axis], estimate_text(found.centre[axis], kMillimetre, " mm"));
  }
  text += fmt::format("  {:16} {}\n", "depth", estimate_text(found.depth, kMillimetre, " mm"));
  text += fmt::format("  {:16} {}\n", "rise of force", estimate_text(found.rise, 0.01, " %"));
  text += fmt::format("  {:16} {}{}\n", "radius", estimate_text(found.radius, kMillimetre, " mm"),
                      found.radius.determined || bounded ? "" : ": not determined");
  text += fmt::format("  {:16} {}{}\n", "stiffness ratio", estimate_text(found.ratio, 1.0, ""),
                      found.ratio.determined || bounded ? "" : ": not determined");
  return text;
}

bool any_undetermined(const identify::MapFit& fit) {
  for (const FoundInclusion& one : fit.inclusions) {
    if (one.at_bounds.empty() && (!one.radius.determined || !one.ratio.determined)) return true;
  }
  return false;
}

constexpr const char* kAdvice =
    "These probes do not determine radius and stiffness ratio apart: a small hard inclusion feels like a "
    "larger, softer one. Press deeper, and with a second ball of another radius.";

constexpr const char* kKindNames[] = {"tissue alone", "lumps", "stiffness map", "lumps and stiffness map"};

/// Which description predicts the held-out probes best.
std::string choice_text(const DescribedMap& map) {
  if (map.held_out == 0) {
    return "too few probes to hold any out: nothing says whether lumps or a stiffness map predict better\n";
  }
  std::string text =
      fmt::format("{} held-out probes (every second) predicted from the others, RMS error: ", map.held_out);
  for (std::size_t i = 0; i < identify::kMapKinds; ++i) {
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", kKindNames[i],
                        percent(map.held_error[i] / map.fit.range, 1));
  }
  text += fmt::format(" of the range; written: {}\n", kKindNames[static_cast<std::size_t>(map.won)]);
  for (const FoundInclusion& one : map.left_out) {
    text += fmt::format(
        "an inclusion near {}, {}, {} mm is left out: undetermined, others predict the force better\n",
        in_mm(one.centre[0].value), in_mm(one.centre[1].value), in_mm(one.centre[2].value));
  }
  return text;
}

Json choice_json(const DescribedMap& map) {
  Json json = {{"held_out_probes", map.held_out}, {"won", identify::to_string(map.won)}};
  constexpr const char* kKeys[] = {"tissue", "lumps", "map", "lumps_and_map"};
  for (std::size_t i = 0; i < identify::kMapKinds && map.held_out > 0; ++i) {
    json["error"][kKeys[i]] = map.held_error[i] / map.fit.range;
  }
  json["left_out"] = Json::array();
  for (const FoundInclusion& one : map.left_out) {
    json["left_out"].push_back({{"x_mm", one.centre[0].value / kMillimetre},
                                {"y_mm", one.centre[1].value / kMillimetre},
                                {"z_mm", one.centre[2].value / kMillimetre}});
  }
  return json;
}

}  // namespace

std::string map_text(const DescribedMap& map) {
  const identify::MapFit& fit = map.fit;
  std::string text = fmt::format(
      "{} probes, {} rows, force range {} N\n"
      "background tissue: F = {} N at 1 mm, as D^{}; first contact {} mm above the first row{}\n"
      "error {} % of the range (uniform tissue: {} %)\n{} inclusion{}\n",
      fit.probes, fit.rows, brief(fit.range, 3),
      brief(fit.stiffness * std::pow(kMillimetre, fit.exponent), 3), brief(fit.exponent, 3),
      in_mm(fit.first_depth),
      fit.map_terms == 1 ? "" : fmt::format("; varies over the surface with {} terms", fit.map_terms),
      brief(100.0 * fit.error / fit.range, 3), brief(100.0 * fit.uniform_error / fit.range, 3),
      fit.inclusions.size(), fit.inclusions.size() == 1 ? "" : "s");
  text += choice_text(map);
  for (std::size_t i = 0; i < fit.inclusions.size(); ++i) text += inclusion_text(fit.inclusions[i], i + 1);
  if (any_undetermined(fit)) text += std::string(kAdvice) + '\n';
  for (const std::string& warning : map.warnings) text += "! " + warning + '\n';
  return text;
}

std::string map_json(const DescribedMap& map) {
  const identify::MapFit& fit = map.fit;
  Json json = {{"probes", fit.probes},
               {"rows", fit.rows},
               {"range_N", fit.range},
               {"error_N", fit.error},
               {"uniform_error_N", fit.uniform_error},
               {"background",
                {{"force_at_1_mm_N", fit.stiffness * std::pow(kMillimetre, fit.exponent)},
                 {"exponent", fit.exponent},
                 {"first_depth_mm", fit.first_depth / kMillimetre},
                 {"map_terms", fit.map_terms}}}};
  json["inclusions"] = Json::array();
  for (const FoundInclusion& one : fit.inclusions) {
    json["inclusions"].push_back({{"x_mm", estimate_json(one.centre[0], kMillimetre)},
                                  {"y_mm", estimate_json(one.centre[1], kMillimetre)},
                                  {"z_mm", estimate_json(one.centre[2], kMillimetre)},
                                  {"depth_mm", estimate_json(one.depth, kMillimetre)},
                                  {"rise", estimate_json(one.rise, 1.0)},
                                  {"radius_mm", estimate_json(one.radius, kMillimetre)},
                                  {"stiffness_ratio", estimate_json(one.ratio, 1.0)},
                                  {"undetermined", !one.at_bounds.empty()},
                                  {"at_bounds", one.at_bounds}});
  }
  json["held_out"] = choice_json(map);
  json["stiffness_map"] = Json::array();
  for (const model::StiffnessPoint& one : fit.stiffness_map) {
    const Vec3 at = one.point_S / kMillimetre;
    json["stiffness_map"].push_back(
        {{"x_mm", at.x()}, {"y_mm", at.y()}, {"z_mm", at.z()}, {"factor", one.factor}});
  }
  if (any_undetermined(fit)) json["advice"] = kAdvice;
  json["warnings"] = map.warnings;
  return json_text(json) + '\n';
}

std::string map_toml(const DescribedMap& map, const MapFiles& files) {
  const identify::MapFit& fit = map.fit;
  std::string text = fmt::format(
      "# What palpate fit --map found: {}. Add the organ's mesh: palpate run THIS.toml --organ MESH.\n",
      kKindNames[static_cast<std::size_t>(map.won)]);
  if (!files.tissue.empty()) {
    text += fmt::format("[organ]\ntissue = {}\n[organ.stiffness]\nmap = {}\n", Json(files.tissue).dump(),
                        Json(files.stiffness).dump());
  }
  for (std::size_t i = 0; i < fit.inclusions.size(); ++i) {
    const FoundInclusion& one = fit.inclusions[i];
    const auto mm = [](const Estimate& estimate) { return brief(estimate.value / kMillimetre, 6); };
    text += fmt::format(
        "[[organ.inclusion]]\nname = \"lump {}\"\nposition_mm = [{}, {}, {}]\nradius_mm = "
        "{}\nstiffness_ratio = "
        "{}\n",
        i + 1, mm(one.centre[0]), mm(one.centre[1]), mm(one.centre[2]), mm(one.radius),
        brief(one.ratio.value, 6));
  }
  if (files.tissue.empty()) return text;
  const std::string radius = shortest(map.predictor.tip_radius / kMillimetre);
  text += fmt::format(
      "[tool]\nmesh = \"sphere:{}\"\ntip_radius_mm = {}\n"
      "[probes]  # for palpate validate --map; palpate run ignores it\nfirst_contact_mm = {}\n",
      radius, radius, shortest(-fit.first_depth / kMillimetre));
  return text;
}

std::string map_csv(const identify::MapFit& fit) {
  std::string text = "x_mm,y_mm,z_mm,factor\n";
  for (const model::StiffnessPoint& one : fit.stiffness_map) {
    const Vec3 at = one.point_S / kMillimetre;
    text += fmt::format("{},{},{},{}\n", brief(at.x(), 9), brief(at.y(), 9), brief(at.z(), 9),
                        brief(one.factor, 6));
  }
  return text;
}

}  // namespace palpate::app
