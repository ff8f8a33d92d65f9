#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "core/contact/organ_surface.h"
#include "core/contact/tool_points.h"

namespace palpate::contact {

/// A hand moves no faster than this [m/s]; a part that does has been placed anew (a reading that dropped out
/// and came back elsewhere).
inline constexpr double kFastestHand = 20.0;

/// A point is inside the organ when its signed distance is below this [m]: rounding must not make a tool that
/// just touches come and go.
inline constexpr double kInside = -1e-9;

/// A pose as a matrix: the same map, cheaper for many points.
struct RigidTransform {
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();

  [[nodiscard]] Vec3 operator*(const Vec3& p) const noexcept { return rotation * p + position; }
  [[nodiscard]] Vec3 turn_back(const Vec3& direction) const noexcept {
    return rotation.transpose() * direction;
  }
  [[nodiscard]] Vec3 bring_back(const Vec3& p) const noexcept { return turn_back(p - position); }
};

/// A tool point that went into the organ in this tick, and where.
struct EntryEvent {
  std::uint32_t point = 0;
  SurfacePoint at;
};

/// Signed distances from a rigid part's points to the organ, by conservative advancement [Mirtich 1996]: a
/// distance changes by no more than the part moves, so that a point is asked again only once the motion since
/// could have changed the answer. The answers are those of asking every point in every tick.
///
/// Invariants. The odometer sums the greatest motion of any point, relative to the organ. Since a point was
/// asked it has moved by no more than odometer_ - `odometer`. `distance` was its signed distance then, or of
/// an outside point a positive lower bound. After move(), `inside_` is right for every point that is not in a
/// deferred cluster, and each of them that went in on the way is among the entries, kMostEntries at most. A
/// cluster that was deferred until this move makes none.
class DistanceCache final {
 public:
  /// [setup] @param surface, points outlive it
  DistanceCache(const OrganSurface& surface, const PartPoints& points);

  /// [rt] Brings the part to `pose_S` (organ frame) and finds, exactly, the points that went in on the way,
  /// also right through.
  /// @param contacts_S places of the part's contacts: within `reference_radius` [m] of one no point starts
  /// another, so that clusters that lie there are deferred until it leaves
  /// @return false when the part was placed anew: it has no way here, and no entries
  bool move(const Pose& pose_S, double period, std::span<const Vec3> contacts_S,
            double reference_radius) noexcept;

  /// [rt] Finds the part's point nearest to the organ (the deepest, when some are inside), exactly.
  /// @param enough only what is nearer than this [m] is wanted: of a part that is not, nearest() is that of
  /// some point that is no nearer
  void find_nearest(double enough = std::numeric_limits<double>::infinity()) noexcept;
  /// [rt] What find_nearest() found last: the point, and its distance.
  [[nodiscard]] std::uint32_t nearest_point() const noexcept { return nearest_point_; }
  [[nodiscard]] const geometry::NearestPoint& nearest() const noexcept { return nearest_; }

  /// [rt] The exact distance of a point.
  geometry::NearestPoint ask(std::size_t point) noexcept;
  /// [rt] Bounds of the signed distance of a point [m]; greatest() of a point inside.
  [[nodiscard]] double least(std::size_t point) const noexcept {
    return cached_[point].distance - (odometer_ - cached_[point].odometer);
  }
  [[nodiscard]] double greatest(std::size_t point) const noexcept {
    return cached_[point].distance + (odometer_ - cached_[point].odometer);
  }

  [[nodiscard]] bool is_inside(std::size_t point) const noexcept { return inside_[point] != 0; }
  /// [rt] The first point inside, from `first` on and before `end`; `end` when there is none.
  [[nodiscard]] std::uint32_t next_inside(std::uint32_t first, std::uint32_t end) const noexcept {
    const void* const found = std::memchr(inside_.data() + first, 1, end - first);
    if (found == nullptr) return end;
    return static_cast<std::uint32_t>(static_cast<const std::uint8_t*>(found) - inside_.data());
  }
  [[nodiscard]] std::uint32_t inside_count() const noexcept { return inside_count_; }
  /// [rt] The points that went in during this tick, kMostEntries at most.
  [[nodiscard]] std::span<const EntryEvent> entries() const noexcept {
    return {entries_.data(), entry_count_};
  }
  static constexpr std::size_t kMostEntries = 64;

  [[nodiscard]] bool was_placed() const noexcept { return placed_; }
  /// [rt] Of the part's frame in the organ's, this tick.
  [[nodiscard]] const RigidTransform& placed_S() const noexcept { return placed_S_; }
  /// [rt] Where a point is now.
  [[nodiscard]] Vec3 point_S(std::size_t point) const noexcept { return placed_S_ * points_->point(point); }
  /// [rt] How far the part's material at `point_S` (where it is now) has moved in this tick [m].
  [[nodiscard]] Vec3 motion_at(const Vec3& point_S) const noexcept {
    const Vec3 point_P = placed_S_.bring_back(point_S);
    return placed_S_ * point_P - previous_S_ * point_P;  // exactly 0 at rest
  }
  /// [rt] The most that any point has moved so far, summed over the ticks [m].
  [[nodiscard]] double odometer() const noexcept { return odometer_; }

 private:
  struct Cached {
    double distance = 0.0;  // signed, when asked, or a lower bound > 0 [m]
    double odometer = 0.0;  // when asked [m]
    std::int32_t triangle = -1;
  };
  /// Bounds of a cluster's points, as readings of the odometer.
  struct ClusterBound {
    double crossing = 0.0;  // before this no point can have crossed the surface
    double least = 0.0;     // less the odometer: no point is nearer to the organ [m]
    bool deferred = false;  // points may have crossed in an earlier tick
  };

  [[nodiscard]] double greatest_motion() const noexcept;
  [[nodiscard]] bool may_have_crossed(std::size_t point) const noexcept {
    const Cached& cached = cached_[point];
    return std::abs(cached.distance - kInside) <= odometer_ - cached.odometer;
  }
  void reset() noexcept;
  void find_crossings(std::span<const Vec3> contacts_S, double reach) noexcept;
  bool stays_outside(std::size_t point) noexcept;
  void ask_crossed(std::size_t point) noexcept;
  void ask_cluster(std::size_t cluster) noexcept;
  void resolve(std::size_t cluster) noexcept;
  void take(std::size_t point, const geometry::NearestPoint& nearest, double way) noexcept;
  void ask_centre(std::size_t cluster) noexcept;
  void bound_cluster(std::size_t cluster) noexcept;
  void set_inside(std::size_t point, double distance) noexcept;

  const OrganSurface* surface_;
  const PartPoints* points_;
  RigidTransform placed_S_;
  RigidTransform previous_S_;  // last tick
  bool placed_ = false;
  double odometer_ = 0.0;
  double motion_ = 0.0;         // of it in this tick
  double next_crossing_ = 0.0;  // no cluster's is less
  std::uint32_t inside_count_ = 0;
  std::uint32_t nearest_point_ = 0;
  geometry::NearestPoint nearest_;
  std::vector<ClusterBound> bounds_;
  std::vector<Cached> cached_;
  std::vector<std::uint8_t> inside_;  // 1: inside
  std::size_t entry_count_ = 0;
  std::array<EntryEvent, kMostEntries> entries_{};
};

}  // namespace palpate::contact
