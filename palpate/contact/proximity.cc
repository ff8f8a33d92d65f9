#include "palpate/contact/proximity.h"

#include <algorithm>
#include <cmath>

namespace palpate::contact {
namespace {

constexpr double kOutside = -1e-6;  // m: a part that just touches counts as outside

/// The most that any point of the part moves between two poses: reached at a corner of its box, since the
/// motion is affine and its norm convex.
double greatest_motion(const PartPoints& points, const Pose& from, const Pose& to) noexcept {
  double squared = 0.0;
  for (const Vec3& corner : points.corners)
    squared = std::max(squared, (to * corner - from * corner).squaredNorm());
  return std::sqrt(squared);
}

/// Knows nothing of the points any more but what the middles of their clusters tell: distance changes by no
/// more than the way between.
void forget(const OrganSurface& surface, const PartPoints& points, PartState& part) noexcept {
  std::int32_t guess = -1;
  part.nearest_point = 0;
  for (const PartPoints::Cluster& cluster : points.clusters) {
    const geometry::NearestPoint middle = surface.nearest(part.pose_S * cluster.centre, guess);
    guess = middle.triangle;
    for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
      part.known[i] = middle.distance;
      part.since[i] = part.travelled - (points.point(i) - cluster.centre).norm();
      part.nearest_triangle[i] = middle.triangle;
      part.inside[i] = middle.distance < kInside ? 1 : 0;
      const bool nearer = least_distance(part, i) < least_distance(part, part.nearest_point);
      if (nearer) part.nearest_point = static_cast<std::uint32_t>(i);  // the one to ask first
    }
  }
}

void add_entry(PartState& part, std::size_t point, const SurfacePoint& at) noexcept {
  if (part.entry_count == PartState::kMostEntries) return;  // so many points at once: any of them will do
  part.entries[part.entry_count++] = {static_cast<std::uint32_t>(point), at};
}

/// Asks one point, and notes an entry when it went in, or in and out again, during this tick.
geometry::NearestPoint update_point(const OrganSurface& surface, const PartPoints& points, std::size_t i,
                                    bool placed_anew, PartState& part) noexcept {
  const bool was_inside = part.inside[i] != 0;
  const double before = least_distance(part, i) + part.motion;  // at least this far outside a tick ago
  geometry::NearestPoint now = ask_distance(surface, points, i, part);
  if (placed_anew || was_inside) return now;
  const bool went_in = now.distance < kInside;
  const Vec3 end = part.pose_S * points.point(i);
  const Vec3 start = part.previous_S * points.point(i);
  // Out and out again: in between it was in only if the way is long enough.
  const double way_in = std::max(0.0, before - kInside) + now.distance - kInside;
  if (!went_in && way_in > (end - start).norm()) return now;
  if (const auto entry = surface.first_entry(start, end)) {
    add_entry(part, i, {entry->point, entry->triangle});
  } else if (went_in) {
    add_entry(part, i, {now.point, now.triangle});
  }
  return now;
}

void scan_points(const OrganSurface& surface, const PartPoints& points, bool placed_anew,
                 PartState& part) noexcept {
  const std::size_t last_nearest = part.nearest_point;
  part.nearest = update_point(surface, points, last_nearest, placed_anew, part);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double least = least_distance(part, i);
    const bool may_have_crossed = least <= kInside && greatest_distance(part, i) >= kInside;
    if ((least >= part.nearest.distance && !may_have_crossed) || i == last_nearest) continue;
    const geometry::NearestPoint found = update_point(surface, points, i, placed_anew, part);
    if (found.distance >= part.nearest.distance) continue;
    part.nearest_point = static_cast<std::uint32_t>(i);
    part.nearest = found;
  }
}

}  // namespace

geometry::NearestPoint ask_distance(const OrganSurface& surface, const PartPoints& points, std::size_t point,
                                    PartState& part) noexcept {
  geometry::NearestPoint found =
      surface.nearest(part.pose_S * points.point(point), part.nearest_triangle[point]);
  part.known[point] = found.distance;
  part.since[point] = part.travelled;
  part.nearest_triangle[point] = found.triangle;
  part.inside[point] = found.distance < kInside ? 1 : 0;
  return found;
}

bool move_part(const OrganSurface& surface, const PartPoints& points, const Pose& pose_S, double period,
               PartState& part) noexcept {
  part.previous_S = part.seen ? part.pose_S : pose_S;
  part.pose_S = pose_S;
  part.motion = greatest_motion(points, part.previous_S, pose_S);
  part.travelled += part.motion;
  part.entry_count = 0;
  const bool placed_anew = !part.seen || part.motion > kFastestHand * period;
  part.seen = true;
  if (placed_anew) {
    forget(surface, points, part);
    part.previous_S = pose_S;
    part.motion = 0.0;
    part.armed = false;
  }
  scan_points(surface, points, placed_anew, part);
  if (part.nearest.distance >= kOutside) part.armed = true;
  return !placed_anew;
}

}  // namespace palpate::contact
