// A tool under a pointer: where it goes in one picture.
//
// The pointer's line of sight meets the organ's rest surface at a place, or passes beside the organ. The tool
// is moved by its touching point, the point near its tip that is farthest along the inward normal.
//
//     rides   over the surface: walks towards the place from triangle to triangle, 1 mm a step, and holds its
//             set height or depth along the normal there. An edge or a gap in the way ends the ride.
//     flies   in the air, at least 5 mm away: straight to a point over the place, if nothing is in the way;
//             else it rises to the viewer, from whom all visible places can be reached. Beside the organ it
//             glides at the point of the line of sight that is nearest to the organ.
//     drags   the tissue that its jaws hold, in a plane that faces the viewer.
//     enters  with a needle: along its axis alone.
//
// It turns with the normal, by at most 45 degrees, and only so far that its handle stays 35 degrees from the
// line of sight: a tool seen from its end hides the contact. In the air it turns about its tip, on the
// surface about its touching point, which keeps the depth.
//
// Only the touching point is led around the organ; a ball's side or a shaft may still meet it. So each step
// before a press is tried: when it brings any sample of the tool's surface nearer than 2 mm, the step is
// undone, and the tool moves away from the organ there, or out of a groove to the viewer. It slides along an
// edge in that way, and stays before a gap that is too narrow. The samples are looked at only when the tool
// may have come so near since they were looked at last: no distance falls by more than the tool has moved.

#include "run/devices/surface_rider.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace palpate::devices {
namespace {

constexpr double kWalkStep = 1e-3;   // m
constexpr double kFar = 5.0;         // m, longest line of sight
constexpr double kTipRegion = 0.04;  // m from the tip; the tool touches with this part
constexpr double kFromSight = 0.44;  // rad, 25 degrees, between the handle and the line of sight
constexpr double kTiltStep = 0.01;   // rad

/// Moves a point by at most `way` towards a goal.
Vec3 towards(const Vec3& from, const Vec3& goal, double way) {
  const Vec3 left = goal - from;
  const double far = left.norm();
  return far <= way ? goal : Vec3(from + way / far * left);
}

/// Calls `use` with the vertices of a tool that are less than `within` [m] from a point, handle frame.
template <typename Use>
void for_each_vertex(const geometry::Tool& tool, double gripper, const Vec3& near_P, double within,
                     const Use& use) {
  for (const geometry::ToolPart& part : tool.parts) {
    const Pose pose = geometry::part_pose(part, gripper);
    for (const Vec3& vertex : part.mesh.vertices) {
      const Vec3 place = pose * vertex;
      if ((place - near_P).squaredNorm() < within * within) use(place);
    }
  }
}

/// The point of a tool that is farthest along a unit direction; handle frame. Across the direction it is the
/// mean of all that are at most 1 mm less far, so that it has no jump when the direction turns. Only vertices
/// less than `within` [m] from a point count: a shaft is no tip.
Vec3 farthest_point(const geometry::Tool& tool, double gripper, const Vec3& direction_P,
                    const Vec3& near_P = Vec3::Zero(), double within = kFar) {
  constexpr double kBand = 1e-3;  // m
  double most = -kFar;
  for_each_vertex(tool, gripper, near_P, within,
                  [&](const Vec3& v) { most = std::max(most, direction_P.dot(v)); });
  Vec3 sum = Vec3::Zero();
  double weights = 0.0;
  for_each_vertex(tool, gripper, near_P, within, [&](const Vec3& v) {
    const double weight = std::max(0.0, 1.0 - (most - direction_P.dot(v)) / kBand);
    sum += weight * v;
    weights += weight;
  });
  const Vec3 mean = sum / weights;
  return mean + (most - direction_P.dot(mean)) * direction_P;
}

/// Points of a tool's surface, about kApart apart; handle frame.
std::vector<Vec3> samples_of(const geometry::Tool& tool, double gripper) {
  constexpr double kApart = 3e-3;  // m
  std::set<std::array<int, 3>> taken;
  std::vector<Vec3> samples;
  const auto add = [&](const Vec3& p) {
    std::array<int, 3> cell{};
    for (std::size_t k = 0; k < 3; ++k)
      cell[k] = static_cast<int>(std::floor(p[static_cast<Eigen::Index>(k)] / kApart));
    if (taken.insert(cell).second) samples.push_back(p);
  };
  for (const geometry::ToolPart& part : tool.parts) {
    const Pose pose = geometry::part_pose(part, gripper);
    for (const geometry::Triangle& t : part.mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& a = part.mesh.vertices[static_cast<std::size_t>(t[k])];
        const Vec3& b = part.mesh.vertices[static_cast<std::size_t>(t[(k + 1) % 3])];
        const int pieces = std::max(1, static_cast<int>((b - a).norm() / kApart));
        for (int i = 0; i <= pieces; ++i) add(pose * Vec3(a + (b - a) * i / pieces));
      }
    }
  }
  return samples;
}

}  // namespace

SurfaceRider::SurfaceRider(const contact::OrganSurface& surface, const geometry::Tool& tool,
                           const Pose& organ_W, const Pose& start_W, double gripper, double reach)
    : surface_(surface), tool_(tool), organ_W_(organ_W), reach_(reach) {
  const Pose start_S = organ_W.inverse() * start_W;
  start_S_ = start_S.rotation;
  orientation_S_ = start_S_;
  normal_S_ = -(start_S_ * Vec3::UnitZ());
  tip_P_ = farthest_point(tool, 0.0, Vec3::UnitZ());
  samples_P_ = samples_of(tool, gripper);
  for (const Vec3& sample : samples_P_) length_ = std::max(length_, (sample - tip_P_).norm());
  tip_S_ = start_S * tip_P_;
  touch_S_ = tip_S_ + tip_to_touch(gripper);
  reach_from_S_ = touch_S_;
  if (tool.needle) max_depth_ = std::max(kMaxDepth, tool.needle->length);
}

void SurfaceRider::feel_needle(bool inside, const Vec3& force_W) noexcept {
  if (!tool_.needle) return;
  inside_ = inside;
  const double resistance = -(organ_W_.rotation * orientation_S_ * tool_.needle->axis).dot(force_W);
  pace_ = kHalfPace / (kHalfPace + std::max(0.0, resistance));
}

void SurfaceRider::point_at(const geometry::Ray& ray_W) {
  const Pose world_S = organ_W_.inverse();
  ray_S_ = {world_S * ray_W.origin, world_S.rotation * ray_W.direction};
  const std::optional<geometry::Entry> entry =
      surface_.first_entry(ray_S_.origin, ray_S_.origin + kFar * ray_S_.direction);
  goal_ = entry ? Goal::kSurface : Goal::kAir;
  if (entry) aim_ = {entry->point, entry->triangle};
}

double SurfaceRider::depth() const noexcept { return -std::clamp(height_ - deeper_, -max_depth_, kParked); }

void SurfaceRider::advance(double time, double gripper, bool dragging, double pace) {
  const double step = std::clamp(time, 0.0, kLongestStep);
  const double way = pace * kMaxSpeed * step;
  const double deeper = std::exchange(deeper_, 0.0);
  const Stand before = stand();
  if (dragging) {
    if (goal_ != Goal::kNone) drag(way, deeper);
  } else {
    height_ = std::clamp(height_ - deeper, -max_depth_, kParked);
    if (drag_offset_S_) riding_ = false;
    drag_offset_S_.reset();
    if (riding_) ride(way, pace * kPressSpeed * step, kPressSpeed * step);
    const bool flies = !riding_ && goal_ != Goal::kNone && !parked_;
    if (flies) fly(way);
    if (!inside_) turn(kTurnSpeed * step);
    // In the air the tool turns about its tip, on the surface about the point that touches.
    if (flies && !riding_) touch_S_ = before.tip_S + (touch_S_ - before.touch_S) + tip_to_touch(gripper);
  }
  tip_S_ = touch_S_ - tip_to_touch(gripper);
  const bool presses = riding_ && wanted_height() < kHover;
  if (dragging || presses) {
    clear_ = -kFar;
  } else {
    keep_clear(before, way, gripper);
  }
}

SurfaceRider::Stand SurfaceRider::stand() const {
  return {riding_, place_, over_, normal_S_, touch_S_, tip_S_, orientation_S_};
}

void SurfaceRider::return_to(const Stand& stand) {
  riding_ = stand.riding;
  place_ = stand.place;
  over_ = stand.over;
  normal_S_ = stand.normal_S;
  touch_S_ = stand.touch_S;
  tip_S_ = stand.tip_S;
  orientation_S_ = stand.orientation_S;
}

SurfaceRider::Clearance SurfaceRider::clearance() const {
  Clearance least{kFar, Vec3::UnitZ()};
  for (const Vec3& sample_P : samples_P_) {
    const geometry::NearestPoint nearest =
        surface_.nearest(tip_S_ + orientation_S_ * Vec3(sample_P - tip_P_), -1);
    if (nearest.distance < least.distance) least = {nearest.distance, nearest.normal};
  }
  return least;
}

void SurfaceRider::keep_clear(const Stand& before, double way, double gripper) {
  constexpr double kLeast = 2e-3;  // m
  clear_ -= (tip_S_ - before.tip_S).norm() + length_ * orientation_S_.angularDistance(before.orientation_S);
  if (clear_ >= kLeast) return;
  const double now = clear_ = clearance().distance;
  if (now >= kLeast) return;
  const Stand tried = stand();
  return_to(before);
  const Clearance was = clearance();
  if (now >= was.distance) {
    return_to(tried);
    return;
  }
  clear_ = -kFar;  // not known after what follows
  // Away from the organ; in a groove, out of it to the viewer.
  for (const Vec3& direction : {was.away_S, way_to_viewer(), Vec3((ray_S_.origin - touch_S_).normalized())}) {
    return_to(before);
    riding_ = false;
    touch_S_ += way * direction;
    tip_S_ = touch_S_ - tip_to_touch(gripper);
    if (clearance().distance > was.distance) return;
  }
  if (was.distance >= 0.0) return_to(before);
}

ToolTarget SurfaceRider::target() const { return {organ_W_ * tip_S_, organ_W_.rotation * orientation_S_}; }

void SurfaceRider::ride(double way, double down, double up) {
  if (goal_ != Goal::kNone && !parked_ && !inside_) riding_ = goal_ == Goal::kSurface && walk(way);
  if (!riding_) return;
  const double rise = std::clamp(wanted_height() - over_, -down, up);
  over_ += rise;
  if (inside_) {
    touch_S_ -= rise * (orientation_S_ * tool_.needle->axis);
    return;
  }
  normal_S_ = surface_.normal_at(place_);
  touch_S_ = place_.point + over_ * normal_S_;
}

bool SurfaceRider::walk(double way) {
  constexpr double kLeastProgress = 0.3;  // of a step; less: an edge or a gap is in between
  constexpr double kNear = 1.5e-3;        // m, over which edges do not matter
  while (way > 0.0) {
    const Vec3 left = aim_.point - place_.point;
    const double far = left.norm();
    if (far <= std::min(way, kNear)) {
      place_ = aim_;
      return true;
    }
    const Vec3 normal = surface_.normal_at(place_);
    const Vec3 along = left - normal.dot(left) * normal;
    if (along.norm() < 0.5 * far) return false;
    const double step = std::min({kWalkStep, way, far});
    const contact::SurfacePoint next = surface_.walk(place_, step / along.norm() * along, normal);
    if (far - (aim_.point - next.point).norm() < kLeastProgress * step) return false;
    place_ = next;
    way -= step;
  }
  return true;
}

void SurfaceRider::fly(double way) {
  if (lift_off(way)) return;
  const AirPlace goal = goal_in_air();
  const double far = (goal.point - touch_S_).norm();
  if (!free_between(touch_S_, goal.point)) {
    constexpr double kAhead = 10e-3;  // m
    const Vec3 rising = ((goal.point - touch_S_).normalized() + (ray_S_.origin - touch_S_).normalized());
    const Vec3 ahead = touch_S_ + kAhead * rising.normalized();
    const bool rises = rising.norm() > 0.1 && free_between(touch_S_, ahead) && distance(ahead) > 0.8 * kHover;
    const Vec3 risen = within_reach(touch_S_ + way * (rises ? rising.normalized() : way_to_viewer()));
    // A place behind a gap can be out of reach from everywhere: the tool waits under the pointer, near the
    // organ.
    touch_S_ = distance(risen) < kHighest ? risen : towards(touch_S_, on_sight(), way);
    return;
  }
  turn_normal(goal.normal, far > way ? way / far : 1.0);
  touch_S_ = towards(touch_S_, goal.point, way);
  if (goal_ != Goal::kSurface || far > way) return;
  riding_ = true;
  place_ = aim_;
  over_ = (touch_S_ - place_.point).dot(goal.normal);
}

Vec3 SurfaceRider::on_sight() const {
  return ray_S_.origin + ray_S_.direction.dot(touch_S_ - ray_S_.origin) * ray_S_.direction;
}

bool SurfaceRider::lift_off(double way) {
  constexpr double kEnough = 0.8 * kHover;
  const geometry::NearestPoint nearest = surface_.nearest(touch_S_, -1);
  if (nearest.distance >= kEnough) return false;
  const Vec3 direction = nearest.distance < 0.0 ? normal_S_ : nearest.normal;
  const Vec3 lifted = touch_S_ + way * direction;
  // In a groove there is no more room than this.
  if (nearest.distance > 0.0 && distance(lifted) < nearest.distance + 0.1 * way) return false;
  touch_S_ = lifted;
  return true;
}

Vec3 SurfaceRider::way_to_viewer() const {
  const Vec3 to_viewer = (ray_S_.origin - touch_S_).normalized();
  const geometry::NearestPoint nearest = surface_.nearest(touch_S_, -1);
  const double outwards = nearest.normal.dot(to_viewer);
  if (outwards >= 0.0 || nearest.distance > 2.0 * kHover) return to_viewer;
  const Vec3 along = to_viewer - outwards * nearest.normal;
  return along.norm() > 0.1 ? along.normalized() : nearest.normal.unitOrthogonal();
}

SurfaceRider::AirPlace SurfaceRider::goal_in_air() const {
  if (goal_ == Goal::kSurface) {
    const Vec3 normal = surface_.normal_at(aim_);
    return {within_reach(aim_.point + std::max(kHover, height_) * normal), normal};
  }
  // The point of the line of sight that is nearest to the organ; not nearer than kHover.
  constexpr int kSamples = 64;
  const double end = 2.0 * (surface_.nearest(ray_S_.origin, -1).point - ray_S_.origin).norm() + 0.1;
  const auto at = [&](double t) { return Vec3(ray_S_.origin + t * ray_S_.direction); };
  double best = 0.0;
  double least = kFar;
  for (int i = 0; i <= kSamples; ++i) {
    const double t = end * i / kSamples;
    const double far = distance(at(t));
    if (far < least) {
      least = far;
      best = t;
    }
  }
  for (double half = 0.5 * end / kSamples; half > 1e-4; half *= 0.5) {
    for (const double t : {best - half, best + half}) {
      const double far = distance(at(t));
      if (far >= least) continue;
      least = far;
      best = t;
    }
  }
  const geometry::NearestPoint nearest = surface_.nearest(at(best), -1);
  const Vec3 outwards =
      nearest.distance > 1e-6 ? Vec3((at(best) - nearest.point).normalized()) : nearest.normal;
  return {within_reach(nearest.point + std::max(kHover, nearest.distance) * outwards), outwards};
}

bool SurfaceRider::free_between(const Vec3& a, const Vec3& b) const {
  constexpr double kSpacing = 3e-3;    // m
  constexpr double kClearance = 8e-3;  // m, room for the tool around the point that is moved
  constexpr double kRise = 0.3;        // the room grows from half of that at the ends
  const double length = (b - a).norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / kSpacing)));
  const double at_a = 0.5 * distance(a);
  const double at_b = 0.5 * distance(b);
  for (int i = 1; i < pieces; ++i) {
    const double way = length * i / pieces;
    const double room = std::min({kClearance, at_a + kRise * way, at_b + kRise * (length - way)});
    if (distance(a + way / length * (b - a)) < room) return false;
  }
  return true;
}

Vec3 SurfaceRider::within_reach(const Vec3& point_S) const {
  const Vec3 way = point_S - reach_from_S_;
  const double far = way.norm();
  return far > reach_ ? Vec3(reach_from_S_ + reach_ / far * way) : point_S;
}

void SurfaceRider::drag(double way, double deeper) {
  if (!drag_offset_S_) {
    drag_plane_S_ = touch_S_;
    dragged_ = 0.0;
  }
  // Where the line of sight meets the plane that faces the viewer.
  const Vec3 facing = (drag_plane_S_ - ray_S_.origin).normalized();
  const double slope = std::max(0.2, facing.dot(ray_S_.direction));
  const Vec3 pointed = ray_S_.origin + facing.dot(drag_plane_S_ - ray_S_.origin) / slope * ray_S_.direction;
  if (!drag_offset_S_) drag_offset_S_ = touch_S_ - pointed;
  const double dragged = std::clamp(dragged_ + deeper, -reach_, kMaxDepth);
  *drag_offset_S_ -= (dragged - dragged_) * normal_S_;
  dragged_ = dragged;
  touch_S_ = towards(touch_S_, within_reach(pointed + *drag_offset_S_), way);
}

void SurfaceRider::turn_normal(const Vec3& goal, double share) {
  const Vec3 mean = (1.0 - share) * normal_S_ + share * goal;
  if (mean.norm() > 1e-3) normal_S_ = mean.normalized();
}

void SurfaceRider::turn(double angle) {
  constexpr double kOpposite = 2.6;  // rad; beyond, the direction of the tilt is not certain
  const Vec3 axis = (start_S_ * Vec3::UnitZ()).cross(-normal_S_);
  const double wanted = std::atan2(axis.norm(), -(start_S_ * Vec3::UnitZ()).dot(normal_S_));
  const double certain = std::min(1.0, (std::numbers::pi - wanted) / (std::numbers::pi - kOpposite));
  const auto tilted = [&](double tilt) {
    return axis.norm() > 1e-9 ? (rotation_about(axis.normalized(), tilt) * start_S_).normalized() : start_S_;
  };
  const Vec3 to_viewer = (ray_S_.origin - touch_S_).normalized();
  const auto hides = [&](double tilt) {
    return -(tilted(tilt) * Vec3::UnitZ()).dot(to_viewer) > std::cos(kFromSight);
  };
  const double furthest = certain * std::min(kMaxTilt, wanted);
  double tilt = furthest;
  while (tilt > 0.0 && hides(tilt)) tilt -= kTiltStep;
  const Quat goal = tilted(tilt > 0.0 || !hides(0.0) ? std::max(tilt, 0.0) : furthest);
  const double left = orientation_S_.angularDistance(goal);
  orientation_S_ = left <= angle ? goal : slerp(orientation_S_, goal, angle / left);
}

Vec3 SurfaceRider::tip_to_touch(double gripper) const {
  const Vec3 direction_P = orientation_S_.conjugate() * Vec3(-normal_S_);
  return orientation_S_ * Vec3(farthest_point(tool_, gripper, direction_P, tip_P_, kTipRegion) - tip_P_);
}

}  // namespace palpate::devices
