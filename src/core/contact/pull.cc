#include "core/contact/pull.h"

#include <algorithm>

namespace palpate::contact {
namespace {

constexpr double kClosedBelow = 0.3;  // gripper
constexpr double kOpenAbove = 0.5;    // gripper
constexpr double kGraspReach = 1e-3;  // m, from a jaw to the organ
constexpr double kPressFade = 20e-3;  // s
constexpr double kLetGoFade = 25e-3;  // s

/// Whether a part takes hold: a jaw, or any part of a tool without jaws.
bool holds(const ToolPoints& points, std::size_t part) noexcept {
  return !points.has_jaws || points.parts[part].joint.is_jaw;
}

/// Follows the gripper; @return true in the ticks in which the jaws close on.
bool closes(double gripper, GripState& grip) noexcept {
  if (gripper > kOpenAbove) {
    grip.open = true;
    grip.released = false;
  }
  const bool past = grip.open && gripper < kClosedBelow;
  if (past) {
    grip.open = false;
    grip.closing = true;
  } else if (gripper >= grip.last_gripper) {
    grip.closing = false;
  }
  grip.last_gripper = gripper;
  return grip.closing;
}

void let_go(GripState& grip) noexcept {
  grip.held = false;
  grip.released_force = grip.force;
  grip.released_stretch = grip.stretch;
  grip.fade = 1.0;
}

/// Where a jaw meets the tissue: the mean of its points as near as the nearest, weighted as in a support, so
/// that neither the mesh nor rounding decides between points that are equally near.
Vec3 meeting_point(const PartPoints& points, DistanceCache& distances) noexcept {
  distances.find_nearest();
  const double nearest = distances.nearest().distance;
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (distances.least(i) >= nearest + kSupportBand) continue;
    const double distance = distances.ask(i).distance;
    const double weight = points.area[i] * std::max(0.0, 1.0 - (distance - nearest) / kSupportBand);
    sum += weight * points.point(i);
    total += weight;
  }
  return distances.placed_S() * (total > 0.0 ? Vec3(sum / total) : points.point(distances.nearest_point()));
}

/// Takes hold of the rest point nearest to the middle of the jaws, if a jaw that has been outside is near.
void take_hold(const World::Data& world, const ToolPoints& points, ToolState& tool) noexcept {
  Vec3 middle = Vec3::Zero();
  double nearest = kGraspReach;
  double count = 0.0;
  bool near = false;
  for (std::size_t i = 0; i < points.parts.size(); ++i) {
    PartState& part = tool.parts[i];
    if (!holds(points, i) || !part.armed) continue;
    middle += meeting_point(points.parts[i], part.distances);
    count += 1.0;
    if (part.distances.nearest().distance > nearest) continue;
    near = true;
    nearest = part.distances.nearest().distance;
    tool.grip.tip_radius = points.parts[i].tip_radius[part.distances.nearest_point()];
  }
  if (!near) return;
  const geometry::NearestPoint anchor = world.surface.nearest(middle / count, -1);
  GripState& grip = tool.grip;
  grip.held = true;
  grip.closing = false;
  grip.anchor = {anchor.point, anchor.triangle};
  grip.normal = world.surface.normal_at(grip.anchor);
  grip.anchor_T = tool.pose_S.inverse() * anchor.point;
  grip.memory = {};
}

/// Force of the stretched tissue. @return false when it is past what the grip can hold
bool stretch_force(const TissueLaws& laws, ToolState& tool) noexcept {
  GripState& grip = tool.grip;
  grip.stretch = tool.pose_S * grip.anchor_T - grip.anchor.point;
  const double length = grip.stretch.norm();
  const model::ContactResponse response = laws.pull.force_at(length);
  Vec3 force = length > 0.0 ? Vec3(-(response.force / length) * grip.stretch) : Vec3(Vec3::Zero());
  if (laws.relaxation.count() > 0) {
    // By components: relaxation is linear in the force, and of a force that is the slope of a convex energy
    // over the stretch it stays passive (relaxation.h).
    for (int k = 0; k < 3; ++k) {
      force[k] = laws.relaxation.next(grip.memory[static_cast<std::size_t>(k)], force[k]);
    }
    if (force.norm() > laws.grip_limit) return false;
  } else if (response.force > laws.grip_limit) {
    return false;
  }
  grip.force = force;
  grip.cutoff_layer = response.cutoff_layer;
  grip.saturated = response.saturated;
  return true;
}

}  // namespace

std::uint32_t update_pull(const World::Data& world, const TissueLaws& laws, const ToolPoints& points,
                          double gripper, ToolState& tool) noexcept {
  GripState& grip = tool.grip;
  if (grip.fade > 0.0) grip.fade = std::max(0.0, grip.fade - world.period / kLetGoFade);
  if (closes(gripper, grip) && !grip.held && !grip.released) take_hold(world, points, tool);
  if (grip.held && gripper > kOpenAbove) {
    let_go(grip);
  } else if (grip.held && !stretch_force(laws, tool)) {
    let_go(grip);
    grip.released = true;
  }
  if (!grip.held) {
    grip.force = grip.fade * grip.released_force;
    grip.stretch = grip.fade * grip.released_stretch;
  }
  const double change = world.period / kPressFade;
  for (std::size_t i = 0; i < points.parts.size(); ++i) {
    double& level = tool.parts[i].press_level;
    const bool off = grip.held && holds(points, i);
    level = off ? std::max(0.0, level - change) : std::min(1.0, level + change);
  }
  return grip.released ? kGripReleased : 0U;
}

}  // namespace palpate::contact
