// Which points of a rigid part are inside the organ? A tick may not query all of its up to 2,000 points.
// It need not: when no point of the part moves by more than m, no signed distance changes by more than m.
// So a point that was d from the surface, when the odometer read o, cannot cross before the odometer reads
// o + |d| (conservative advancement).
//
//     surface          bound at odometer x        point, when it was queried at odometer o
//        |<----- d - (x - o) ----->|<----- x - o ----->|
//        |-------------------------+-------------------o
//
// The odometer is the sum, over the ticks, of a bound of the largest motion of any point relative to the
// organ (largest_motion). move() asks at three levels, each only where the level above leaves a doubt:
//
//     part       next_crossing_: until the odometer reaches it, a tick queries nothing
//     cluster    up to 32 neighbouring points: `crossing` is the least o + |d| of them
//     point      may_have_crossed(): |d| <= x - o
//
// When many points of a cluster are in doubt, the distance of the cluster's centre is queried first. Less
// each point's offset from the centre, it often settles their sides at the cost of one query. An outside
// point first asks for a clearance, a lower bound of its distance. If the clearance spheres of then and
// now overlap, and the new one contains the motion of this tick, the point has stayed outside. Only then
// is its distance queried.
//
// A point that went in becomes an entry. The entry is where the straight path of this tick first crosses
// the surface. A point that is outside before and after may still have passed through a thin organ. Its
// path is tested when it is long enough to reach the surface and return.
//
// The clearance sphere bounds distances without the odometer. It rests in the organ's frame, behind the
// tool, and no surface is inside. A point in it is outside the organ, by at least its depth in the sphere:
//
//      |            + centre            |
//       \                              /     In front of the organ the sphere is almost flat. So the
//        \         o  o  o  tool       /      depth is close to the distance, and stays so as the tool
//         \__       o  o           __/       moves. A bound by the odometer shrinks with each motion.
//            \_______o____________/          It excludes points that are almost as near as the nearest
//     ____________________________________   one only for a few ticks.
//     organ
//
// Three cases need more:
// - Next to a proxy no point may start a contact. Clusters that lie wholly within reach of a proxy are
//   deferred: their points are not queried. When the proxy has moved away, resolve() finds the sides
//   again, without entries.
// - A part that jumps, or has its first pose, has no path. reset() finds all sides, without entries. The
//   clearance sphere around one cluster often contains the next ones.
// - find_nearest() needs an exact distance. It queries the point that was nearest in its last search, and
//   then only points whose lower bound is below the least distance found so far. If these are several, it
//   first places the clearance sphere anew.
//
// The margins kInside and kBoundSlack cover rounding. The results equal those of querying every point.

#include "core/contact/distance_cache.h"

#include <algorithm>

#include "palpate/tool_contact.h"

namespace palpate::contact {
DistanceCache::DistanceCache(const OrganSurface& surface, const PartPoints& points)
    : surface_(&surface),
      points_(&points),
      bounds_(points.clusters.size()),
      cached_(points.size()),
      inside_(points.size(), 0) {}

/// Upper bound of any point's motion since the last tick: motion of the box's middle plus, per axis, half the
/// size times the change of direction.
double DistanceCache::largest_motion() const noexcept {
  const Mat3 turned = placed_S_.rotation - previous_S_.rotation;
  const Vec3 moved = placed_S_.position - previous_S_.position;
  double motion = (turned * points_->box_middle + moved).norm();
  for (int axis = 0; axis < 3; ++axis) motion += points_->box_reach[axis] * turned.col(axis).norm();
  return motion;
}

/// Moves the part. @return false when it jumped; then it has also found the sides of all points
bool DistanceCache::place(const Pose& pose_S, double period) noexcept {
  previous_S_ = placed_S_;
  placed_S_ = {pose_S.rotation.toRotationMatrix(), pose_S.position};
  if (!placed_) previous_S_ = placed_S_;
  motion_ = largest_motion();
  odometer_ += motion_;
  entry_count_ = 0;
  const bool jumped = !placed_ || motion_ > kFastestHand * period;
  placed_ = true;
  if (jumped) {
    previous_S_ = placed_S_;
    motion_ = 0.0;
    reset();
  }
  return !jumped;
}

bool DistanceCache::move(const Pose& pose_S, double period, std::span<const Vec3> contacts_S,
                         double reference_radius) noexcept {
  if (!place(pose_S, period)) return false;
  if (!sides_known_) {
    reset();
    return true;
  }
  // In one tick a proxy moves by at most the tool's motion there plus the drift.
  find_crossings(contacts_S, reference_radius - 3.0 * motion_ - kContactDrift * period);
  return true;
}

bool DistanceCache::move_inserted(const Pose& pose_S, double period) noexcept {
  if (!place(pose_S, period)) return false;
  sides_known_ = false;
  return true;
}

void DistanceCache::set_inside(std::size_t point, double distance) noexcept {
  const bool now = distance < kInside;
  inside_count_ += (now ? 1U : 0U) - inside_[point];
  inside_[point] = now ? 1 : 0;
}

/// Caches the distance of another point `way` [m] away. The true distance differs by at most `way`; the side
/// is that point's, or may_have_crossed() is true.
void DistanceCache::cache_from(std::size_t point, const geometry::NearestPoint& nearest,
                               double way) noexcept {
  set_inside(point, nearest.distance);
  cached_[point] = {nearest.distance, odometer_ - way - kBoundSlack, nearest.triangle};
}

/// Whether the clearance sphere contains a whole cluster of outside points. If so, caches bounds.
bool DistanceCache::settle_by_sphere(std::size_t c) noexcept {
  const PartPoints::Cluster& cluster = points_->clusters[c];
  const double clear = sphere_.radius - (placed_S_ * cluster.centre - sphere_.centre_S).norm();
  if (!(clear > cluster.radius + kBoundSlack)) return false;
  for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
    cached_[i].distance = clear;
    cached_[i].odometer = odometer_ - points_->offset[i] - kBoundSlack;
  }
  const double least = odometer_ + clear - cluster.radius - kBoundSlack;
  bounds_[c] = {least, least, false};
  return true;
}

/// Finds the sides of a cluster's points without using cached distances. @return distance of its centre [m]
double DistanceCache::resolve(std::size_t c) noexcept {
  const PartPoints::Cluster& cluster = points_->clusters[c];
  const geometry::NearestPoint centre =
      surface_->nearest(placed_S_ * cluster.centre, cached_[cluster.begin].triangle);
  for (std::size_t i = cluster.begin; i < cluster.end; ++i) cache_from(i, centre, points_->offset[i]);
  for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
    if (!may_have_crossed(i)) continue;
    const geometry::NearestPoint asked = query(i);
    for (std::size_t j = i + 1; j < cluster.end; ++j) {
      if (may_have_crossed(j)) cache_from(j, asked, (points_->point(j) - points_->point(i)).norm());
    }
  }
  bound_cluster(c);
  return centre.distance;
}

/// The sphere around a cluster's centre often contains the next clusters, which then need no query.
void DistanceCache::reset() noexcept {
  std::fill(inside_.begin(), inside_.end(), std::uint8_t{0});
  inside_count_ = 0;
  std::size_t nearest = 0;
  for (std::size_t c = 0; c < bounds_.size(); ++c) {
    if (!settle_by_sphere(c)) sphere_ = {placed_S_ * points_->clusters[c].centre, resolve(c)};
    if (bounds_[c].least < bounds_[nearest].least) nearest = c;
  }
  next_crossing_ = odometer_;
  nearest_point_ = points_->clusters[nearest].begin;
  sides_known_ = true;
}

/// Places the clearance sphere behind the nearest point, away from the organ.
void DistanceCache::renew_sphere() noexcept {
  const Vec3 point = point_S(nearest_point_);
  const Vec3 behind = point + (kSphereBehind / nearest_.distance) * (point - nearest_.point);
  sphere_ = {behind, surface_->nearest(behind, nearest_.triangle).distance};
}

double DistanceCache::raise_bound(std::size_t i) noexcept {
  const double bound = lower_bound(i);
  if (is_inside(i)) return bound;
  const double least = sphere_bound(i);
  if (!(least > std::max(0.0, bound))) return bound;
  cached_[i].distance = least;
  cached_[i].odometer = odometer_;
  return least;
}

void DistanceCache::bound_cluster(std::size_t c) noexcept {
  double crossing = std::numeric_limits<double>::infinity();
  double least = crossing;
  const auto first = cached_.begin() + points_->clusters[c].begin;
  const auto end = cached_.begin() + points_->clusters[c].end;
  for (auto cached = first; cached != end; ++cached) {
    crossing = std::min(crossing, cached->odometer + std::abs(cached->distance - kInside));
    least = std::min(least, cached->odometer + cached->distance);
  }
  bounds_[c] = {crossing, least, false};
}

geometry::NearestPoint DistanceCache::query(std::size_t point) noexcept {
  Cached& cached = cached_[point];
  geometry::NearestPoint found = surface_->nearest(point_S(point), cached.triangle);
  set_inside(point, found.distance);
  cached = {found.distance, odometer_, found.triangle};
  return found;
}

/// Queries the cluster's centre. The result replaces a point's cached distance where it proves that the point
/// is on the same side and farther from the surface than this tick's motion.
void DistanceCache::query_centre(std::size_t c) noexcept {
  const PartPoints::Cluster& cluster = points_->clusters[c];
  const geometry::NearestPoint centre =
      surface_->nearest(placed_S_ * cluster.centre, cached_[cluster.begin].triangle);
  for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
    Cached& cached = cached_[i];
    const double offset = points_->offset[i] + kBoundSlack;
    const double clear = (is_inside(i) ? -centre.distance : centre.distance) - offset;
    const double known = is_inside(i) ? -upper_bound(i) : lower_bound(i);
    if (clear + kInside <= motion_ || clear <= known) continue;
    cached = {centre.distance, odometer_ - offset, centre.triangle};
  }
}

/// Whether a clearance proves that a point has stayed outside since its last query. It is in the clearance
/// sphere by more than this tick's motion, or spheres around the point then and now overlap, and the new one
/// contains this tick's motion. If so, caches the new clearance.
bool DistanceCache::stays_outside(std::size_t i) noexcept {
  Cached& cached = cached_[i];
  if (cached.distance <= 0.0) return false;
  if (!is_inside(i) && sphere_bound(i) + kInside > motion_) {
    raise_bound(i);
    return true;
  }
  const geometry::Clearance clear = surface_->clearance(point_S(i), cached.triangle);
  cached.triangle = clear.triangle;
  const double least_here = clear.least + kInside;
  if (least_here <= motion_ || cached.distance + least_here <= odometer_ - cached.odometer) return false;
  cached.distance = clear.least;
  cached.odometer = odometer_;
  return true;
}

/// Queries a point that may have crossed the surface. Records an entry when it went in, or in and out again,
/// during this tick.
void DistanceCache::query_crossed(std::size_t i) noexcept {
  if (stays_outside(i)) return;
  const bool was_inside = is_inside(i);
  const double before = lower_bound(i) + motion_;  // lower bound of its distance a tick ago
  const geometry::NearestPoint now = query(i);
  if (was_inside || entry_count_ == kMaxEntries) return;
  const bool went_in = now.distance < kInside;
  // Outside before and after: it can have been inside only if the path is long enough to reach the surface
  // and return.
  const double way_in = std::max(0.0, before - kInside) + now.distance - kInside;
  if (!went_in && way_in > (point_S(i) - previous_S_ * points_->point(i)).norm()) return;
  if (const auto entry = entry_of(i)) {
    entries_[entry_count_++] = {static_cast<std::uint32_t>(i), *entry};
  } else if (went_in) {
    entries_[entry_count_++] = {static_cast<std::uint32_t>(i), {now.point, now.triangle}};
  }
}

std::optional<SurfacePoint> DistanceCache::entry_of(std::size_t point) const noexcept {
  const auto entry = surface_->first_entry(previous_S_ * points_->point(point), point_S(point));
  if (!entry) return std::nullopt;
  return SurfacePoint{entry->point, entry->triangle};
}

/// Queries the points of a cluster that may have crossed the surface.
void DistanceCache::query_cluster(std::size_t c) noexcept {
  std::array<std::uint32_t, PartPoints::kClusterSize> crossed;
  std::size_t count = 0;
  for (std::uint32_t i = points_->clusters[c].begin; i < points_->clusters[c].end; ++i) {
    if (may_have_crossed(i)) crossed[count++] = i;
  }
  if (count > kFewPoints) query_centre(c);
  for (std::size_t k = 0; k < count; ++k) {
    if (may_have_crossed(crossed[k])) query_crossed(crossed[k]);
  }
  bound_cluster(c);
}

namespace {

/// Whether a point is within `reach` [m] of a centre. A loop: g++ 12 makes seven copies of std::any_of's
/// test.
bool any_within(std::span<const Vec3> points, const Vec3& centre, double reach) noexcept {
  for (const Vec3& point : points) {
    if ((point - centre).squaredNorm() <= reach * reach) return true;
  }
  return false;
}

}  // namespace

void DistanceCache::find_crossings(std::span<const Vec3> contacts_S, double reach) noexcept {
  const double now = odometer_ + kBoundSlack;
  if (next_crossing_ > now) return;
  std::array<Vec3, kContactsPerPart> contacts_P;
  std::transform(contacts_S.begin(), contacts_S.end(), contacts_P.begin(),
                 [this](const Vec3& at_S) { return placed_S_.inverse_transform(at_S); });
  double next = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < bounds_.size(); ++c) {
    ClusterBound& bound = bounds_[c];
    if (bound.crossing > now) {
      next = std::min(next, bound.crossing);
      continue;
    }
    const PartPoints::Cluster& cluster = points_->clusters[c];
    const double nearest = reach - cluster.radius;
    if (nearest > 0.0 &&
        any_within(std::span(contacts_P).first(contacts_S.size()), cluster.centre, nearest)) {
      bound.deferred = true;
      next = odometer_;
      continue;
    }
    if (bound.deferred) {
      resolve(c);  // crossings while it was deferred start no contact
    } else {
      query_cluster(c);
    }
    next = std::min(next, bound.crossing);
  }
  next_crossing_ = next;
}

/// Number of a cluster's points that may be nearer than `wanted` [m].
std::size_t DistanceCache::count_nearer(std::size_t c, double wanted) noexcept {
  std::size_t count = 0;
  for (std::size_t i = points_->clusters[c].begin; i < points_->clusters[c].end; ++i) {
    if (lower_bound(i) < wanted && raise_bound(i) < wanted) ++count;
  }
  return count;
}

void DistanceCache::find_nearest(double enough) noexcept {
  if (!sides_known_) reset();
  for (std::size_t c = 0; c < bounds_.size(); ++c) {
    if (bounds_[c].deferred) resolve(c);
  }
  nearest_.distance = std::numeric_limits<double>::infinity();
  if (raise_bound(nearest_point_) < enough) query_nearer(nearest_point_);
  const auto wanted = [this, enough] { return std::min(nearest_.distance, enough); };
  bool renewed = false;
  for (std::size_t c = 0; c < bounds_.size(); ++c) {
    if (is_out_of_reach(c, wanted())) continue;
    std::size_t nearer = count_nearer(c, wanted());
    if (nearer > kFewNearer && !renewed && nearest_.distance > kTouching &&
        std::isfinite(nearest_.distance)) {
      renewed = true;
      renew_sphere();
      query_likeliest(enough);
      nearer = count_nearer(c, wanted());
    }
    if (nearer > kFewPoints) query_centre(c);
    const PartPoints::Cluster& cluster = points_->clusters[c];
    for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
      if (lower_bound(i) < wanted()) query_nearer(i);
    }
    bound_cluster(c);
  }
}

/// Queries a point. It becomes the nearest one if it is nearer.
void DistanceCache::query_nearer(std::size_t i) noexcept {
  const geometry::NearestPoint found = query(i);
  if (found.distance >= nearest_.distance) return;
  nearest_point_ = static_cast<std::uint32_t>(i);
  nearest_ = found;
}

/// Queries the point with the least bound, so that few others remain in doubt.
void DistanceCache::query_likeliest(double enough) noexcept {
  double least = std::min(nearest_.distance, enough);
  std::size_t likeliest = cached_.size();
  for (std::size_t c = 0; c < bounds_.size(); ++c) {
    if (is_out_of_reach(c, least)) continue;
    for (std::size_t i = points_->clusters[c].begin; i < points_->clusters[c].end; ++i) {
      if (lower_bound(i) >= least) continue;
      const double bound = raise_bound(i);
      if (bound >= least) continue;
      least = bound;
      likeliest = i;
    }
  }
  if (likeliest < cached_.size()) query_nearer(likeliest);
}

}  // namespace palpate::contact
