#include "core/contact/proximity.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/base/lanes.h"

namespace palpate::contact {
namespace {

constexpr double kOutside = -1e-6;  // m: a part that just touches counts as outside

// Bounds that pass over whole clusters are sums in another order than a point's own: nothing is passed over
// within this of counting [m].
constexpr double kBoundSlack = 1e-12;

// With more points of a cluster in question than this, its middle is asked first.
constexpr int kFewPoints = 4;

// The ball behind the tool: made anew after so much motion; its centre goes back while the ball rests on the
// organ within kBallLoss of the tool's nearest point, and comes nearer when something else is in its way.
constexpr double kBallServes = 1e-3;     // m
constexpr double kBallLoss = 0.1e-3;     // m
constexpr double kLeastBehind = 2e-3;    // m
constexpr double kGreatestBehind = 0.1;  // m

constexpr double kContactDrift = 0.1;   // m/s: twice what a contact may gain on the tool
constexpr int kMostTakenUp = 16;        // distances asked a tick for clusters that were left by contacts
constexpr double kLeastClear = 0.1e-3;  // m: a point nearer to the surface is asked by itself

/// No point of the part has moved more since the last tick: the motion of the middle of its box, and what
/// turning adds on the way to a corner.
double greatest_motion(const PartPoints& points, const PartState& part) noexcept {
  const Mat3 turned = part.placed_S.rotation - part.previous_S.rotation;
  const Vec3 moved = part.placed_S.position - part.previous_S.position;
  double motion = (turned * points.box_middle + moved).norm();
  for (int axis = 0; axis < 3; ++axis) motion += points.box_reach[axis] * turned.col(axis).norm();
  return motion;
}

std::uint64_t bit_of(std::size_t cluster) noexcept { return std::uint64_t{1} << cluster; }

/// Brings a cluster's bounds up to date with its points.
void bound_cluster(const PartPoints& points, std::size_t cluster, PartState& part) noexcept {
  Pair crosses(std::numeric_limits<double>::infinity());
  Pair floor = crosses;
  const std::size_t end = points.clusters[cluster].end;
  const Pair inside(kInside);
  std::size_t i = points.clusters[cluster].begin;
  for (; i + kPair <= end; i += kPair) {
    const Pair away = abs(Pair::load_unaligned(&part.known[i]) - inside);
    crosses = min(Pair::load_unaligned(&part.since[i]) + away, crosses);
    floor = min(Pair::load_unaligned(&part.floor[i]), floor);
  }
  double least_crosses = least_of(crosses);
  double least_floor = least_of(floor);
  if (i < end) {
    least_crosses = std::min(least_crosses, part.since[i] + std::abs(part.known[i] - kInside));
    least_floor = std::min(least_floor, part.floor[i]);
  }
  part.cluster_crosses[cluster] = least_crosses;
  part.cluster_floor[cluster] = least_floor;
  part.left &= ~bit_of(cluster);
  part.crosses = std::min(part.crosses, least_crosses);
  part.lowest = std::min(part.lowest, least_floor);
}

double least_of_all(const std::vector<double>& values) noexcept {
  Pair least(std::numeric_limits<double>::infinity());
  for (std::size_t c = 0; c < values.size(); c += kPair) {
    least = min(Pair::load_unaligned(&values[c]), least);
  }
  return least_of(least);
}

/// One bit a cluster: its value is not above `limit`.
std::uint64_t clusters_within(const std::vector<double>& values, double limit) noexcept {
  std::uint64_t within = 0;
  const Pair most(limit);
  for (std::size_t c = 0; c < values.size(); c += kPair) {
    within |= std::uint64_t{lanes_of(!(Pair::load_unaligned(&values[c]) > most))} << c;
  }
  return within;
}

void set_inside(PartState& part, std::size_t point, double distance) noexcept {
  const bool inside = distance < kInside;
  part.inside_count += static_cast<std::uint32_t>(inside) - part.inside[point];
  part.inside[point] = inside ? 1 : 0;
}

/// Knows no more of a cluster's points than what its middle tells: distance changes by no more than the way
/// between.
void forget_cluster(const OrganSurface& surface, const PartPoints& points, std::size_t c, PartState& part,
                    std::int32_t& guess) noexcept {
  const PartPoints::Cluster& cluster = points.clusters[c];
  const geometry::NearestPoint middle = surface.nearest(part.placed_S * cluster.centre, guess);
  guess = middle.triangle;
  for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
    part.known[i] = middle.distance;
    part.since[i] = part.travelled - points.offset[i];
    part.floor[i] = part.known[i] + part.since[i];
    part.nearest_triangle[i] = middle.triangle;
    set_inside(part, i, middle.distance);
  }
}

void forget(const OrganSurface& surface, const PartPoints& points, PartState& part) noexcept {
  std::int32_t guess = -1;
  part.nearest_point = 0;
  for (std::size_t c = 0; c < points.clusters.size(); ++c) {
    forget_cluster(surface, points, c, part, guess);
    bound_cluster(points, c, part);
    for (std::size_t i = points.clusters[c].begin; i < points.clusters[c].end; ++i) {
      if (part.floor[i] < part.floor[part.nearest_point]) {
        part.nearest_point = static_cast<std::uint32_t>(i);  // the one to ask first
      }
    }
  }
}

void add_entry(PartState& part, std::size_t point, const SurfacePoint& at) noexcept {
  if (part.entry_count == PartState::kMostEntries) return;  // so many points at once: any of them will do
  part.entries[part.entry_count++] = {static_cast<std::uint32_t>(point), at};
}

/// The ball's centre in the part's frame, and what it says of points.
struct BallBound {
  Vec3 centre_P;
  double radius;

  explicit BallBound(const PartState& part) noexcept
      : centre_P(part.placed_S.bring_back(part.ball.centre_S)), radius(part.ball.radius - kBoundSlack) {}

  /// A point is not nearer to the organ than this [m].
  [[nodiscard]] double least(const Vec3& point_P) const noexcept {
    return radius - (point_P - centre_P).norm();
  }
};

/// Whether a bound alone says that a point is on the side where it was and has not crossed in this tick: the
/// balls without surface around it, then and now, must meet, and this one hold the tick's way. Keeps the
/// bound. @param least the point is at least so far from the surface [m]
bool stays_on_its_side(std::size_t i, double least, PartState& part) noexcept {
  const double way = part.travelled - part.since[i];
  const double before = std::abs(part.known[i]);
  if (least + kInside <= part.motion || before + least + kInside <= way) return false;
  const bool outside = part.known[i] > 0.0;
  part.known[i] = outside ? least : -least;
  part.since[i] = part.travelled;
  if (outside) part.floor[i] = std::max(part.floor[i], least + part.travelled);
  return true;
}

/// Asks one point, and notes an entry when it went in, or in and out again, during this tick.
void update_point(const OrganSurface& surface, const PartPoints& points, std::size_t i, bool placed_anew,
                  PartState& part) noexcept {
  const geometry::Clearance clear =
      surface.clearance(part.placed_S * points.point(i), part.nearest_triangle[i]);
  part.nearest_triangle[i] = clear.triangle;
  if (stays_on_its_side(i, clear.least, part)) return;
  const bool was_inside = part.inside[i] != 0;
  const double before = least_distance(part, i) + part.motion;  // at least this far outside a tick ago
  const geometry::NearestPoint now = ask_distance(surface, points, i, part);
  if (placed_anew || was_inside) return;
  const bool went_in = now.distance < kInside;
  const Vec3 end = part.placed_S * points.point(i);
  const Vec3 start = part.previous_S * points.point(i);
  // Out and out again: in between it was in only if the way is long enough.
  const double way_in = std::max(0.0, before - kInside) + now.distance - kInside;
  if (!went_in && way_in > (end - start).norm()) return;
  if (const auto entry = surface.first_entry(start, end)) {
    add_entry(part, i, {entry->point, entry->triangle});
  } else if (went_in) {
    add_entry(part, i, {now.point, now.triangle});
  }
}

/// One bit a point of a cluster, the first lowest: it may have crossed the surface.
std::uint32_t crossed_in(const PartPoints::Cluster& cluster, const PartState& part) noexcept {
  const Pair inside(kInside);
  const Pair travelled(part.travelled);
  const auto crossed = [&](const Pair& known, const Pair& since) {
    const Pair way = travelled - since;
    return lanes_of(known - way <= inside && known + way >= inside);
  };
  std::uint32_t points = 0;
  std::size_t i = cluster.begin;
  for (; i + kPair <= cluster.end; i += kPair) {
    points |= crossed(Pair::load_unaligned(&part.known[i]), Pair::load_unaligned(&part.since[i]))
              << (i - cluster.begin);
  }
  if (i < cluster.end) {
    points |= (crossed(Pair(part.known[i]), Pair(part.since[i])) & 1U) << (i - cluster.begin);
  }
  return points;
}

/// Where a part's contacts are, in the part's frame.
class ContactPlaces final {
 public:
  ContactPlaces(double reference_radius, double period, PartState& part) noexcept
      // A contact walks no farther in a tick than the tool moves there and a little.
      : reach_(reference_radius - 3.0 * part.motion - kContactDrift * period) {
    for (const Contact& contact : part.active()) {
      places_[count_++] = part.placed_S.bring_back(contact.at.point);
    }
  }

  /// Whether whatever a cluster's points cross this tick is so near to a contact that it starts no other.
  [[nodiscard]] bool hold(const PartPoints::Cluster& cluster) const noexcept {
    const double nearest = reach_ - cluster.radius;
    if (nearest <= 0.0) return false;
    for (std::size_t i = 0; i < count_; ++i) {
      if ((places_[i] - cluster.centre).squaredNorm() <= nearest * nearest) return true;
    }
    return false;
  }

 private:
  double reach_;
  std::size_t count_ = 0;
  std::array<Vec3, kContactsPerPart> places_;
};

/// What point i's distance just asked says of others of its cluster, one bit each: what is nearer to it than
/// the surface is, is on its side. @return those so near to the surface that they would soon be asked again
std::uint32_t settle_around(const PartPoints& points, std::size_t c, std::size_t i, double distance,
                            std::uint32_t others, PartState& part) noexcept {
  const Vec3 asked = points.point(i);
  std::uint32_t open = 0;
  for (; others != 0; others &= others - 1) {
    const std::size_t j = points.clusters[c].begin + static_cast<std::size_t>(std::countr_zero(others));
    const double way = (points.point(j) - asked).norm();
    const double clear = std::abs(distance) - way - kBoundSlack;
    if (clear < kLeastClear) {
      open |= others & -others;
      continue;
    }
    part.known[j] = distance < 0.0 ? -clear : clear;
    part.since[j] = part.travelled;
    part.floor[j] = std::max(part.floor[j], distance - way - kBoundSlack + part.travelled);
    part.nearest_triangle[j] = part.nearest_triangle[i];
    set_inside(part, j, part.known[j]);
  }
  return open;
}

/// A cluster that was left looks where its points are now; what has crossed meanwhile starts nothing by it.
/// @return distances asked
int take_up(const OrganSurface& surface, const PartPoints& points, std::size_t c, PartState& part) noexcept {
  const PartPoints::Cluster& cluster = points.clusters[c];
  std::int32_t guess = part.nearest_triangle[cluster.begin];
  forget_cluster(surface, points, c, part, guess);
  int asked = 1;
  for (std::uint32_t open = crossed_in(cluster, part); open != 0; ++asked) {
    const std::size_t i = cluster.begin + static_cast<std::size_t>(std::countr_zero(open));
    const double distance = ask_distance(surface, points, i, part).distance;
    open = settle_around(points, c, i, distance, open & (open - 1), part);
  }
  return asked;
}

/// One question for all points of a cluster: what is nearer to its middle than the surface is, is on the
/// middle's side, and was there a tick ago if the surface is farther off than the tick's way.
/// @param crossed the points in question, one bit each
void settle_by_middle(const OrganSurface& surface, const PartPoints& points, std::size_t c,
                      std::uint32_t crossed, PartState& part) noexcept {
  const PartPoints::Cluster& cluster = points.clusters[c];
  const geometry::NearestPoint middle =
      surface.nearest(part.placed_S * cluster.centre, part.nearest_triangle[cluster.begin]);
  const bool inside = middle.distance < 0.0;
  for (; crossed != 0; crossed &= crossed - 1) {
    const std::size_t i = cluster.begin + static_cast<std::size_t>(std::countr_zero(crossed));
    if ((part.inside[i] != 0) != inside) continue;
    const double clear = std::abs(middle.distance) - points.offset[i] - kBoundSlack;
    if (clear + kInside <= part.motion) continue;
    part.known[i] = inside ? -clear : clear;
    part.since[i] = part.travelled;
    part.nearest_triangle[i] = middle.triangle;
    if (!inside) part.floor[i] = std::max(part.floor[i], clear + part.travelled);
  }
}

/// Passes over those of the crossed points, one bit each, that the ball shows to be outside still.
/// @return the others
std::uint32_t leave_to_ball(const PartPoints& points, const PartPoints::Cluster& cluster,
                            const BallBound& ball, std::uint32_t crossed, PartState& part) noexcept {
  std::uint32_t open = 0;
  for (; crossed != 0; crossed &= crossed - 1) {
    const std::size_t i = cluster.begin + static_cast<std::size_t>(std::countr_zero(crossed));
    const bool outside = part.known[i] > 0.0;
    if (!outside || !stays_on_its_side(i, ball.least(points.point(i)), part)) open |= crossed & -crossed;
  }
  return open;
}

/// Asks the points of a cluster that may have crossed the surface.
void ask_crossed(const OrganSurface& surface, const PartPoints& points, std::size_t c, const BallBound& ball,
                 bool placed_anew, PartState& part) noexcept {
  const PartPoints::Cluster& cluster = points.clusters[c];
  std::uint32_t crossed = leave_to_ball(points, cluster, ball, crossed_in(cluster, part), part);
  if (std::popcount(crossed) > kFewPoints) {
    settle_by_middle(surface, points, c, crossed, part);
    crossed = crossed_in(cluster, part);
  }
  for (; crossed != 0; crossed &= crossed - 1) {
    const std::size_t i = cluster.begin + static_cast<std::size_t>(std::countr_zero(crossed));
    update_point(surface, points, i, placed_anew, part);
  }
}

/// Asks all points that may have crossed the surface.
void find_crossings(const OrganSurface& surface, const PartPoints& points, double reference_radius,
                    double period, bool placed_anew, PartState& part) noexcept {
  const double now = part.travelled + kBoundSlack;
  std::uint64_t due = part.crosses > now ? 0 : clusters_within(part.cluster_crosses, now);
  bool changed = due != 0;
  due |= part.left;
  if (due == 0) return;
  const ContactPlaces contacts(reference_radius, period, part);
  const BallBound ball(part);
  int asked = 0;
  for (; due != 0; due &= due - 1) {
    const auto c = static_cast<std::size_t>(std::countr_zero(due));
    if (contacts.hold(points.clusters[c])) {
      part.left |= bit_of(c);
      part.cluster_crosses[c] = std::numeric_limits<double>::infinity();
      continue;
    }
    if ((part.left & bit_of(c)) == 0) {
      ask_crossed(surface, points, c, ball, placed_anew, part);
    } else if (asked < kMostTakenUp) {
      asked += take_up(surface, points, c, part);
    } else {
      continue;  // in the next ticks
    }
    bound_cluster(points, c, part);
    changed = true;
  }
  if (changed) part.crosses = least_of_all(part.cluster_crosses);
}

/// Makes the ball anew behind the nearest point when the tool has moved on.
void renew_ball(const OrganSurface& surface, const PartPoints& points, PartState& part) noexcept {
  EmptyBall& ball = part.ball;
  const double distance = part.nearest.distance;
  if (!(distance > 0.0) || (ball.radius > 0.0 && part.travelled - ball.made < kBallServes)) return;
  const Vec3 nearest_S = part.placed_S * points.point(part.nearest_point);
  const Vec3 way = nearest_S - part.nearest.point;
  const Vec3 away = distance > kBallLoss ? Vec3(way / distance) : part.nearest.normal;
  ball.centre_S = nearest_S + ball.behind * away;
  ball.radius = surface.nearest(ball.centre_S, part.nearest.triangle).distance;
  ball.made = part.travelled;
  const bool rests = ball.radius > distance + ball.behind - kBallLoss;
  ball.behind = std::clamp((rests ? 2.0 : 0.5) * ball.behind, kLeastBehind, kGreatestBehind);
}

/// Raises the floor of a cluster's points by the ball; @return how many may still be nearer than `wanted`. Of
/// a cluster that was left the ball must tell the side too.
int raise_by_ball(const PartPoints& points, std::size_t c, const BallBound& ball, double wanted,
                  PartState& part) noexcept {
  const bool left = (part.left & bit_of(c)) != 0;
  int open = 0;
  for (std::size_t i = points.clusters[c].begin; i < points.clusters[c].end; ++i) {
    if (part.floor[i] - part.travelled >= wanted) continue;
    const double least = ball.least(points.point(i));
    if (left && least > 0.0) {
      part.known[i] = least;
      part.since[i] = part.travelled;
      set_inside(part, i, least);
    }
    if (!left || least > 0.0) part.floor[i] = std::max(part.floor[i], least + part.travelled);
    if (part.floor[i] - part.travelled < wanted) ++open;
  }
  return open;
}

/// One question for all points of a cluster: none is nearer than its middle by more than the way between.
void raise_floor(const OrganSurface& surface, const PartPoints& points, std::size_t c,
                 PartState& part) noexcept {
  const PartPoints::Cluster& cluster = points.clusters[c];
  const geometry::NearestPoint middle =
      surface.nearest(part.placed_S * cluster.centre, part.nearest_triangle[cluster.begin]);
  for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
    const double floor = middle.distance - points.offset[i] + part.travelled;
    part.floor[i] = std::max(part.floor[i], floor);
  }
}

}  // namespace

geometry::NearestPoint ask_distance(const OrganSurface& surface, const PartPoints& points, std::size_t point,
                                    PartState& part) noexcept {
  geometry::NearestPoint found =
      surface.nearest(part.placed_S * points.point(point), part.nearest_triangle[point]);
  part.known[point] = found.distance;
  part.since[point] = part.travelled;
  part.floor[point] = found.distance + part.travelled;
  part.nearest_triangle[point] = found.triangle;
  set_inside(part, point, found.distance);
  return found;
}

bool move_part(const OrganSurface& surface, const PartPoints& points, const Pose& pose_S,
               double reference_radius, double period, PartState& part) noexcept {
  const Placement before = part.placed_S;
  part.placed_S = {pose_S.rotation.toRotationMatrix(), pose_S.position};
  part.previous_S = part.seen ? before : part.placed_S;
  part.motion = greatest_motion(points, part);
  part.travelled += part.motion;
  part.entry_count = 0;
  const bool placed_anew = !part.seen || part.motion > kFastestHand * period;
  part.seen = true;
  if (placed_anew) {
    forget(surface, points, part);
    part.previous_S = part.placed_S;
    part.motion = 0.0;
    part.armed = false;
    part.contact_count = 0;
  }
  find_crossings(surface, points, reference_radius, period, placed_anew, part);
  if (!part.armed) {
    find_nearest(surface, points, part);
    part.armed = part.nearest.distance >= kOutside;
  }
  return !placed_anew;
}

void find_nearest(const OrganSurface& surface, const PartPoints& points, PartState& part,
                  double enough) noexcept {
  const double far_off = enough + kBoundSlack + part.travelled;
  if (part.lowest <= far_off) part.lowest = least_of_all(part.cluster_floor);
  if (part.lowest > far_off) {
    part.nearest.distance = std::numeric_limits<double>::infinity();
    return;
  }
  const std::size_t last_nearest = part.nearest_point;
  part.nearest = ask_distance(surface, points, last_nearest, part);  // its cluster is looked at below, surely
  renew_ball(surface, points, part);
  const BallBound ball(part);
  // Only what is nearer than this matters.
  const auto wanted = [&part, enough] { return std::min(part.nearest.distance, enough); };
  const auto limit = [&wanted] { return wanted() + kBoundSlack; };
  for (std::uint64_t near = clusters_within(part.cluster_floor, part.travelled + limit() + kBoundSlack);
       near != 0; near &= near - 1) {
    const auto c = static_cast<std::size_t>(std::countr_zero(near));
    if (part.cluster_floor[c] - part.travelled > limit()) continue;
    const double least = ball.least(points.clusters[c].centre) - points.clusters[c].radius;
    if ((part.left & bit_of(c)) == 0 && least > limit()) {
      part.cluster_floor[c] = std::max(part.cluster_floor[c], least + part.travelled);
      continue;
    }
    if (raise_by_ball(points, c, ball, wanted(), part) > kFewPoints) raise_floor(surface, points, c, part);
    for (std::size_t i = points.clusters[c].begin; i < points.clusters[c].end; ++i) {
      if (i == last_nearest || part.floor[i] - part.travelled >= wanted()) continue;
      const geometry::NearestPoint found = ask_distance(surface, points, i, part);
      if (found.distance >= part.nearest.distance) continue;
      part.nearest_point = static_cast<std::uint32_t>(i);
      part.nearest = found;
    }
    bound_cluster(points, c, part);
  }
}

}  // namespace palpate::contact
