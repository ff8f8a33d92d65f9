#include "core/contact/support.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/lanes.h"
#include "core/contact/point_sums.h"

namespace palpate::contact {
namespace {

/// The tangent plane of a contact and the cylinder about its axis, in the part's frame.
struct Plane {
  Vec3 point;
  Vec3 normal;
  double radius;  // R_ref

  /// 1 up to R_ref/2, 0 from R_ref on, smooth between. `rho_squared`: squared distance from the axis.
  [[nodiscard]] double taper(double rho_squared) const noexcept {
    const double inner = 0.5 * radius;
    if (rho_squared <= inner * inner) return 1.0;
    const double t = (std::sqrt(rho_squared) - inner) / inner;
    return t >= 1.0 ? 0.0 : 1.0 - t * t * (3.0 - 2.0 * t);
  }

  [[nodiscard]] double tapered(double depth, double rho_squared) const noexcept {
    return depth > 0.0 ? depth * taper(rho_squared) : depth;
  }

  /// No point of a ball is farther behind the plane. `beside`: none is nearer to the axis.
  [[nodiscard]] double most_behind(const PartPoints::Cluster& ball, double& beside) const noexcept {
    const Vec3 offset = ball.centre - point;
    const double height = offset.dot(normal);
    beside = std::sqrt(std::max(0.0, offset.squaredNorm() - height * height)) - ball.radius;
    return ball.radius - height;
  }
};

/// Exact depths of two points. Sums of three run as Eigen's do, so that they round alike.
struct PlanePair {
  Pair x, y, z, nx, ny, nz, inner_squared;

  explicit PlanePair(const Plane& plane) noexcept
      : x(plane.point.x()),
        y(plane.point.y()),
        z(plane.point.z()),
        nx(plane.normal.x()),
        ny(plane.normal.y()),
        nz(plane.normal.z()),
        inner_squared(0.25 * plane.radius * plane.radius) {}

  /// @param rho_squared becomes the squared distances from the axis
  [[nodiscard]] Pair depths(const PartPoints::Weighed& a, const PartPoints::Weighed& b, const Plane& plane,
                            Pair& rho_squared) const noexcept {
    const Pair dx = pair_of(a.x, b.x) - x;
    const Pair dy = pair_of(a.y, b.y) - y;
    const Pair dz = pair_of(a.z, b.z) - z;
    const Pair depth = -(dx * nx + (dy * ny + dz * nz));
    rho_squared = dx * dx + (dy * dy + dz * dz) - depth * depth;
    if (all(rho_squared <= inner_squared)) return depth;
    return pair_of(plane.tapered(depth.get(0), rho_squared.get(0)),
                   plane.tapered(depth.get(1), rho_squared.get(1)));
  }
};

/// The same for four points at once, nearly: to leave out what is not deep.
struct PlaneLanes {
  Lanes x, y, z, nx, ny, nz, inner, inverse_inner;

  explicit PlaneLanes(const Plane& plane) noexcept
      : x(static_cast<float>(plane.point.x())),
        y(static_cast<float>(plane.point.y())),
        z(static_cast<float>(plane.point.z())),
        nx(static_cast<float>(plane.normal.x())),
        ny(static_cast<float>(plane.normal.y())),
        nz(static_cast<float>(plane.normal.z())),
        inner(static_cast<float>(0.5 * plane.radius)),
        inverse_inner(static_cast<float>(2.0 / plane.radius)) {}

  /// Writes the depths of a cluster's points, @return the greatest.
  /// @param aside becomes the greatest of those that are farther than R_ref/2 from the axis
  float depths_of(const PartPoints& part, std::size_t begin, float* depths, float& aside) const noexcept {
    const Lanes zero(0.0F);
    const Lanes one(1.0F);
    const Lanes none(-1.0F);
    Lanes greatest = none;
    Lanes greatest_aside = none;
    for (std::size_t i = begin; i < begin + PartPoints::kClusterSize; i += kLanes) {
      const Lanes dx = Lanes::load_unaligned(&part.near_x[i]) - x;
      const Lanes dy = Lanes::load_unaligned(&part.near_y[i]) - y;
      const Lanes dz = Lanes::load_unaligned(&part.near_z[i]) - z;
      const Lanes depth = zero - (dx * nx + dy * ny + dz * nz);
      const Lanes rho = sqrt(max(zero, dx * dx + dy * dy + dz * dz - depth * depth));
      const Lanes t = min(one, max(zero, (rho - inner) * inverse_inner));
      const Lanes tapered = depth * (one - t * t * (Lanes(3.0F) - (t + t)));
      const Lanes value = min(depth, tapered);  // a depth of 0 or less stays as it is
      value.store_unaligned(depths + (i - begin));
      greatest = max(greatest, value);
      greatest_aside = max(greatest_aside, select(t > zero, value, none));
    }
    aside = largest_of(greatest_aside);
    return largest_of(greatest);
  }
};

// A shortlist holds the points within this of counting [m]: the more, the longer it serves and the more it
// costs.
constexpr double kKeptMargin = 0.04e-3;
// ... and of R_ref that a point may have come nearer to the axis since.
constexpr double kKeptBeside = 0.25;
constexpr double kKeptTurn = 0.1;    // rad, that the plane may have turned since
constexpr double kKeptSlack = 1e-9;  // m, for rounding in the bound

/// What a shortlist says of a plane that has moved since.
class Since final {
 public:
  Since(const Shortlist& kept, const Plane& plane) noexcept
      : kept_(kept),
        plane_(plane),
        moved_(plane.point - kept.point),
        way_(moved_.norm()),
        turned_((plane.normal - kept.normal).norm()),
        raised_(moved_.dot(kept.normal)),
        moved_aside_(std::sqrt(std::max(0.0, way_ * way_ - raised_ * raised_))) {}

  /// How deep a point that is not on the list may be by now, if that can be said [m].
  [[nodiscard]] double most_of_the_rest() const noexcept {
    const double nowhere = std::numeric_limits<double>::infinity();
    const double beside = kKeptBeside * plane_.radius;
    if (kept_.count == 0 || turned_ > kKeptTurn || way_ + (kept_.reach + way_) * turned_ > beside)
      return nowhere;
    // A point p that counts now is within R_ref of the axis, and was within R_ref + `beside`. Its height over
    // the plane has changed by moved . n and by |p - c| `turned` at most, and its distance from the axis by
    // |p - c| `turned` and the way beside it; the taper changes by at most 3 / R_ref of that.
    const double by_turning = 1.5 * (plane_.radius + kept_.behind) * turned_;
    const double deeper = std::max(0.0, raised_) + by_turning;
    const double across = moved_aside_ + by_turning;
    const double tapered = deeper + (kept_.behind + deeper) * (3.0 / plane_.radius) * across;
    // A point within R_ref/2 of the axis had its depth in full, and has no more than that now. Where the
    // plane has gone down, so have all of them. |p - c| <= R_ref/2 + its depth, or, above the plane, its
    // height: by that it is less deep than `rest` already.
    const double inner =
        kept_.rest + raised_ + (way_ + 0.5 * plane_.radius + kept_.behind + kKeptMargin) * turned_;
    return std::min(kept_.rest + tapered, std::max(inner, kept_.rest_aside + tapered));
  }

  /// Whether every point of the list is surely so near to the axis that its depth does not taper.
  [[nodiscard]] bool none_tapers() const noexcept {
    const double most = kept_.aside + kept_.behind + 2.0 * kKeptMargin;  // that a point was from `point`
    return kept_.aside + moved_aside_ + (most + way_) * turned_ + kKeptSlack < 0.5 * plane_.radius;
  }

 private:
  const Shortlist& kept_;
  const Plane& plane_;
  Vec3 moved_;
  double way_;
  double turned_;
  double raised_;
  double moved_aside_;
};

/// The exact depths of some points.
struct Depths {
  double deepest = 0.0;      // m; 0 when no point is behind the plane
  double rho_squared = 0.0;  // of the point farthest from the axis [m^2]
};

/// The exact depths of some points [m], two at a time.
/// @param depths room for one more than there are points
Depths measure(const PartPoints& part, const Plane& plane, std::span<const std::uint16_t> points,
               double* depths) noexcept {
  const PlanePair pair(plane);
  const PartPoints::Weighed* const weighed = part.weighed.data();
  Pair deepest(0.0);
  Pair farthest(0.0);
  for (std::size_t k = 0; k < points.size(); k += kPair) {
    const PartPoints::Weighed& a = weighed[points[k]];
    const PartPoints::Weighed& b = weighed[points[std::min(k + 1, points.size() - 1)]];  // the last one twice
    Pair rho_squared(0.0);
    const Pair two = pair.depths(a, b, plane, rho_squared);
    two.store_unaligned(depths + k);
    deepest = max(two, deepest);
    farthest = max(rho_squared, farthest);
  }
  return {largest_of(deepest), largest_of(farthest)};
}

}  // namespace

/// Finds the points that may count for one plane.
class SupportSearch final {
 public:
  SupportSearch(const PartPoints& part, const Plane& plane) noexcept : part_(part), plane_(plane) {}

  /// Looks at all points: those within `margin` [m] of counting, those that come within `beside` [m] of R_ref
  /// from the axis too.
  void look_at_all(double margin, double beside) noexcept {
    const PlaneLanes lanes(plane_);
    // What single precision may be wrong by, and then some [m].
    const auto slack = static_cast<float>(part_.rounding + 1e-6 * plane_.radius);
    const std::size_t first = reach_clusters(margin, beside, slack);
    if (reached_ == 0) return;

    float deepest = 0.0F;
    const auto look_at = [&](Reached& reached) {
      const std::size_t begin = std::size_t{reached.cluster} * PartPoints::kClusterSize;
      reached.most = lanes.depths_of(part_, begin, &depths_[begin], reached.most_aside);
      reached.looked_at = true;
      deepest = std::max(deepest, reached.most);
    };
    const auto band = static_cast<float>(kSupportBand);
    const float below = 2.0F * slack + static_cast<float>(margin);
    const auto floor = [&] { return std::max(deepest - band, 0.0F) - below; };
    look_at(reached_clusters_[first]);
    for (std::size_t k = 0; k < reached_; ++k) {
      Reached& reached = reached_clusters_[k];
      if (!reached.looked_at && reached.most >= floor()) look_at(reached);
    }

    // What may count, in the order of the points.
    const float least = floor();
    rest_ = std::max(static_cast<double>(least + slack), -margin);
    rest_aside_ = -margin;
    for (std::size_t k = 0; k < reached_; ++k) {
      const Reached& reached = reached_clusters_[k];
      rest_aside_ = std::max(rest_aside_, static_cast<double>(reached.most_aside + slack));
      if (!reached.looked_at || reached.most < least) continue;
      const PartPoints::Cluster& cluster = part_.clusters[reached.cluster];
      for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
        if (depths_[i] >= least) points_[found_++] = static_cast<std::uint16_t>(i);
      }
    }
  }

  /// Keeps what look_at_all found and support() has measured, unless that is too much.
  void keep(Shortlist& kept) const noexcept {
    kept.count = 0;
    if (found_ > Shortlist::kMost) return;
    kept.point = plane_.point;
    kept.normal = plane_.normal;
    kept.rest = rest_;
    kept.rest_aside = rest_aside_;
    kept.behind = behind_;
    kept.reach = 0.0;
    for (const PartPoints::Cluster& group : part_.groups) {
      kept.reach = std::max(kept.reach, (group.centre - plane_.point).norm() + group.radius);
    }
    kept.aside = aside_;
    std::copy_n(points_.begin(), found_, kept.points.begin());
    kept.count = static_cast<std::uint32_t>(found_);
  }

  /// The support by what look_at_all found.
  [[nodiscard]] Support support() noexcept {
    const std::span<const std::uint16_t> found = std::span(points_).first(found_);
    const Depths depths = measure(part_, plane_, found, exact_.data());
    aside_ = std::sqrt(depths.rho_squared);
    return sum_up(part_, found, exact_.data(), depths.deepest);
  }

 private:
  /// The clusters that may have points within `margin` of counting; @return the one that may have the
  /// deepest.
  std::size_t reach_clusters(double margin, double beside, float slack) noexcept {
    std::size_t first = 0;
    double from_axis = 0.0;
    for (const PartPoints::Cluster& group : part_.groups) {
      if (plane_.most_behind(group, from_axis) <= -margin || from_axis >= plane_.radius + beside) continue;
      for (std::uint32_t c = group.begin; c < group.end; ++c) {
        const double behind = plane_.most_behind(part_.clusters[c], from_axis);
        if (behind <= -margin || from_axis >= plane_.radius + beside) continue;
        behind_ = std::max(behind_, behind);
        const double most =
            behind > 0.0 && from_axis > 0.0 ? behind * plane_.taper(from_axis * from_axis) : behind;
        const bool aside = from_axis + 2.0 * part_.clusters[c].radius > 0.5 * plane_.radius;
        const float most_here = static_cast<float>(most) + slack;
        reached_clusters_[reached_] = {c, most_here, aside ? most_here : -1.0F, false};
        if (reached_clusters_[reached_].most > reached_clusters_[first].most) first = reached_;
        ++reached_;
      }
    }
    return first;
  }

  static constexpr std::size_t kMostPoints = PartPoints::kMostPoints;
  static constexpr std::size_t kMostClusters =
      (kMostPoints + PartPoints::kClusterSize - 1) / PartPoints::kClusterSize;

  /// A cluster that may hold deep points.
  struct Reached {
    std::uint32_t cluster;
    float most;        // no point is deeper [m]; once looked at, the depth of its deepest point
    float most_aside;  // the same of those farther than R_ref/2 from the axis
    bool looked_at;
  };

  const PartPoints& part_;
  const Plane& plane_;
  std::size_t reached_ = 0;
  std::size_t found_ = 0;
  double behind_ = 0.0;
  double rest_ = 0.0;  // as Shortlist's
  double rest_aside_ = 0.0;
  double aside_ = 0.0;
  // Working memory, on the stack: of the thread, not of every hand's state.
  std::array<Reached, kMostClusters> reached_clusters_;
  std::array<float, kMostClusters * PartPoints::kClusterSize> depths_;  // [m], in the clusters looked at
  std::array<std::uint16_t, kMostPoints> points_;                       // that may count
  std::array<double, kMostPoints + kDepthsBehind> exact_;               // their depths [m]
};

Support support_of(const PartPoints& part, const Vec3& point, const Vec3& normal,
                   double reference_radius) noexcept {
  const Plane plane{point, normal, reference_radius};
  SupportSearch search(part, plane);
  search.look_at_all(0.0, 0.0);
  return search.support();
}

namespace {

/// The support by all points, and the shortlist for the next ones. By itself, so that what it needs on the
/// stack is not in the way of supports that the list serves.
[[gnu::noinline]] Support keep_anew(const PartPoints& part, const Plane& plane, Shortlist& kept) noexcept {
  SupportSearch search(part, plane);
  search.look_at_all(kKeptMargin, kKeptBeside * plane.radius);
  Support support = search.support();
  search.keep(kept);
  return support;
}

}  // namespace

Support support_of(const PartPoints& part, const Vec3& point, const Vec3& normal, double reference_radius,
                   Shortlist& kept) noexcept {
  const Plane plane{point, normal, reference_radius};
  const Since since(kept, plane);
  const double rest = since.most_of_the_rest();
  if (std::isfinite(rest)) {
    std::array<double, Shortlist::kMost + kDepthsBehind> depths;
    const std::span<const std::uint16_t> points = std::span(kept.points).first(kept.count);
    const double depth = since.none_tapers() ? full_depths(part, point, normal, points, depths.data())
                                             : measure(part, plane, points, depths.data()).deepest;
    if (rest < std::max(0.0, depth - kSupportBand) - kKeptSlack)
      return sum_up(part, points, depths.data(), depth);
  }
  return keep_anew(part, plane, kept);
}

}  // namespace palpate::contact
