#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/contact/contact_constants.h"
#include "core/contact/organ_surface.h"
#include "core/contact/tool_points.h"

namespace palpate::contact {

/// A pose with its rotation as a matrix, which is cheaper for many points.
struct RigidTransform {
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();

  [[nodiscard]] Vec3 operator*(const Vec3& p) const noexcept { return rotation * p + position; }
  [[nodiscard]] Vec3 inverse_rotate(const Vec3& direction) const noexcept {
    return rotation.transpose() * direction;
  }
  [[nodiscard]] Vec3 inverse_transform(const Vec3& p) const noexcept { return inverse_rotate(p - position); }
};

/// A tool point that entered the organ in this tick, and the position of entry.
struct EntryEvent {
  std::uint32_t point = 0;
  SurfacePoint at;
};

/// Cached signed distances from a rigid part's points to the organ, by conservative advancement [Mirtich
/// 1996]. A distance changes by no more than the part moves. So a point is queried again only when the motion
/// since its last query could change its side. Results are those of querying every point in every tick.
///
/// Invariants. The odometer is the sum of the largest motions of any point relative to the organ. Since its
/// last query a point has moved by at most odometer_ - `odometer`. `distance` is the signed distance at that
/// query, or for an outside point a positive lower bound. After move(), `inside_` is right for every point
/// outside deferred clusters, and the entries list each of them that entered in this tick, at most
/// kMaxEntries. A cluster that was deferred until this move gives no entries.
class DistanceCache final {
 public:
  /// [setup] @param surface, points must outlive the cache
  DistanceCache(const OrganSurface& surface, const PartPoints& points);

  /// [rt] Moves the part to `pose_S` (organ frame). Finds exactly the points that entered the organ, also
  /// those that passed through it within the tick.
  /// @param contacts_S positions of the part's proxies. No point within `reference_radius` [m] of one starts
  /// a new contact, so clusters there are deferred until the proxy is gone.
  /// @return false when the part jumped (first pose, or faster than kFastestHand): then there are no entries
  bool move(const Pose& pose_S, double period, std::span<const Vec3> contacts_S,
            double reference_radius) noexcept;

  /// [rt] Moves the part of a needle that is in the tissue, whose points start no contacts. The next move()
  /// or find_nearest() finds all sides, without entries. @return as move()
  bool move_inserted(const Pose& pose_S, double period) noexcept;

  /// [rt] Finds exactly the part's point nearest to the organ, or the deepest one when some are inside.
  /// @param enough distances below this [m] are exact; for a part farther away nearest() is that of some
  /// point at least this far
  void find_nearest(double enough = std::numeric_limits<double>::infinity()) noexcept;
  /// [rt] Result of the last find_nearest(): the point and its distance.
  [[nodiscard]] std::uint32_t nearest_point() const noexcept { return nearest_point_; }
  [[nodiscard]] const geometry::NearestPoint& nearest() const noexcept { return nearest_; }

  /// [rt] As lower_bound(), after the clearance sphere has raised it where it can.
  double raise_bound(std::size_t point) noexcept;
  /// [rt] Queries a point's exact distance.
  geometry::NearestPoint query(std::size_t point) noexcept;
  /// [rt] Lower and upper bound of a point's signed distance [m]; upper_bound() only for a point inside.
  [[nodiscard]] double lower_bound(std::size_t point) const noexcept {
    return cached_[point].distance - (odometer_ - cached_[point].odometer);
  }
  [[nodiscard]] double upper_bound(std::size_t point) const noexcept {
    return cached_[point].distance + (odometer_ - cached_[point].odometer);
  }

  [[nodiscard]] bool is_inside(std::size_t point) const noexcept { return inside_[point] != 0; }
  /// [rt] The first point inside in [first, end); `end` when no point is.
  [[nodiscard]] std::uint32_t next_inside(std::uint32_t first, std::uint32_t end) const noexcept {
    const void* const found = std::memchr(inside_.data() + first, 1, end - first);
    if (found == nullptr) return end;
    return static_cast<std::uint32_t>(static_cast<const std::uint8_t*>(found) - inside_.data());
  }
  [[nodiscard]] std::uint32_t inside_count() const noexcept { return inside_count_; }
  /// [rt] The points that entered in this tick, at most kMaxEntries.
  [[nodiscard]] std::span<const EntryEvent> entries() const noexcept {
    return {entries_.data(), entry_count_};
  }
  static constexpr std::size_t kMaxEntries = 64;

  /// [rt] Where a point entered the organ in this tick, on a straight path; none if it did not.
  [[nodiscard]] std::optional<SurfacePoint> entry_of(std::size_t point) const noexcept;

  [[nodiscard]] bool has_pose() const noexcept { return placed_; }
  /// [rt] The part's frame in the organ's, in this tick.
  [[nodiscard]] const RigidTransform& placed_S() const noexcept { return placed_S_; }
  /// [rt] A point's position in this tick.
  [[nodiscard]] Vec3 point_S(std::size_t point) const noexcept { return placed_S_ * points_->point(point); }
  /// [rt] Motion in this tick [m] of the part's material that is now at `point_S`.
  [[nodiscard]] Vec3 motion_at(const Vec3& point_S) const noexcept {
    const Vec3 point_P = placed_S_.inverse_transform(point_S);
    return placed_S_ * point_P - previous_S_ * point_P;  // exactly 0 at rest
  }
  /// [rt] Sum over the ticks of the largest motion of any point [m].
  [[nodiscard]] double odometer() const noexcept { return odometer_; }

 private:
  struct Cached {
    double distance = 0.0;  // signed, at the last query, or a positive lower bound [m]
    double odometer = 0.0;  // at the last query [m]
    std::int32_t triangle = -1;
  };
  /// A sphere outside the organ, with none of its surface inside. It rests in S, and the part moves in it.
  struct ClearanceSphere {
    Vec3 centre_S = Vec3::Zero();
    double radius = 0.0;  // [m]; not positive: none
  };
  /// Bounds of a cluster's points, as odometer values.
  struct ClusterBound {
    double crossing = 0.0;  // no point can have crossed the surface before this
    double least = 0.0;     // minus the odometer: lower bound of the points' distances [m]
    bool deferred = false;  // points may have crossed in an earlier tick
  };

  [[nodiscard]] double largest_motion() const noexcept;
  [[nodiscard]] bool may_have_crossed(std::size_t point) const noexcept {
    const Cached& cached = cached_[point];
    return std::abs(cached.distance - kInside) <= odometer_ - cached.odometer;
  }
  bool place(const Pose& pose_S, double period) noexcept;
  void reset() noexcept;
  void find_crossings(std::span<const Vec3> contacts_S, double reach) noexcept;
  bool stays_outside(std::size_t point) noexcept;
  void query_crossed(std::size_t point) noexcept;
  void query_cluster(std::size_t cluster) noexcept;
  bool settle_by_sphere(std::size_t cluster) noexcept;
  double resolve(std::size_t cluster) noexcept;
  void cache_from(std::size_t point, const geometry::NearestPoint& nearest, double way) noexcept;
  void query_centre(std::size_t cluster) noexcept;
  void bound_cluster(std::size_t cluster) noexcept;
  void renew_sphere() noexcept;
  /// Lower bound of the distance of a point in the clearance sphere [m]; not positive outside the sphere.
  [[nodiscard]] double sphere_bound(std::size_t point) const noexcept {
    return sphere_.radius - (point_S(point) - sphere_.centre_S).norm() - kBoundSlack;
  }
  std::size_t count_nearer(std::size_t cluster, double wanted) noexcept;
  void query_nearer(std::size_t point) noexcept;
  void query_likeliest(double enough) noexcept;
  [[nodiscard]] bool is_out_of_reach(std::size_t cluster, double reach) const noexcept {
    return bounds_[cluster].least - odometer_ > reach + kBoundSlack;
  }
  void set_inside(std::size_t point, double distance) noexcept;

  const OrganSurface* surface_;
  const PartPoints* points_;
  RigidTransform placed_S_;
  RigidTransform previous_S_;  // in the last tick
  bool placed_ = false;
  bool sides_known_ = true;
  double odometer_ = 0.0;
  double motion_ = 0.0;         // added to the odometer in this tick
  double next_crossing_ = 0.0;  // smallest `crossing` of all clusters
  std::uint32_t inside_count_ = 0;
  std::uint32_t nearest_point_ = 0;
  geometry::NearestPoint nearest_;
  ClearanceSphere sphere_;
  std::vector<ClusterBound> bounds_;
  std::vector<Cached> cached_;
  std::vector<std::uint8_t> inside_;  // 1: inside
  std::size_t entry_count_ = 0;
  std::array<EntryEvent, kMaxEntries> entries_{};
};

}  // namespace palpate::contact
