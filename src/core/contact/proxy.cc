// The proxy c of a press contact: a point on the organ's rest surface that stays under the deepest part of
// the tool, and carries the force. The tool may be inside the tissue; the proxy never is.
//
//                tool \           n ^           /
//     tangent plane ---\-----------c----------/----    D: depth of the deepest tool point behind the plane
//                       \            \        /   |     n: normal, that of the averaged surface at c
//                        \____________p*_____/    v D   p*: centroid of the points within 0.2 mm of D
//
// The patch (D and p*) belongs to one position and normal of the proxy (contact_patch.cc). walk() moves c
// along the surface towards p*. The walk ends where p* is straight below c. In a tick:
//
//     find the patch
//     at most kWalkSteps times:
//         step towards p*, along the surface (OrganSurface::walk)
//         turn n towards the surface normal at the new c
//         find the patch again
//     turn n further, as far as the limit allows
//
// A step that is too long makes p* swing from side to side. So a step grows by half while it goes on in
// its direction, and is halved when it reverses. After a rest it starts again at an eighth of the motion
// since. One tick moves c by at most kWalkSpeed T plus the tool's own motion there, and turns n by at most
// this length over R_ref. So at an edge of the organ, or at a new deepest corner of the tool, the force
// turns over several ticks and not in one.
//
// The force follows from D, less the depth that is held back:
//
//     D - held back -> spring law -> relaxation -> + damping x speed -> normal force -> friction
//
// - The depth that is held back depends on the contact's phase (proxy.h).
// - The speed is that of the tool's material at the point of application, not dD/dt, which has the steps
//   of the walk. The damping grows with depth up to kDampingDepth, so that the first touch has no jump.
// - The point of application follows p* at a limited speed.

#include "core/contact/proxy.h"

#include <algorithm>
#include <cmath>

#include "core/base/portable_math.h"
#include "core/contact/contact_constants.h"
#include "core/contact/load_sharing.h"

namespace palpate::contact {
namespace {

/// Turns `normal` towards `goal` by at most `most` [rad]. @return the angle turned [rad]
double turn_towards(Vec3& normal, const Vec3& goal, double most) noexcept {
  const double cosine = std::clamp(normal.dot(goal), -1.0, 1.0);
  const Vec3 across = goal - cosine * normal;
  const double sine = across.norm();
  // For small angles the cosine has lost its digits; the sine is the angle.
  if (cosine > 0.0 && sine <= most) {
    normal = goal;
    return cosine > 0.99 ? sine : portable::acos(cosine);
  }
  // An acute angle is larger than its sine, above this by more than the rounding of acos, so acos is skipped.
  constexpr double kClear = 1e-3;
  if (!(cosine > 0.0 && sine > kClear)) {
    const double angle = portable::acos(cosine);
    if (angle <= most) {
      normal = goal;
      return cosine > 0.99 ? sine : angle;
    }
  }
  if (sine < 1e-9) return 0.0;  // opposite directions: no shortest turn
  const auto [s, c] = portable::sin_cos(most);
  normal = (c * normal + (s / sine) * across).normalized();
  return most;
}

}  // namespace

ContactPatch patch_in_S(const PartPoints& points, const RigidTransform& placed_S, const Vec3& point_S,
                        const Vec3& normal_S, double reference_radius, std::uint32_t guess) noexcept {
  ContactPatch patch = contact_patch_of(points, placed_S.inverse_transform(point_S),
                                        placed_S.inverse_rotate(normal_S), reference_radius, guess);
  patch.centroid = placed_S * patch.centroid;
  return patch;
}

Vec3 FrictionSpring::stretch(double period, const TissueLaws& laws, const Vec3& motion, const Vec3& normal,
                             double normal_force) noexcept {
  const double stiffness = laws.tangential_stiffness;
  const double cone = laws.friction * normal_force;
  slip_ += motion;
  slip_ -= slip_.dot(normal) * normal;
  if (laws.tangential_damping == 0.0) {
    const double longest = cone / stiffness;
    const double length = slip_.norm();
    if (length > longest) slip_ *= longest / length;
    return -stiffness * slip_;
  }
  const double damping = laws.tangential_damping / period;  // N/m
  const Vec3 change = motion - motion.dot(normal) * normal;
  const Vec3 before = slip_ - change;
  Vec3 force = stiffness * slip_ + damping * change;
  const double size = force.norm();
  if (size > cone) {
    force *= cone / size;
    slip_ = (force + damping * before) / (stiffness + damping);
  }
  return -force;
}

Proxy::Proxy(const SurfacePoint& at, const Vec3& normal, const ContactPatch& patch,
             const DistanceCache& distances, double period) noexcept
    : patch_(patch), application_point_(patch.centroid) {
  load_.at = at;
  load_.normal = normal;
  walk_.surface_normal = normal;
  walk_.step = distances.motion_at(at.point).norm();
  walk_.odometer = distances.odometer();
  hold_back(std::max(0.0, patch.depth - walk_.step), period);
}

/// From the proxy to the patch centroid, in the tangent plane [m].
Vec3 Proxy::tangential_offset() const noexcept {
  const Vec3 away = patch_.centroid - load_.at.point;
  return away - away.dot(load_.normal) * load_.normal;
}

void Proxy::walk(const OrganSurface& surface, const PartPoints& points, const DistanceCache& distances,
                 double reference_radius, double period) noexcept {
  const double own_motion = distances.motion_at(load_.at.point).norm();
  const double limit = kWalkSpeed * period + own_motion;
  double left = limit;
  double turn_left = limit / reference_radius;
  walk_.step = std::max(walk_.step, (distances.odometer() - walk_.odometer) / kRestartShare);
  const auto find_patch = [&] {
    patch_ = patch_in_S(points, distances.placed_S(), load_.at.point, load_.normal, reference_radius,
                        patch_.cluster);
  };
  find_patch();
  for (int k = 0; k < kWalkSteps && left > 0.0; ++k) {
    if (patch_.depth <= 0.0) break;
    const Vec3 away = tangential_offset();
    const double distance = away.norm();
    if (distance < kStillStep) break;
    const Vec3 direction = away / distance;
    walk_.step *= direction.dot(walk_.direction) < 0.0 ? 0.5 : 1.5;
    walk_.step = std::min(walk_.step, limit);
    if (walk_.step < kStillStep) break;
    const double length = std::min({walk_.step, distance, left});
    load_.at = surface.walk(load_.at, length * direction, load_.normal);
    walk_.direction = direction;
    walk_.odometer = distances.odometer();
    left -= length;
    walk_.surface_normal = surface.normal_at(load_.at);
    turn_left -= turn_towards(load_.normal, walk_.surface_normal, turn_left);
    find_patch();
  }
  const Vec3 before = load_.normal;
  const double turned = turn_towards(load_.normal, walk_.surface_normal, turn_left);
  walk_.step = std::max(walk_.step, turned * reference_radius / kRestartShare);
  if (load_.normal != before) find_patch();
}

bool Proxy::is_lost(double reference_radius, std::span<const Proxy> others) const noexcept {
  const double farthest = kLost * reference_radius;
  return std::any_of(others.begin(), others.end(), [&](const Proxy& other) {
    if (other.phase_ == ContactPhase::kMerged || !(other.patch_.depth > patch_.depth)) return false;
    const Vec3 away = tangential_offset();
    return away.squaredNorm() > farthest * farthest &&
           (other.load_.at.point - load_.at.point).dot(away) > 0.0;
  });
}

void Proxy::update_phases(double reference_radius, double period, std::span<Proxy> all) noexcept {
  using enum ContactPhase;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (Proxy& other : all.subspan(i + 1)) all[i].merge(other, reference_radius);
  }
  for (Proxy& one : all) {
    if (one.phase_ != kMerged) {
      const bool whole = one.held_back_.depth == 0.0 && one.load_.fade_weight == 1.0;
      one.phase_ = all.size() > 1 && one.is_lost(reference_radius, all) ? kLost
                   : whole                                              ? kPressing
                                                                        : kEntering;
    }
    one.fade(period);
  }
}

/// If two proxies are closer than R_ref/10, the shallower one becomes kMerged.
void Proxy::merge(Proxy& other, double reference_radius) noexcept {
  using enum ContactPhase;
  const double closest = reference_radius / 10.0;
  if (phase_ == kMerged || other.phase_ == kMerged) return;
  if ((load_.at.point - other.load_.at.point).squaredNorm() >= closest * closest) return;
  (depth_ >= other.depth_ ? other : *this).phase_ = kMerged;
  merge_histories(load_, other.load_);
}

/// Changes the fade weight as the phase says, and lets a stale proxy get no deeper.
void Proxy::fade(double period) noexcept {
  if (phase_ == ContactPhase::kPressing) return;
  const bool is_stale = phase_ != ContactPhase::kEntering;
  load_.fade_weight = std::min(1.0, load_.fade_weight + (is_stale ? -period : period) / kFade);
  const double deeper = patch_.depth - depth_;
  const double kept_back = std::max(0.0, held_back_.depth - held_back_.admitted);
  if (is_stale && deeper > kept_back) hold_back(deeper, period);
}

/// Holds `excess` [m] >= 0 of the depth back and admits it within kLetIn.
void Proxy::hold_back(double excess, double period) noexcept {
  held_back_.admitted = excess * period / kLetIn;
  held_back_.depth = excess + held_back_.admitted;  // press() admits a part in this tick already
}

/// The force applies at the patch centroid. When the centroid jumps, the point of application follows at a
/// limited speed.
void Proxy::follow_patch(const DistanceCache& distances, double period) noexcept {
  const Vec3 way = patch_.centroid - application_point_;
  const double surely = kTouchSpeed * period;
  const double squared = way.squaredNorm();
  if (squared > surely * surely) {
    const double share = (surely + distances.motion_at(application_point_).norm()) / std::sqrt(squared);
    if (share < 1.0) {
      application_point_ += share * way;
      return;
    }
  }
  application_point_ = patch_.centroid;
}

/// Elastic force of a tissue that is not uniform [N]; sets the lateral force. A Maxwell element whose force
/// has relaxed by v is as if it began at the depth D_v with dU/dD(D_v) = v. Its lateral force is that of U(D,
/// s) - U(D_v, s), so that the element never gives back more energy than was put in (relaxation.h).
double Proxy::press_at_place(const ToolTissue& tissue) noexcept {
  const model::SpringLaw& law = tissue.laws.press;
  const model::Relaxation& relaxation = tissue.laws.relaxation;
  const TissueAt place(tissue, load_.at);
  const TissueAt::Force now = place.force_at(law, depth_);
  response_ = now.uniform;
  Vec3 lateral = now.lateral_S;
  for (std::size_t i = 0; i < relaxation.count(); ++i) {
    const double relaxed = relaxation.relaxed_after(load_.memory, i, now.normal);
    lateral -= relaxation.share(i) * place.follow(law, relaxed, relaxed_depth_[i]);
  }
  force_.lateral = lateral - lateral.dot(load_.normal) * load_.normal;
  return now.normal;
}

void Proxy::press(const ToolTissue& tissue, const DistanceCache& distances, double level,
                  double period) noexcept {
  const TissueLaws& laws = tissue.laws;
  follow_patch(distances, period);
  held_back_.depth = std::max(0.0, held_back_.depth - held_back_.admitted);
  depth_ = std::max(0.0, patch_.depth - held_back_.depth);
  if (tissue.uniform()) response_ = laws.press.force_at(depth_);
  const double elastic = tissue.uniform() ? tissue.size_factor * response_.force : press_at_place(tissue);
  const double relaxed = laws.relaxation.count() == 0 ? elastic : laws.relaxation.next(load_.memory, elastic);
  // The rate of depth is the speed of the tool at the point of application: equal in the limit, without the
  // steps of the walk.
  const Vec3 motion = distances.motion_at(application_point_);
  const double speed = -motion.dot(load_.normal) / period;
  force_.normal = std::max(0.0, relaxed + laws.damping * speed * std::min(1.0, depth_ / kDampingDepth));
  force_.friction = spring_.stretch(period, laws, motion, load_.normal, force_.normal);
  load_.elastic_force = elastic * level;  // jaws that hold tissue do not press and take no share
}

}  // namespace palpate::contact
