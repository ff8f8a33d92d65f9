#include "core/contact/grasp.h"

#include <algorithm>

#include "core/contact/contact_constants.h"
#include "core/contact/state.h"

namespace palpate::contact {
namespace {

/// Whether a part grasps: a jaw, or any part of a tool without jaws.
bool holds(const ToolPoints& points, std::size_t part) noexcept {
  return !points.has_jaws || points.parts[part].joint.is_jaw;
}

/// Where a jaw meets the tissue: mean of its nearest points, weighted as in a contact patch, so that neither
/// mesh nor rounding decides between equally near points.
Vec3 jaw_contact_point(const PartPoints& points, DistanceCache& distances) noexcept {
  distances.find_nearest();
  const double nearest = distances.nearest().distance;
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (distances.raise_bound(i) >= nearest + kPatchBand) continue;
    const double distance = distances.query(i).distance;
    const double weight = points.area[i] * std::max(0.0, 1.0 - (distance - nearest) / kPatchBand);
    sum += weight * points.point(i);
    total += weight;
  }
  return distances.placed_S() * (total > 0.0 ? Vec3(sum / total) : points.point(distances.nearest_point()));
}

}  // namespace

/// @return true in the ticks in which the jaws close past kClosedBelow
bool Grasp::follow(double gripper) noexcept {
  if (gripper > kOpenAbove) {
    open_ = true;
    torn_off_ = false;
  }
  if (open_ && gripper < kClosedBelow) {
    open_ = false;
    closing_ = true;
  } else if (gripper >= last_gripper_) {
    closing_ = false;
  }
  last_gripper_ = gripper;
  return closing_;
}

/// Grasps at the rest surface point nearest to the middle of the jaws, if a jaw that has been outside is near
/// enough.
void Grasp::grasp(const World::Data& world, const ToolPoints& points, const Pose& tool_S,
                  std::span<PartState> parts) noexcept {
  Vec3 middle = Vec3::Zero();
  double nearest = kGraspReach;
  double count = 0.0;
  bool near = false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    DistanceCache& distances = parts[i].distances;
    if (!holds(points, i) || !parts[i].may_start_contacts) continue;
    middle += jaw_contact_point(points.parts[i], distances);
    count += 1.0;
    if (distances.nearest().distance > nearest) continue;
    near = true;
    nearest = distances.nearest().distance;
    tip_radius_ = points.parts[i].tip_radius[distances.nearest_point()];
  }
  if (!near) return;
  const geometry::NearestPoint found = world.surface.nearest(middle / count, -1);
  held_ = true;
  closing_ = false;
  anchor_ = {found.point, found.triangle};
  normal_ = world.surface.normal_at(anchor_);
  anchor_T_ = tool_S.inverse() * found.point;
  memory_ = {};
}

/// Updates stretch and force. @return false when the force is above the grip limit
bool Grasp::pull(const ToolTissue& tissue, const Pose& tool_S) noexcept {
  const TissueLaws& laws = tissue.laws;
  stretch_ = tool_S * anchor_T_ - anchor_.point;
  const double length = stretch_.norm();
  model::ContactResponse response;
  if (tissue.uniform()) {
    response = laws.pull.force_at(length);
    response.force *= tissue.size_factor;
  } else {
    const TissueAt::Force here = TissueAt(tissue, anchor_).force_at(laws.pull, length);
    response = here.uniform;
    response.force = here.normal;
  }
  Vec3 force = length > 0.0 ? Vec3(-(response.force / length) * stretch_) : Vec3(Vec3::Zero());
  if (laws.relaxation.count() > 0) {
    // Relax each component. Relaxation is linear in the force, and it stays passive for a force that is the
    // gradient of a convex energy of the stretch (relaxation.h).
    for (int k = 0; k < 3; ++k) {
      force[k] = laws.relaxation.next(memory_[static_cast<std::size_t>(k)], force[k]);
    }
    if (force.norm() > laws.grip_limit) return false;
  } else if (response.force > laws.grip_limit) {
    return false;
  }
  force_ = force;
  cutoff_layer_ = response.cutoff_layer;
  saturated_ = response.saturated;
  extrapolated_ = response.extrapolated;
  return true;
}

void Grasp::release() noexcept {
  held_ = false;
  released_force_ = force_;
  released_stretch_ = stretch_;
  fade_ = 1.0;
}

void Grasp::release_at_once() noexcept {
  Grasp empty;
  empty.open_ = open_;
  empty.last_gripper_ = last_gripper_;
  *this = empty;
}

void Grasp::change_relaxation(const model::Relaxation& now, const model::Relaxation& before) noexcept {
  for (model::RelaxationState& memory : memory_) now.convert_history(memory, before);
}

std::uint32_t Grasp::update(const World::Data& world, const ToolTissue& tissue, const ToolPoints& points,
                            double gripper, const Pose& tool_S, std::span<PartState> parts) noexcept {
  if (fade_ > 0.0) fade_ = std::max(0.0, fade_ - world.period / kLetGoFade);
  if (follow(gripper) && !held_ && !torn_off_) grasp(world, points, tool_S, parts);
  if (held_ && gripper > kOpenAbove) {
    release();
  } else if (held_ && !pull(tissue, tool_S)) {
    release();
    torn_off_ = true;
  }
  if (!held_) {
    force_ = fade_ * released_force_;
    stretch_ = fade_ * released_stretch_;
  }
  const double change = world.period / kPressFade;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    double& level = parts[i].press_level;
    const bool off = held_ && holds(points, i);
    level = off ? std::max(0.0, level - change) : std::min(1.0, level + change);
  }
  return torn_off_ ? kGripReleased : 0U;
}

}  // namespace palpate::contact
