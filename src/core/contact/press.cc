#include "core/contact/press.h"

#include <algorithm>
#include <cmath>

#include "core/base/portable_math.h"
#include "core/contact/sharing.h"

namespace palpate::contact {
namespace {

// The rules' own figures (model.md, section 4).
constexpr double kWalkSpeed = 0.05;    // m/s, that c may gain on the tool
constexpr double kTouchSpeed = 0.1;    // m/s, that the force's place may gain on the tool
constexpr double kStillStep = 0.1e-6;  // m, where the walk stops
constexpr int kWalkSteps = 3;          // a tick
constexpr double kRestartShare = 8.0;  // of the motion since it stopped is a walk's next step
constexpr double kLost = 0.1;        // of R_ref, that a contact is from its deepest place when it has lost it
constexpr double kLetIn = 50e-3;     // s, over which depth that was kept back comes to count
constexpr double kLeave = 100e-3;    // s, in which a contact that has merged or is lost goes
constexpr double kShallow = 0.5e-3;  // m, an inside point this deep may start a contact
constexpr double kDeepestSecond = 1e-3;     // m, D with which a part that has a contact may start another
constexpr double kDampingDepth = 1e-3;      // m, where the damping counts in full
constexpr double kDeepInside = -1e-3;       // m, a part that loses its last contact here is off until outside
constexpr int kMostEvaluations = 8;         // patches looked at for starts, a tick and part
constexpr std::uint32_t kPointsTried = 32;  // inside points looked at in turn, a tick and part

ContactPatch patch_in_S(const World::Data& world, const PartPoints& points, const PartState& part,
                        const Vec3& point_S, const Vec3& normal_S, std::uint32_t guess) noexcept {
  const RigidTransform& placed = part.distances.placed_S();
  ContactPatch patch = contact_patch_of(points, placed.bring_back(point_S), placed.turn_back(normal_S),
                                        world.tissue.contact.reference_radius, guess);
  patch.centroid = placed * patch.centroid;
  return patch;
}

/// Turns `normal` towards `goal` by at most `most` [rad]. @return the angle turned
double turn_towards(Vec3& normal, const Vec3& goal, double most) noexcept {
  const double cosine = std::clamp(normal.dot(goal), -1.0, 1.0);
  const Vec3 across = goal - cosine * normal;
  const double sine = across.norm();
  // Near 0 the cosine has lost its digits, and the sine is the angle.
  if (cosine > 0.0 && sine <= most) {
    normal = goal;
    return cosine > 0.99 ? sine : portable::acos(cosine);
  }
  // An acute angle is greater than its sine, from here on by more than acos rounds: no need to work it out.
  constexpr double kClear = 1e-3;
  if (!(cosine > 0.0 && sine > kClear)) {
    const double angle = portable::acos(cosine);
    if (angle <= most) {
      normal = goal;
      return cosine > 0.99 ? sine : angle;
    }
  }
  if (sine < 1e-9) return 0.0;  // turned right round: no way is nearer
  const auto [s, c] = portable::sin_cos(most);
  normal = (c * normal + (s / sine) * across).normalized();
  return most;
}

/// From a contact's place to the centroid of its patch, along the tangent plane [m].
Vec3 aside_of(const Contact& contact) noexcept {
  const Vec3 away = contact.patch.centroid - contact.at.point;
  return away - away.dot(contact.normal) * contact.normal;
}

/// Up to three steps along the surface towards the centroid of the patch; the normal turns along, so that a
/// step too far shows in the next one. Leaves the patch of where the contact ends.
void walk_contact(const World::Data& world, const PartPoints& points, const PartState& part,
                  Contact& contact) noexcept {
  const double own_motion = part.distances.motion_at(contact.at.point).norm();
  const double limit = kWalkSpeed * world.period + own_motion;
  const double reference_radius = world.tissue.contact.reference_radius;
  double left = limit;
  double turn_left = limit / reference_radius;
  contact.step = std::max(contact.step, (part.distances.odometer() - contact.walked) / kRestartShare);
  const auto find_patch = [&] {
    contact.patch = patch_in_S(world, points, part, contact.at.point, contact.normal, contact.patch.cluster);
  };
  find_patch();
  for (int k = 0; k < kWalkSteps && left > 0.0; ++k) {
    if (contact.patch.depth <= 0.0) break;
    const Vec3 away = aside_of(contact);
    const double distance = away.norm();
    if (distance < kStillStep) break;
    const Vec3 direction = away / distance;
    contact.step *= direction.dot(contact.last_direction) < 0.0 ? 0.5 : 1.5;
    contact.step = std::min(contact.step, limit);
    if (contact.step < kStillStep) break;
    const double length = std::min({contact.step, distance, left});
    contact.at = world.surface.walk(contact.at, length * direction, contact.normal);
    contact.last_direction = direction;
    contact.walked = part.distances.odometer();
    left -= length;
    contact.surface_normal = world.surface.normal_at(contact.at);
    turn_left -= turn_towards(contact.normal, contact.surface_normal, turn_left);
    find_patch();
  }
  const Vec3 before = contact.normal;
  const double turned = turn_towards(contact.normal, contact.surface_normal, turn_left);
  contact.step = std::max(contact.step, turned * reference_radius / kRestartShare);
  if (contact.normal != before) find_patch();
}

/// Depth, force along the normal with damping, and friction of a contact whose patch is known.
void compute_force(const World::Data& world, const TissueLaws& laws, const PartState& part,
                   Contact& contact) noexcept {
  contact.offset = std::max(0.0, contact.offset - contact.offset_step);
  const double depth = std::max(0.0, contact.patch.depth - contact.offset);
  contact.elastic_force = laws.press.force_at(depth).force;
  const double relaxed = laws.relaxation.count() == 0
                             ? contact.elastic_force
                             : laws.relaxation.next(contact.memory, contact.elastic_force);
  // The depth's rate is taken where the tool touches: the same in the limit, without the steps of the walk.
  const Vec3 motion = part.distances.motion_at(contact.touch);
  const double speed = -motion.dot(contact.normal) / world.period;
  contact.normal_force = std::max(0.0, relaxed + laws.damping * speed * std::min(1.0, depth / kDampingDepth));
  contact.depth = depth;

  compute_friction(world.period, laws, motion, contact);
}

/// Keeps `excess` [m] >= 0 of a contact's depth back this tick, and lets it in within kLetIn.
void hold_back(double period, double excess, Contact& contact) noexcept {
  contact.offset = excess;
  contact.offset_step = excess * period / kLetIn;
  contact.offset += contact.offset_step;  // this tick takes it off again
}

/// Whether a contact has lost its own deepest place and is on its way to a deeper contact of the part: there
/// it would press what that one presses already.
bool is_lost(double reference_radius, PartState& part, const Contact& contact) noexcept {
  const Vec3 away = aside_of(contact);
  const double farthest = kLost * reference_radius;
  if (away.squaredNorm() <= farthest * farthest) return false;
  return std::any_of(part.active().begin(), part.active().end(), [&](const Contact& other) {
    return !other.merged && other.patch.depth > contact.patch.depth &&
           (other.at.point - contact.at.point).dot(away) > 0.0;
  });
}

/// The force applies at the centroid of the patch; from one deepest place to another it goes at a limited
/// speed.
void follow_patch(double period, const PartState& part, Contact& contact) noexcept {
  const Vec3 way = contact.patch.centroid - contact.touch;
  const double surely = kTouchSpeed * period;
  const double squared = way.squaredNorm();
  if (squared > surely * surely) {
    const double share = (surely + part.distances.motion_at(contact.touch).norm()) / std::sqrt(squared);
    if (share < 1.0) {
      contact.touch += share * way;
      return;
    }
  }
  contact.touch = contact.patch.centroid;
}

void remove_contact(PartState& part, int index) noexcept {
  for (int i = index; i + 1 < part.contact_count; ++i) {
    const auto to = static_cast<std::size_t>(i);
    part.contacts[to] = part.contacts[to + 1];
  }
  --part.contact_count;
}

/// Contacts closer than R_ref/10 become one: the stronger stays, the other leaves. So does one that is lost,
/// unless it finds a deepest place on the way out. All within kLeave, so that what they and their neighbours
/// share does not jump.
void merge_contacts(double reference_radius, double period, PartState& part) noexcept {
  const double closest = reference_radius / 10.0;
  for (int i = 0; i < part.contact_count; ++i) {
    for (int j = i + 1; j < part.contact_count; ++j) {
      Contact& a = part.contacts[static_cast<std::size_t>(i)];
      Contact& b = part.contacts[static_cast<std::size_t>(j)];
      if (a.merged || b.merged) continue;
      if ((a.at.point - b.at.point).squaredNorm() >= closest * closest) continue;
      (a.depth >= b.depth ? b : a).merged = true;
      share_memory(a, b);
    }
  }
  for (Contact& contact : part.active()) {
    const bool leaves = contact.merged || is_lost(reference_radius, part, contact);
    contact.presence = std::min(1.0, contact.presence + (leaves ? -period : period) / kLeave);
    // What leaves presses no deeper on its way to where another presses already.
    const double deeper = contact.patch.depth - contact.depth;
    const double kept_back = std::max(0.0, contact.offset - contact.offset_step);
    if (leaves && deeper > kept_back) hold_back(period, deeper, contact);
  }
  for (int i = 0; i < part.contact_count;) {
    Contact& contact = part.contacts[static_cast<std::size_t>(i)];
    if (contact.presence > 0.0) {
      ++i;
    } else {
      remove_contact(part, i);
    }
  }
}

bool near_a_contact(double reference_radius, PartState& part, const Vec3& point) noexcept {
  return std::any_of(part.active().begin(), part.active().end(), [&](const Contact& contact) {
    return (contact.at.point - point).squaredNorm() <= reference_radius * reference_radius;
  });
}

std::size_t point_nearest_to(const PartPoints& points, const Vec3& wanted) noexcept {
  std::size_t best = 0;
  double best_squared = (points.point(0) - wanted).squaredNorm();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double squared = (points.point(i) - wanted).squaredNorm();
    if (squared < best_squared) {
      best_squared = squared;
      best = i;
    }
  }
  return best;
}

/// Starting contacts of one part, with a bound on the patches looked at.
class Starter final {
 public:
  Starter(const World::Data& world, const PartPoints& points, PartState& part) noexcept
      : world_(world), points_(points), part_(part) {}

  void try_entries() noexcept {
    for (const EntryEvent& entry : part_.distances.entries()) try_at(entry.point, entry.at, 2);
  }

  /// Points that are inside but not deep, a few a tick, in turn.
  void try_shallow_points() noexcept {
    const auto count = static_cast<std::uint32_t>(points_.size());
    std::uint32_t left = std::min(kPointsTried, count);
    while (left > 0 && evaluations_ < kMostEvaluations) {
      const std::uint32_t first = part_.cursor + 1 < count ? part_.cursor + 1 : 0;
      const std::uint32_t end = std::min(count, first + left);
      const std::uint32_t i = part_.distances.next_inside(first, end);
      part_.cursor = std::min(i, end - 1);
      left -= part_.cursor + 1 - first;
      if (i < end) try_shallow_point(i);
    }
  }

  [[nodiscard]] std::uint32_t status() const noexcept { return status_; }

 private:
  [[nodiscard]] double radius() const noexcept { return world_.tissue.contact.reference_radius; }

  void try_shallow_point(std::uint32_t i) noexcept {
    DistanceCache& distances = part_.distances;
    if (distances.greatest(i) < -kShallow || near_a_contact(radius(), part_, distances.point_S(i))) return;
    const geometry::NearestPoint nearest = distances.ask(i);
    if (nearest.distance >= kInside || nearest.distance < -kShallow) return;
    try_at(i, {nearest.point, nearest.triangle}, 0);
  }

  /// Starts a contact at `at` if the point is the deepest of its own patch; else looks where that is.
  void try_at(std::size_t point, const SurfacePoint& at, int redirections) noexcept {
    if (near_a_contact(radius(), part_, at.point) || evaluations_ >= kMostEvaluations) return;
    if (part_.contact_count == kContactsPerPart) {
      status_ |= kContactsFull;
      return;
    }
    ++evaluations_;
    const Vec3 normal = world_.surface.normal_at(at);
    const ContactPatch patch = patch_in_S(world_, points_, part_, at.point, normal, 0);
    if (patch.depth <= 0.0 || (part_.contact_count > 0 && patch.depth > kDeepestSecond)) return;
    const Vec3 here = part_.distances.point_S(point);
    if ((patch.centroid - here).norm() > radius() / 5.0) {
      if (redirections == 0) return;
      const std::size_t deepest =
          point_nearest_to(points_, part_.distances.placed_S().bring_back(patch.centroid));
      const geometry::NearestPoint nearest = part_.distances.ask(deepest);
      if (nearest.distance < kInside) try_at(deepest, {nearest.point, nearest.triangle}, redirections - 1);
      return;
    }
    Contact contact;
    contact.at = at;
    contact.surface_normal = normal;
    contact.normal = normal;
    contact.patch = patch;
    contact.touch = patch.centroid;
    if (is_lost(radius(), part_, contact)) return;
    const double own_motion = part_.distances.motion_at(at.point).norm();
    contact.step = own_motion;
    contact.walked = part_.distances.odometer();
    hold_back(world_.period, std::max(0.0, patch.depth - own_motion), contact);
    part_.contacts[static_cast<std::size_t>(part_.contact_count++)] = contact;
  }

  const World::Data& world_;
  const PartPoints& points_;
  PartState& part_;
  int evaluations_ = 0;
  std::uint32_t status_ = 0;
};

}  // namespace

void compute_friction(double period, const TissueLaws& laws, const Vec3& motion, Contact& contact) noexcept {
  const double stiffness = laws.tangential_stiffness;
  const double cone = laws.friction * contact.normal_force;
  contact.slip += motion;
  contact.slip -= contact.slip.dot(contact.normal) * contact.normal;
  if (laws.tangential_damping == 0.0) {
    const double longest = cone / stiffness;
    const double length = contact.slip.norm();
    if (length > longest) contact.slip *= longest / length;
    contact.friction = -stiffness * contact.slip;
    return;
  }
  const double damping = laws.tangential_damping / period;  // N/m
  const Vec3 change = motion - motion.dot(contact.normal) * contact.normal;
  const Vec3 before = contact.slip - change;
  Vec3 force = stiffness * contact.slip + damping * change;
  const double size = force.norm();
  if (size > cone) {
    force *= cone / size;
    contact.slip = (force + damping * before) / (stiffness + damping);
  }
  contact.friction = -force;
}

std::uint32_t update_press(const World::Data& world, const TissueLaws& laws, const PartPoints& points,
                           PartState& part) noexcept {
  const int before = part.contact_count;
  for (int i = 0; i < part.contact_count;) {
    Contact& contact = part.contacts[static_cast<std::size_t>(i)];
    walk_contact(world, points, part, contact);
    if (contact.patch.depth > 0.0) {
      ++i;
    } else {
      remove_contact(part, i);
    }
  }
  merge_contacts(world.tissue.contact.reference_radius, world.period, part);
  if (before > 0 && part.contact_count == 0) {
    part.distances.find_nearest();
    if (part.distances.nearest().distance < kDeepInside) part.armed = false;
  }

  std::uint32_t status = 0;
  if (part.armed) {
    Starter starter(world, points, part);
    starter.try_entries();
    if (part.distances.inside_count() > 0) starter.try_shallow_points();
    status = starter.status();
  } else {
    status = kStartedInside;
  }
  for (Contact& contact : part.active()) {
    follow_patch(world.period, part, contact);
    compute_force(world, laws, part, contact);
    contact.elastic_force *= part.press_level;  // jaws that hold press nothing, and take no share from others
  }
  return status;
}

}  // namespace palpate::contact
