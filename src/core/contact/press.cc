// The press contacts of one rigid part, up to four at a time. Each contact is a proxy (proxy.cc). Two
// contacts may press one edge or one concave organ from two sides. They must not press the same tissue
// twice. The phases of a contact are in proxy.h.
//
// update_press() does the steps of one tick in this order:
//
// 1. Every proxy walks. A contact whose patch has no depth ends.
// 2. Proxy::update_phases() merges contacts, finds lost ones and fades both. A contact whose fade weight is
//    0 ends.
// 3. If this ended the last contact, and a point is deeper than 1 mm inside, the surface above the tool is
//    unknown. The part then starts no contact until it has been outside.
// 4. New contacts start, first at points that entered in this tick, at the place of entry. Then some of
//    the points that are at most 0.5 mm inside are tried, in turn, a few in each tick: they find a second
//    contact that grows under a part that already touches.
// 5. Every contact computes its force. Load sharing between all contacts of all tools follows in
//    contact.cc.
//
// A contact starts only where it is needed: farther than R_ref from the part's other contacts, near the
// centroid of its own patch, and not lost from the beginning. A point that is not near its centroid passes
// the attempt on to the tool point at the centroid, at most twice. If the part has a contact, the new one
// may be at most 1 mm deep. The number of patches evaluated in a tick is bounded, which bounds its time.

#include "core/contact/press.h"

#include <algorithm>

#include "core/contact/contact_constants.h"

namespace palpate::contact {
namespace {

void remove_ended(PartState& part) noexcept {
  const std::span<Proxy> all = part.active();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].has_ended()) continue;  // usual; std::remove_if alone would cost 30 instructions more
    const auto ended = [](const Proxy& one) { return one.has_ended(); };
    part.contact_count = static_cast<int>(std::remove_if(all.begin(), all.end(), ended) - all.begin());
    return;
  }
}

bool near_a_contact(double reference_radius, PartState& part, const Vec3& point) noexcept {
  return std::any_of(part.active().begin(), part.active().end(), [&](const Proxy& contact) {
    return (contact.load().at.point - point).squaredNorm() <= reference_radius * reference_radius;
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

/// Starts contacts of one part, with a limit on the patches evaluated per tick.
class ContactStarter final {
 public:
  ContactStarter(const World::Data& world, const PartPoints& points, PartState& part) noexcept
      : world_(world), points_(points), part_(part) {}

  void try_entries() noexcept {
    for (const EntryEvent& entry : part_.distances.entries()) try_at(entry.point, entry.at, 2);
  }

  /// Tries shallow inside points, kPointsTried per tick, in turn.
  void try_shallow_points() noexcept {
    const auto count = static_cast<std::uint32_t>(points_.size());
    std::uint32_t left = std::min(kPointsTried, count);
    while (left > 0 && evaluations_ < kMaxEvaluations) {
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
    if (distances.upper_bound(i) < -kShallow || near_a_contact(radius(), part_, distances.point_S(i))) return;
    const geometry::NearestPoint nearest = distances.query(i);
    if (nearest.distance >= kInside || nearest.distance < -kShallow) return;
    try_at(i, {nearest.point, nearest.triangle}, 0);
  }

  /// Starts a contact at `at` if the point is near the centroid of its own patch; otherwise tries the point
  /// at that centroid.
  void try_at(std::size_t point, const SurfacePoint& at, int redirections) noexcept {
    if (near_a_contact(radius(), part_, at.point) || evaluations_ >= kMaxEvaluations) return;
    if (part_.contact_count == kContactsPerPart) {
      status_ |= kContactsFull;
      return;
    }
    ++evaluations_;
    const Vec3 normal = world_.surface.normal_at(at);
    const ContactPatch patch = patch_in_S(points_, part_.distances.placed_S(), at.point, normal, radius(), 0);
    if (patch.depth <= 0.0 || (part_.contact_count > 0 && patch.depth > kDeepestSecond)) return;
    const Vec3 here = part_.distances.point_S(point);
    if ((patch.centroid - here).norm() > radius() / 5.0) {
      if (redirections == 0) return;
      const std::size_t deepest =
          point_nearest_to(points_, part_.distances.placed_S().inverse_transform(patch.centroid));
      const geometry::NearestPoint nearest = part_.distances.query(deepest);
      if (nearest.distance < kInside) {
        try_at(deepest, {nearest.point, nearest.triangle}, redirections - 1);
      } else if (const auto entry = part_.distances.entry_of(deepest)) {  // it passed through
        try_at(deepest, *entry, redirections - 1);
      }
      return;
    }
    const Proxy contact(at, normal, patch, part_.distances, world_.period);
    if (contact.is_lost(radius(), part_.active())) return;
    part_.contacts[static_cast<std::size_t>(part_.contact_count++)] = contact;
  }

  const World::Data& world_;
  const PartPoints& points_;
  PartState& part_;
  int evaluations_ = 0;
  std::uint32_t status_ = 0;
};

}  // namespace

std::uint32_t update_press(const World::Data& world, const ToolTissue& tissue, const PartPoints& points,
                           PartState& part) noexcept {
  const double reference_radius = world.tissue.contact.reference_radius;
  const int before = part.contact_count;
  for (Proxy& contact : part.active()) {
    contact.walk(world.surface, points, part.distances, reference_radius, world.period);
  }
  if (before > 0) {
    remove_ended(part);
    Proxy::update_phases(reference_radius, world.period, part.active());
    remove_ended(part);
  }
  if (before > 0 && part.contact_count == 0) {
    part.distances.find_nearest(kDeepInside);
    if (part.distances.nearest().distance < kDeepInside) part.may_start_contacts = false;
  }

  std::uint32_t status = 0;
  if (part.may_start_contacts) {
    ContactStarter starter(world, points, part);
    starter.try_entries();
    if (part.distances.inside_count() > 0) starter.try_shallow_points();
    status = starter.status();
  } else {
    status = kStartedInside;
  }
  for (Proxy& contact : part.active()) contact.press(tissue, part.distances, part.press_level, world.period);
  return status;
}

}  // namespace palpate::contact
