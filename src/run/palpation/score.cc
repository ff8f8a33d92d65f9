#include "run/palpation/score.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/scene/make_world.h"
#include "io/scene/organ_distance.h"
#include "io/scene/search.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "palpate/tool_contact.h"
#include "palpate/units.h"
#include "run/palpation/score_field.h"

namespace palpate::palpation {
namespace {

constexpr double kRateWindow = 50e-3;  // s, over which the force is averaged for its rate

Vec3 vec(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// The search area that belongs to each vertex [m^2]: a third of its triangles there.
std::vector<double> areas_of(const contact::World& world, const Pose& organ_pose) {
  const geometry::TriangleMesh& surface = world.rest_surface();
  std::vector<double> areas(surface.vertices.size(), 0.0);
  const scene::SearchArea area(surface, world.rest_distance(), organ_pose);
  for (const std::int32_t t : area.triangles()) {
    const geometry::Triangle& corners = surface.triangles[static_cast<std::size_t>(t)];
    const double third = geometry::area_vector_doubled(surface, corners).norm() / 6.0;
    for (const std::int32_t v : corners) areas[static_cast<std::size_t>(v)] += third;
  }
  return areas;
}

nlohmann::ordered_json place_json(const Vec3& place) {
  return {place.x() / kMillimetre, place.y() / kMillimetre, place.z() / kMillimetre};
}

std::vector<ScoreField> fields_of(const Score& score) {
  const auto percent = [](double share) { return fmt::format("{:.0f} %", 100.0 * share); };
  nlohmann::ordered_json error_mm;
  if (score.error) error_mm = *score.error / kMillimetre;
  return {
      {"lumps", score.lumps.size()},
      {"found", score.found, "found", fmt::format("{} of {}", score.found, score.lumps.size()),
       "lumps with a mark within the tolerance of the surface above them"},
      {"missed", score.missed, "missed", std::to_string(score.missed), "the other lumps"},
      {"false", score.wrong, "false marks", std::to_string(score.wrong),
       "marks outside every lump's tolerance"},
      {"repeated", score.repeated, "repeated marks", std::to_string(score.repeated),
       "further marks of a lump that is found"},
      {"without_contact", score.untouched},
      {"error_mm", error_mm, "error",
       score.error ? fmt::format("{:.1f} mm", *score.error / kMillimetre) : "none found",
       "mean distance of a found lump to its first mark"},
      {"coverage", score.coverage, "coverage", percent(score.coverage),
       "share of the upper side within the tip's radius (3 to 10 mm) of a contact (Wang and Gerling 2010)"},
      {"time_s", score.time, "time", fmt::format("{:.1f} s", score.time),
       fmt::format("from the first contact to the last mark; {:.1f} s in contact", score.contact_time)},
      {"contact_time_s", score.contact_time},
      {"path_m", score.path, "path", fmt::format("{:.2f} m", score.path),
       "length of the tools' way in that time"},
      {"mean_force_N", score.mean_force, "mean force", fmt::format("{:.3f} N", score.mean_force),
       "tissue force over the ticks in contact"},
      {"largest_force_N", score.largest_force, "largest force", fmt::format("{:.3f} N", score.largest_force),
       "below 10 N deep masses may be missed in a breast (Laufer 2015)"},
      {"force_variation", score.force_variation, "variation of force", percent(score.force_variation),
       "standard deviation divided by the mean (Wang and Gerling 2010)"},
      {"force_rate_N_per_s", score.force_rate, "force rate", fmt::format("{:.2f} N/s", score.force_rate),
       "root mean square of dF/dt of the force averaged over 50 ms; low: smooth (Trejos 2014)"},
  };
}

}  // namespace

std::vector<Lump> lumps_of(const scene::Scene& scene) {
  const bool hides = std::any_of(scene.inclusions.begin(), scene.inclusions.end(),
                                 [](const scene::InclusionSetup& one) { return !one.visible; });
  std::vector<Lump> lumps;
  if (scene.inclusions.empty()) return lumps;
  const geometry::SignedDistance surface = scene::organ_distance_of(scene);
  for (const scene::InclusionSetup& one : scene.inclusions) {
    if (hides && one.visible) continue;
    lumps.push_back({one.name, surface.nearest(one.inclusion.centre_S).point});
  }
  return lumps;
}

Scorer::Scorer(const scene::Scene& scene, const contact::World& world)
    : rate_Hz_(scene.rate_Hz),
      tolerance_(scene.search.tolerance),
      mark_bit_(1U << scene.search.mark_button),
      window_(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kRateWindow * rate_Hz_)))),
      organ_pose_(scene.organ_pose),
      motion_(scene::organ_motion_of(scene)),
      map_(world),
      areas_(areas_of(world, scene.organ_pose)),
      hands_(scene.tools.size()) {
  score_.lumps = lumps_of(scene);
}

void Scorer::add(const haptics::TickRow& row) {
  Hand& hand = hands_[row.hand];
  const Pose organ_W = motion_.pose_at(organ_pose_, row.tick, rate_Hz_);
  const Vec3 place_S = organ_W.inverse() * vec(row.contact);
  const bool touching = static_cast<contact::Phase>(row.phase) != contact::Phase::kApproach;
  map_.add(row, organ_W);
  if (touching && !began_) began_ = row.time;
  const Vec3 tool = vec(row.tool);
  if (began_ && hand.tool) hand.path += (tool - *hand.tool).norm();
  hand.tool = tool;
  if (touching) {
    add_force(row.tissue_force, hand);
    for (Lump& lump : score_.lumps) {
      if ((lump.place_S - place_S).norm() <= tolerance_) lump.covered = true;
    }
    if (score_.marks.empty()) extend_to(row);
  } else {
    hand.forces.clear();
  }
  const bool marking = (row.buttons & mark_bit_) != 0;
  if (marking && !hand.marking) {
    if (touching) {
      add_mark({.tick = row.tick, .hand = row.hand, .place_S = place_S});
      extend_to(row);
    } else {
      ++score_.untouched;
    }
  }
  hand.marking = marking;
}

void Scorer::extend_to(const haptics::TickRow& row) {
  if (!began_) return;
  score_.time = row.time - *began_;
  score_.path = 0.0;
  for (const Hand& hand : hands_) score_.path += hand.path;
}

void Scorer::add_force(double force, Hand& hand) {
  ++ticks_;
  sum_ += force;
  squares_ += force * force;
  score_.largest_force = std::max(score_.largest_force, force);
  // The mean over the window changes by (F_i - F_(i-n)) / n from tick to tick.
  if (hand.forces.size() >= window_) {
    const double change = force - hand.forces[hand.forces.size() - window_];
    const double rate = change * rate_Hz_ / static_cast<double>(window_);
    rates_ += rate * rate;
    ++rate_count_;
  }
  hand.forces.push_back(force);
}

void Scorer::add_mark(Mark mark) {
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < score_.lumps.size(); ++i) {
    const double distance = (score_.lumps[i].place_S - mark.place_S).norm();
    if (nearest && distance >= mark.distance) continue;
    nearest = i;
    mark.distance = distance;
  }
  if (nearest && mark.distance <= tolerance_) {
    mark.lump = nearest;
    mark.first = !score_.lumps[*nearest].found;
    score_.lumps[*nearest].found = true;
  }
  score_.marks.push_back(mark);
}

double Scorer::coverage() const {
  double all = 0.0;
  double touched = 0.0;
  for (std::size_t v = 0; v < areas_.size(); ++v) {
    all += areas_[v];
    if (map_.at(v).depth > 0.0) touched += areas_[v];
  }
  return all > 0.0 ? touched / all : 0.0;
}

Score Scorer::score() const {
  Score score = score_;
  double distances = 0.0;
  for (const Mark& mark : score.marks) {
    if (!mark.lump) {
      ++score.wrong;
    } else if (!mark.first) {
      ++score.repeated;
    } else {
      ++score.found;
      distances += mark.distance;
    }
  }
  score.missed = score.lumps.size() - score.found;
  if (score.found > 0) score.error = distances / static_cast<double>(score.found);
  score.coverage = coverage();
  if (ticks_ == 0) return score;
  const double count = static_cast<double>(ticks_);
  score.contact_time = count / rate_Hz_;
  score.mean_force = sum_ / count;
  const double variance = squares_ / count - score.mean_force * score.mean_force;
  if (score.mean_force > 0.0) score.force_variation = std::sqrt(std::max(0.0, variance)) / score.mean_force;
  if (rate_count_ > 0) score.force_rate = std::sqrt(rates_ / static_cast<double>(rate_count_));
  return score;
}

void require_search(const scene::Scene& scene, const std::string& name, const std::string& remedy) {
  if (scene.task == scene::Task::kPalpate || !scene.inclusions.empty()) return;
  throw InputError(name + ": no search in it: its task is " + scene::to_string(scene.task) +
                   " and it has no lump; " + remedy);
}

ScoredRecording::ScoredRecording(const record::Recording& recording, const contact::Preparation& how,
                                 const record::Progress& progress)
    : world_(std::make_unique<haptics::SimulationWorld>(scene::make_world(recording.scene, how))),
      scorer_(recording.scene, world_->contact) {
  for_each_row(recording, progress, [this](const haptics::TickRow& row) { scorer_.add(row); });
}

std::vector<Measure> measures_of(const std::vector<ScoreField>& fields) {
  std::vector<Measure> shown;
  for (const ScoreField& field : fields) {
    if (field.name != nullptr) shown.push_back({field.name, field.text, field.definition});
  }
  return shown;
}

nlohmann::ordered_json json_of(const std::vector<ScoreField>& fields) {
  nlohmann::ordered_json json;
  for (const ScoreField& field : fields) json[field.key] = field.value;
  return json;
}

std::vector<Measure> measures(const Score& score) { return measures_of(fields_of(score)); }

std::string to_json(const Score& score) {
  nlohmann::ordered_json json = json_of(fields_of(score));
  json["lump"] = nlohmann::ordered_json::array();
  for (const Lump& lump : score.lumps) {
    json["lump"].push_back({{"name", lump.name},
                            {"place_mm", place_json(lump.place_S)},
                            {"found", lump.found},
                            {"covered", lump.covered}});
  }
  json["mark"] = nlohmann::ordered_json::array();
  for (const Mark& mark : score.marks) {
    nlohmann::ordered_json one = {
        {"tick", mark.tick}, {"hand", mark.hand}, {"place_mm", place_json(mark.place_S)}};
    one["lump"] = nullptr;
    if (mark.lump) one["lump"] = score.lumps[*mark.lump].name;
    one["distance_mm"] = nullptr;
    if (!score.lumps.empty()) one["distance_mm"] = mark.distance / kMillimetre;
    json["mark"].push_back(std::move(one));
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void write_map(const FeltMap& map, const std::filesystem::path& file) {
  std::string text = "x_mm,y_mm,z_mm,felt_factor,true_factor,depth_mm,force_N\n";
  const geometry::TriangleMesh& surface = map.surface();
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const FeltPlace felt = map.at(v);
    const Vec3 place = surface.vertices[v] / kMillimetre;
    text += fmt::format("{:.4f},{:.4f},{:.4f},{},{:.4f},{:.4f},{:.4f}\n", place.x(), place.y(), place.z(),
                        std::isnan(felt.factor) ? "" : fmt::format("{:.4f}", felt.factor), map.true_factor(v),
                        felt.depth / kMillimetre, felt.force);
  }
  write_output(file, text);
}

}  // namespace palpate::palpation
