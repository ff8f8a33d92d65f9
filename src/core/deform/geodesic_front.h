#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "palpate/mesh.h"

namespace palpate::deform {

/// A surface for geodesic fronts: single precision, with the triangles around each vertex.
struct FrontSurface {
  /// [setup] The mesh may be open.
  explicit FrontSurface(const geometry::TriangleMesh& mesh);

  struct Corner {  // the two other corners of a triangle
    std::int32_t p, q;
  };
  std::vector<Eigen::Vector3f> vertices;  // [m]
  std::vector<std::int32_t> start;        // per vertex: start of its entries in around
  std::vector<Corner> around;
};

/// Geodesic distances from one point, computed outwards step by step, so that a frame can spend a limited
/// number of steps. When advance(limit) has finished, all vertices nearer than the limit are settled. A path
/// past a vertex beyond the limit is found only when the front passes that vertex.
///
/// A vertex takes the shortest path through its triangles (Novotni and Klein 2002).
/// The distances of the two other corners place the source in the unfolded plane of the triangle. The
/// straight line from there counts when it crosses the edge between them; otherwise the path along an edge
/// counts. A vertex whose distance falls later is propagated again, so obtuse triangles and slivers need no
/// special treatment. Distances on a flat surface are exact up to rounding. Distances along edges only
/// (Dijkstra) would be up to 15 % too long.
class GeodesicFront final {
 public:
  /// [setup] The surface must outlive the front.
  explicit GeodesicFront(const FrontSurface& surface);

  /// [any] Starts again at a point of a triangle with these corners.
  void begin(const geometry::Triangle& corners, const Eigen::Vector3f& point);

  /// [any] Settles up to `most` vertices while vertices nearer than `limit` [m] remain.
  /// @return the number of settled vertices
  int advance(float limit, int most);

  /// [any] All vertices nearer than this [m] are settled; infinity when none remains.
  [[nodiscard]] float radius() const noexcept;
  /// [any] Settled vertices, nearest first up to rounding and obtuse triangles. A vertex whose distance fell
  /// later appears again.
  [[nodiscard]] std::span<const std::int32_t> settled() const noexcept { return settled_; }
  /// [any] Geodesic minus straight distance [m] per vertex; infinity where the front has not come, and in the
  /// padding up to a multiple of kLanes.
  [[nodiscard]] std::span<const float> excess() const noexcept { return excess_; }
  /// [any] Distance of a settled vertex [m]; infinity where the front has not come.
  [[nodiscard]] float distance_of(std::int32_t vertex) const noexcept {
    return distance_[static_cast<std::size_t>(vertex)];
  }
  [[nodiscard]] const Eigen::Vector3f& source() const noexcept { return source_; }

 private:
  void offer(std::int32_t vertex, float distance);
  void relax(std::int32_t from, std::int32_t known, std::int32_t to);

  const FrontSurface* surface_;
  Eigen::Vector3f source_ = Eigen::Vector3f::Zero();
  std::vector<float> distance_;
  std::vector<float> excess_;
  std::vector<std::int32_t> seen_;  // vertices with changed entries above
  std::vector<std::int32_t> settled_;
  std::vector<std::pair<float, std::int32_t>> queue_;  // heap, nearest first; may hold outdated entries
};

}  // namespace palpate::deform
