#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// The point of a surface nearest to a query point.
struct NearestPoint {
  double distance = 0.0;      // signed [m]: negative inside
  Vec3 point = Vec3::Zero();  // on the surface [m]
  Vec3 normal =
      Vec3::UnitZ();  // unit: of the face, edge or vertex that is nearest (angle-weighted pseudonormal)
  std::int32_t triangle = -1;
};

/// What SurfaceDistance::clearance finds of the distance, at least.
inline constexpr double kClearanceShare = 0.6;

/// A bound of a distance.
struct Clearance {
  double least = 0.0;          // no point of the surface is nearer [m]; 0 when the query point is not finite
  std::int32_t triangle = -1;  // a near one: a guess for the next query
};

/// Where a segment first goes into the surface (crosses a triangle from outside to inside).
struct Entry {
  double fraction = 0.0;  // 0 at the segment's start, 1 at its end
  Vec3 point = Vec3::Zero();
  std::int32_t triangle = -1;
};

/// Exact signed distance and nearest point on a closed, outward-oriented surface, by a bounding-volume tree.
/// The sign comes from angle-weighted pseudonormals (Baerentzen and Aanaes 2005) and so is right at edges and
/// corners.
class SurfaceDistance final {
 public:
  /// [setup] Builds the tree; copies what it needs. @throws InputError when the mesh is empty, not closed or
  /// has edges that are not shared by exactly two triangles running opposite ways.
  explicit SurfaceDistance(const TriangleMesh& mesh);
  ~SurfaceDistance();
  SurfaceDistance(SurfaceDistance&&) noexcept;
  SurfaceDistance& operator=(SurfaceDistance&&) noexcept;

  /// [rt] Nearest point to p; of equally near ones the triangle with the smallest index.
  [[nodiscard]] NearestPoint nearest(const Vec3& p) const noexcept;

  /// [rt] As nearest(), but `guess` (a triangle that was nearest a moment ago, or -1) may speed it up; same
  /// answer.
  [[nodiscard]] NearestPoint nearest(const Vec3& p, std::int32_t guess) const noexcept;

  /// [rt] How far p is from the surface at least: no less than kClearanceShare of its distance, without the
  /// sign, and several times cheaper than nearest() where much of the surface is about as far.
  /// @param guess as of nearest()
  [[nodiscard]] Clearance clearance(const Vec3& p, std::int32_t guess) const noexcept;

  /// [rt] First crossing from outside to inside along the segment from a to b, if any.
  [[nodiscard]] std::optional<Entry> first_entry(const Vec3& a, const Vec3& b) const noexcept;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

/// [setup] Nearest point of one triangle (a, b, c) to p. Exposed for tests and oracles. [rt]
[[nodiscard]] Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

}  // namespace palpate::geometry
