#include "run/palpation/insertion_score.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"
#include "palpate/tool_contact.h"
#include "palpate/units.h"
#include "run/palpation/score_field.h"

namespace palpate::palpation {
namespace {

constexpr double kDegrees = 180.0 / portable::kPi;  // in a radian
constexpr double kRest = 0.1e-3;                    // m: a tip that advances less than this ...
constexpr double kRestTime = 0.2;                   // s ... in this time has stopped

Vec3 vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

contact::Phase phase_of(const haptics::TickRow& row) { return static_cast<contact::Phase>(row.phase); }

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string listed(const std::vector<std::string>& names) { return names.empty() ? "none" : joined(names); }

/// A length that some scores do not have.
struct MaybeLength {
  nlohmann::ordered_json mm;
  std::string text;
  MaybeLength(const std::optional<double>& length, const char* otherwise) : text(otherwise) {
    if (!length) return;
    mm = *length / kMillimetre;
    text = fmt::format("{:.1f} mm", *length / kMillimetre);
  }
};

std::vector<ScoreField> fields_of(const InsertionScore& score) {
  const MaybeLength closest(score.closest, "");
  const MaybeLength at_end(score.at_end, "");
  const MaybeLength overshoot(score.overshoot, "not reached");
  nlohmann::ordered_json angle;
  if (score.angle) angle = *score.angle * kDegrees;
  const auto of_target = [&score](const char* name) { return score.targets == 0 ? nullptr : name; };
  return {
      {"targets", score.targets},
      {"reached", score.reached, of_target("target reached"),
       score.targets == 1 ? (score.reached > 0 ? "yes" : "no")
                          : fmt::format("{} of {}", score.reached, score.targets),
       "a tip was in the target: its layer, or its inclusion"},
      {"closest_mm", closest.mm, of_target("closest"), closest.text,
       "smallest distance from a tip to the nearest target; 0 in it"},
      {"end_mm", at_end.mm, of_target("at the end"), at_end.text, "that distance in the last tick"},
      {"overshoot_mm", overshoot.mm, of_target("overshoot"), overshoot.text,
       "way of the tip through the tissue beyond its first entry into a target, until it advances less than "
       "0.1 mm in 0.2 s"},
      {"crossed", score.crossed, "layers crossed", listed(score.crossed), "layers that a tip entered"},
      {"forbidden", score.forbidden, "forbidden layers", listed(score.forbidden),
       "those of them that the scene forbids, as a dural puncture"},
      {"angle_deg", angle, "angle",
       score.angle ? fmt::format("{:.1f} deg", *score.angle * kDegrees) : "never inside",
       "between needle and surface normal at the entry that reached a target, else at the last one"},
      {"attempts", score.attempts, "attempts", std::to_string(score.attempts),
       "punctures of the surface; the needle was out before each"},
      {"time_s", score.time, "time", fmt::format("{:.1f} s", score.time),
       "from the first contact until the last target was reached; none reached: to the last contact"},
      {"largest_force_N", score.largest_force, "largest force", fmt::format("{:.2f} N", score.largest_force),
       "tissue force"},
  };
}

}  // namespace

bool is_insertion(const scene::Scene& scene) { return scene.task == scene::Task::kInsert; }

InsertionScorer::InsertionScorer(const scene::Scene& scene, const contact::World& world)
    : scene_(scene),
      surface_(world.rest_distance()),
      motion_(scene::organ_motion_of(scene)),
      hands_(scene.tools.size()) {
  double low = -std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (std::size_t i = 0; i < scene.tissue.layers.size(); ++i) {
    const model::TissueLayer& layer = scene.tissue.layers[i];
    low = high;
    high += layer.thickness;
    if (layer.name == scene.target.layer) targets_.push_back({low, high, i + 1});
  }
  if (!scene.target.layer.empty()) {
    if (targets_.empty()) {
      throw InputError("target: the tissue has no layer \"" + one_line(scene.target.layer) + "\"");
    }
    return;
  }
  const bool hides = std::any_of(scene.inclusions.begin(), scene.inclusions.end(),
                                 [](const scene::InclusionSetup& one) { return !one.visible; });
  for (const scene::InclusionSetup& one : scene.inclusions) {
    if (!hides || !one.visible) targets_.push_back({0.0, 0.0, 0, &one.inclusion});
  }
}

void InsertionScorer::add(const haptics::TickRow& row) {
  Hand& hand = hands_[row.hand];
  const contact::Phase phase = phase_of(row);
  if (phase != contact::Phase::kApproach) {
    if (!began_) began_ = row.time;
    score_.largest_force = std::max(score_.largest_force, row.tissue_force);
    if (score_.reached == 0) score_.time = row.time - *began_;
  }
  const std::optional<geometry::Needle>& needle = scene_.tools[row.hand].needle;
  if (!needle) return;
  const Pose organ_W = motion_.pose_at(scene_.organ_pose, row.tick, scene_.rate_Hz);
  const Quat turn(row.tool_q[0], row.tool_q[1], row.tool_q[2], row.tool_q[3]);
  const Vec3 tip_S = organ_W.inverse() * Vec3(vector_of(row.tool) + turn * needle->tip);
  const bool inside = phase == contact::Phase::kInsert;
  if (inside && !hand.inside) enter(row, organ_W, tip_S, hand);
  hand.inside = inside;
  if (inside) {
    cross(row, hand);
    // In the rest tissue, which is displaced by u = way - length at the entry (needle.cc).
    const Vec3 inwards_S = organ_W.rotation.conjugate() * Vec3(-vector_of(row.normal));
    const double moved = -row.distance - row.inserted_mm * kMillimetre;
    if (approach_targets(row, tip_S + hand.shift_S - moved * inwards_S, hand) && !arrival_) {
      const double length = row.inserted_mm * kMillimetre;
      arrival_ = {row.hand, length, 0.0, row.time, length};
      score_.angle = hand.angle;
    }
  } else {
    // A tip that dents the surface is on it.
    const geometry::NearestPoint nearest = surface_.nearest(tip_S, hand.nearest);
    approach_targets(row, nearest.distance < 0.0 ? nearest.point : tip_S, hand);
  }
  if (arrival_ && arrival_->hand == row.hand) follow(row);
}

/// A puncture of the surface.
void InsertionScorer::enter(const haptics::TickRow& row, const Pose& organ_W, const Vec3& tip_S, Hand& hand) {
  ++score_.attempts;
  hand.layer = 0;
  const Vec3 inwards_S = organ_W.rotation.conjugate() * Vec3(-vector_of(row.normal));
  const Vec3 entry_S = organ_W.inverse() * vector_of(row.contact);
  hand.shift_S = entry_S - (tip_S + row.distance * inwards_S);
  hand.angle = portable::acos(std::clamp(-inwards_S.dot(surface_.nearest(entry_S).normal), -1.0, 1.0));
  if (!arrival_) score_.angle = hand.angle;
}

/// Every layer between the tip's last one and this one: a thin layer may take less than a tick.
void InsertionScorer::cross(const haptics::TickRow& row, Hand& hand) {
  const std::uint64_t end = std::min<std::uint64_t>(row.layer, scene_.tissue.layers.size());
  for (std::uint64_t layer = hand.layer; layer < end; ++layer) {
    const std::string& name = scene_.tissue.layers[layer].name;
    if (contains(score_.crossed, name)) continue;
    score_.crossed.push_back(name);
    if (contains(scene_.target.forbidden, name)) score_.forbidden.push_back(name);
  }
  hand.layer = row.layer;
}

/// @param tip_S in the rest tissue @return whether it is in a target
bool InsertionScorer::approach_targets(const haptics::TickRow& row, const Vec3& tip_S, Hand& hand) {
  if (targets_.empty()) return false;
  const geometry::NearestPoint nearest = surface_.nearest(tip_S, hand.nearest);
  hand.nearest = nearest.triangle;
  const double depth = -nearest.distance;
  bool arrived = false;
  hand.at_end = std::numeric_limits<double>::infinity();
  for (Target& target : targets_) {
    double distance = std::max({0.0, target.low - depth, depth - target.high});
    bool in = hand.inside && row.layer == target.layer;  // a tip at a layer's membrane is not in it
    if (target.inclusion != nullptr) {
      distance = std::max(0.0, (tip_S - target.inclusion->centre_S).norm() - target.inclusion->radius);
      in = hand.inside && distance == 0.0;
    }
    hand.at_end = std::min(*hand.at_end, in ? 0.0 : distance);
    arrived = arrived || in;
    if (!in || target.reached) continue;
    target.reached = true;
    ++score_.reached;
    score_.time = row.time - *began_;
  }
  score_.closest = std::min(score_.closest.value_or(*hand.at_end), *hand.at_end);
  return arrived;
}

void InsertionScorer::follow(const haptics::TickRow& row) {
  const double length = row.inserted_mm * kMillimetre;
  if (length > arrival_->grown_to + kRest) {
    arrival_->grown_to = length;
    arrival_->grown_at = row.time;
  }
  arrival_->stopped = arrival_->stopped || row.time - arrival_->grown_at >= kRestTime;
  if (arrival_->stopped || length <= arrival_->farthest) return;
  if (row.layer != 0) arrival_->way += length - arrival_->farthest;  // 0: out of the far side
  arrival_->farthest = length;
}

InsertionScore InsertionScorer::score() const {
  InsertionScore score = score_;
  score.targets = targets_.size();
  if (arrival_) score.overshoot = arrival_->way;
  for (const Hand& hand : hands_) {
    if (hand.at_end) score.at_end = std::min(score.at_end.value_or(*hand.at_end), *hand.at_end);
  }
  return score;
}

InsertionScore score_insertions(const record::Recording& recording, const contact::Preparation& how,
                                const record::Progress& progress) {
  const haptics::SimulationWorld world = scene::make_world(recording.scene, how);
  InsertionScorer scorer(recording.scene, world.contact);
  for_each_row(recording, progress, [&](const haptics::TickRow& row) { scorer.add(row); });
  return scorer.score();
}

std::vector<Measure> measures(const AnyScore& score) {
  if (const auto* search = std::get_if<Score>(&score)) return measures(*search);
  return measures_of(fields_of(std::get<InsertionScore>(score)));
}

std::string to_json(const AnyScore& score) {
  if (const auto* search = std::get_if<Score>(&score)) return to_json(*search);
  return json_of(fields_of(std::get<InsertionScore>(score)))
      .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace palpate::palpation
