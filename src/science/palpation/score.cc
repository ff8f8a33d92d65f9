#include "science/palpation/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/geometry/signed_distance.h"
#include "io/scene/make_world.h"
#include "io/scene/search.h"
#include "io/system/output_file.h"
#include "palpate/tool_contact.h"
#include "palpate/units.h"

namespace palpate::palpation {
namespace {

constexpr double kRateWindow = 50e-3;  // s, over which the force is averaged for its rate

Vec3 vec(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// Measures of the forces in contact, over all hands.
class ForceMeasures final {
 public:
  ForceMeasures(std::size_t hands, double rate_Hz)
      : rate_Hz_(rate_Hz),
        window_(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kRateWindow * rate_Hz)))),
        last_(hands) {}

  void add(const haptics::TickRow& row, bool touching) {
    std::vector<double>& last = last_[row.hand];
    if (!touching) {
      last.clear();
      return;
    }
    const double force = row.tissue_force;
    ++ticks_;
    sum_ += force;
    squares_ += force * force;
    largest_ = std::max(largest_, force);
    // The mean over the window changes by (F_i - F_(i-n)) / n from tick to tick.
    if (last.size() >= window_) {
      const double rate = (force - last[last.size() - window_]) * rate_Hz_ / static_cast<double>(window_);
      rates_ += rate * rate;
      ++rate_count_;
    }
    last.push_back(force);
  }

  void write(Score& score) const {
    if (ticks_ == 0) return;
    const double count = static_cast<double>(ticks_);
    score.contact_time = count / rate_Hz_;
    score.mean_force = sum_ / count;
    score.largest_force = largest_;
    const double variance = squares_ / count - score.mean_force * score.mean_force;
    if (score.mean_force > 0.0) score.force_variation = std::sqrt(std::max(0.0, variance)) / score.mean_force;
    if (rate_count_ > 0) score.force_rate = std::sqrt(rates_ / static_cast<double>(rate_count_));
  }

 private:
  double rate_Hz_;
  std::size_t window_;                     // ticks
  std::vector<std::vector<double>> last_;  // per hand: the forces since its contact began
  std::uint64_t ticks_ = 0;
  std::uint64_t rate_count_ = 0;
  double sum_ = 0.0;
  double squares_ = 0.0;
  double largest_ = 0.0;
  double rates_ = 0.0;
};

/// Adds a mark to the score and decides which lump it finds.
void add_mark(Mark mark, double tolerance, Score& score) {
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < score.lumps.size(); ++i) {
    const double distance = (score.lumps[i].place_S - mark.place_S).norm();
    if (nearest && distance >= mark.distance) continue;
    nearest = i;
    mark.distance = distance;
  }
  if (nearest && mark.distance <= tolerance) {
    mark.lump = nearest;
    mark.first = !score.lumps[*nearest].found;
    score.lumps[*nearest].found = true;
  }
  score.marks.push_back(mark);
}

void count_marks(Score& score) {
  double sum = 0.0;
  for (const Mark& mark : score.marks) {
    if (!mark.lump) {
      ++score.wrong;
    } else if (!mark.first) {
      ++score.repeated;
    } else {
      ++score.found;
      sum += mark.distance;
    }
  }
  score.missed = score.lumps.size() - score.found;
  if (score.found > 0) score.error = sum / static_cast<double>(score.found);
}

/// The share of the search area that was touched.
double coverage_of(const FeltMap& map, const Pose& organ_pose) {
  const geometry::TriangleMesh& surface = map.surface();
  const scene::SearchArea area(surface, organ_pose);
  double all = 0.0;
  double touched = 0.0;
  for (const std::int32_t t : area.triangles()) {
    const geometry::Triangle& corners = surface.triangles[static_cast<std::size_t>(t)];
    const double size = geometry::area_vector_doubled(surface, corners).norm();
    const auto felt = std::count_if(corners.begin(), corners.end(), [&](std::int32_t v) {
      return map.at(static_cast<std::size_t>(v)).depth > 0.0;
    });
    all += size;
    touched += size * static_cast<double>(felt) / 3.0;
  }
  return all > 0.0 ? touched / all : 0.0;
}

/// Time and length of a search: from the first contact to the last mark or, without marks, the last contact.
void measure_way(const record::Recording& recording, Score& score) {
  std::optional<std::uint64_t> first;
  std::uint64_t last = 0;
  for (const haptics::TickRow& row : recording.rows) {
    if (static_cast<contact::Phase>(row.phase) == contact::Phase::kApproach) continue;
    if (!first) first = row.tick;
    last = row.tick;
  }
  if (!first) return;
  if (!score.marks.empty()) last = std::max(*first, score.marks.back().tick);
  score.time = static_cast<double>(last - *first) / recording.setup.rate_Hz;
  std::vector<std::optional<Vec3>> before(recording.setup.tools.size());
  for (const haptics::TickRow& row : recording.rows) {
    if (row.tick < *first || row.tick > last) continue;
    const Vec3 tool = vec(row.tool);
    if (before[row.hand]) score.path += (tool - *before[row.hand]).norm();
    before[row.hand] = tool;
  }
}

nlohmann::ordered_json place_json(const Vec3& place) {
  return {place.x() / kMillimetre, place.y() / kMillimetre, place.z() / kMillimetre};
}

}  // namespace

std::vector<Lump> lumps_of(const scene::Scene& setup) {
  const bool hides = std::any_of(setup.inclusions.begin(), setup.inclusions.end(),
                                 [](const scene::InclusionSetup& one) { return !one.visible; });
  std::vector<Lump> lumps;
  if (setup.inclusions.empty()) return lumps;
  const geometry::SignedDistance surface(setup.organ);
  for (const scene::InclusionSetup& one : setup.inclusions) {
    if (hides && one.visible) continue;
    lumps.push_back({one.name, surface.nearest(one.inclusion.centre_S).point});
  }
  return lumps;
}

Palpation score_recording(const record::Recording& recording, const contact::World& world,
                          const record::Progress& progress) {
  const scene::Scene& setup = recording.setup;
  const double tolerance = setup.search.tolerance;
  const std::uint32_t mark_bit = 1U << setup.search.mark_button;
  const model::OrganMotion motion = scene::organ_motion_of(setup);
  Palpation made(world);
  Score& score = made.score;
  score.lumps = lumps_of(setup);
  ForceMeasures forces(setup.tools.size(), setup.rate_Hz);
  std::vector<bool> pressed(setup.tools.size(), false);
  for (std::size_t i = 0; i < recording.rows.size(); ++i) {
    const haptics::TickRow& row = recording.rows[i];
    const Pose organ_W = motion.pose_at(setup.organ_pose, row.tick, setup.rate_Hz);
    const Vec3 place_S = organ_W.inverse() * vec(row.contact);
    const bool touching = static_cast<contact::Phase>(row.phase) != contact::Phase::kApproach;
    forces.add(row, touching);
    made.map.add(row, organ_W);
    for (Lump& lump : score.lumps) {
      if (touching && (lump.place_S - place_S).norm() <= tolerance) lump.covered = true;
    }
    const bool now = (row.buttons & mark_bit) != 0;
    if (now && !pressed[row.hand])
      add_mark({.tick = row.tick, .hand = row.hand, .place_S = place_S}, tolerance, score);
    pressed[row.hand] = now;
    if (progress && i % 10000 == 0)
      progress(static_cast<double>(i) / static_cast<double>(recording.rows.size()));
  }
  count_marks(score);
  forces.write(score);
  measure_way(recording, score);
  score.coverage = coverage_of(made.map, setup.organ_pose);
  return made;
}

std::string to_json(const Score& score) {
  nlohmann::ordered_json json = {{"lumps", score.lumps.size()},
                                 {"found", score.found},
                                 {"missed", score.missed},
                                 {"false", score.wrong},
                                 {"repeated", score.repeated}};
  json["error_mm"] = nullptr;
  if (score.error) json["error_mm"] = *score.error / kMillimetre;
  json["coverage"] = score.coverage;
  json["time_s"] = score.time;
  json["contact_time_s"] = score.contact_time;
  json["path_m"] = score.path;
  json["mean_force_N"] = score.mean_force;
  json["largest_force_N"] = score.largest_force;
  json["force_variation"] = score.force_variation;
  json["force_rate_N_per_s"] = score.force_rate;
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
  const double depth = map.mean_depth() > 0.0 ? map.mean_depth() : 5e-3;
  const geometry::TriangleMesh& surface = map.surface();
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const FeltPlace felt = map.at(v);
    const Vec3 place = surface.vertices[v] / kMillimetre;
    text += fmt::format("{:.4f},{:.4f},{:.4f},{},{:.4f},{:.4f},{:.4f}\n", place.x(), place.y(), place.z(),
                        std::isnan(felt.factor) ? "" : fmt::format("{:.4f}", felt.factor),
                        map.true_factor(v, depth), felt.depth / kMillimetre, felt.force);
  }
  write_output(file, text);
}

}  // namespace palpate::palpation
