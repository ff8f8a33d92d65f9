#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// The point of a surface nearest to a query point.
struct NearestPoint {
  double distance = 0.0;      // signed [m]: negative inside
  Vec3 point = Vec3::Zero();  // on the surface [m]
  Vec3 normal =
      Vec3::UnitZ();  // unit normal of the nearest face, edge or vertex (angle-weighted pseudonormal)
  std::int32_t triangle = -1;
};

/// SignedDistance::clearance returns at least this fraction of the distance.
inline constexpr double kClearanceShare = 0.6;

/// A lower bound of a distance.
struct Clearance {
  double least = 0.0;          // no surface point is nearer [m]; 0 when the query point is not finite
  std::int32_t triangle = -1;  // a near triangle, as guess for the next query
};

/// Where a segment first enters the surface, crossing a triangle from outside to inside.
struct Entry {
  double fraction = 0.0;  // 0 at the segment's start, 1 at its end
  Vec3 point = Vec3::Zero();
  std::int32_t triangle = -1;
};

/// Exact signed distance and nearest point on a closed, outward-oriented surface, by a bounding-volume
/// hierarchy. The sign comes from angle-weighted pseudonormals (Baerentzen and Aanaes 2005), so it is right
/// at edges and corners. A value that never changes; copies share the hierarchy.
class SignedDistance final {
 public:
  /// [setup] Builds the hierarchy; copies what it needs. @throws InputError when the mesh is empty or not
  /// closed, or an edge is not shared by exactly two triangles of opposite direction.
  explicit SignedDistance(const TriangleMesh& mesh);

  /// [any] Number of hierarchies that this process has built; for tests.
  [[nodiscard]] static std::uint64_t builds() noexcept;

  /// [any] The mesh that it was built from, and its edge_neighbours(). They stay where they are as long as a
  /// copy exists.
  [[nodiscard]] const TriangleMesh& mesh() const noexcept;
  [[nodiscard]] const std::vector<std::array<std::int32_t, 3>>& neighbours() const noexcept;

  /// [setup] Whether it was built from a mesh with the same vertices and triangles.
  [[nodiscard]] bool is_of(const TriangleMesh& mesh) const;

  /// [rt] The nearest point to p; among equally near ones that of the triangle with the smallest index.
  [[nodiscard]] NearestPoint nearest(const Vec3& p) const noexcept;

  /// [rt] As nearest(). `guess` (the nearest triangle of the last query, or -1) speeds it up; the result is
  /// the same.
  [[nodiscard]] NearestPoint nearest(const Vec3& p, std::int32_t guess) const noexcept;

  /// [rt] A lower bound of the unsigned distance of p, at least kClearanceShare of it. Several times faster
  /// than nearest() where much of the surface is about equally far.
  /// @param guess as in nearest()
  [[nodiscard]] Clearance clearance(const Vec3& p, std::int32_t guess) const noexcept;

  /// [rt] The first crossing from outside to inside along the segment from a to b, if any.
  [[nodiscard]] std::optional<Entry> first_entry(const Vec3& a, const Vec3& b) const noexcept;

 private:
  struct Tree;
  std::shared_ptr<const Tree> tree_;
};

/// [rt] The point of triangle (a, b, c) nearest to p. Public for tests.
[[nodiscard]] Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

}  // namespace palpate::geometry
