#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::deform {

/// Where a point lies on a surface.
struct SurfacePoint {
  std::int32_t triangle = -1;
  Vec3 point = Vec3::Zero();   // on that triangle [m]
  Vec3 normal = Vec3::Zero();  // unit, vertex normals interpolated; zero where the surface has none
};

/// Distances along a surface from one point of it, up to a limit.
///
/// A vertex takes the shortest of the ways through its triangles: the two other corners' distances place the
/// source in the triangle's plane (unfolded), and the straight line from there counts when it crosses the
/// edge between them (Novotni and Klein 2002); else the way along an edge. A vertex whose distance falls
/// later is propagated again, so obtuse triangles and slivers need no special care, and a flat surface comes
/// out exact. Along edges alone (Dijkstra) the distance would be up to 15 % too long, by direction.
class GeodesicDistance final {
 public:
  /// [setup] Copies the mesh and prepares adjacency. The mesh need be neither closed nor manifold.
  explicit GeodesicDistance(const geometry::TriangleMesh& mesh);

  /// [setup] The point of the surface nearest to p; of equally near triangles the first. O(triangles).
  [[nodiscard]] SurfacePoint nearest(const Vec3& p) const;

  /// [setup] Computes the distances from `source` of all vertices nearer than `limit` [m]; the former
  /// result is forgotten.
  void compute(const SurfacePoint& source, double limit);

  /// [any] Vertices nearer than the limit.
  [[nodiscard]] std::span<const std::int32_t> reached() const noexcept { return reached_; }
  /// [any] Distance of a vertex [m]; infinity beyond the limit.
  [[nodiscard]] double at(std::int32_t vertex) const noexcept {
    return distance_[static_cast<std::size_t>(vertex)];
  }

  [[nodiscard]] const geometry::TriangleMesh& mesh() const noexcept { return mesh_; }

 private:
  void offer(std::int32_t vertex, double distance);
  void relax(std::int32_t from, std::int32_t known, std::int32_t to);

  geometry::TriangleMesh mesh_;
  std::vector<Vec3> normals_;
  std::vector<std::int32_t> start_;     // of each vertex's triangles in incident_
  std::vector<std::int32_t> incident_;  // triangles of each vertex
  std::vector<double> distance_;        // infinity where not reached
  std::vector<std::int32_t> reached_;
  std::vector<std::pair<double, std::int32_t>> queue_;  // heap, smallest first; may hold outdated entries
  double longest_edge_ = 0.0;                           // [m]
  double limit_ = 0.0;                                  // of propagation [m]
};

}  // namespace palpate::deform
