#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "palpate/mesh.h"

namespace palpate::deform {

/// A surface as fronts run over it: single precision, and the triangles around each vertex.
struct FrontSurface {
  /// [setup] The mesh may be open.
  explicit FrontSurface(const geometry::TriangleMesh& mesh);

  struct Corner {  // the two other corners of a triangle
    std::int32_t p, q;
  };
  std::vector<Eigen::Vector3f> vertices;  // [m]
  std::vector<std::int32_t> start;        // of each vertex's entries in around
  std::vector<Corner> around;
};

/// Distances along a surface from one point, found outwards step by step, so that a picture's frame can take
/// as many steps as it has time for; after advance(limit) has ended all vertices nearer than the limit are
/// settled. A way past a vertex farther away than the limit is found once the front goes on to that vertex.
///
/// A vertex takes the shortest of the ways through its triangles: the two other corners' distances place the
/// source in the triangle's plane (unfolded), and the straight line from there counts when it crosses the
/// edge between them (Novotni and Klein 2002); else the way along an edge. A vertex whose distance falls
/// later is propagated again, so obtuse triangles and slivers need no special care, and a flat surface comes
/// out exact but for rounding. Along edges alone (Dijkstra) the distance would be up to 15 % too long, by
/// direction.
class GeodesicFront final {
 public:
  /// [setup] The surface must outlive the front.
  explicit GeodesicFront(const FrontSurface& surface);

  /// [any] Begins at a point of a triangle with these corners; forgets what it knew.
  void begin(const geometry::Triangle& corners, const Eigen::Vector3f& point);

  /// [any] Takes up to `most` steps, a vertex each, while vertices nearer than `limit` [m] are left.
  /// @return the steps taken
  int advance(float limit, int most);

  /// [any] All vertices nearer than this [m] are settled; infinity when none is left.
  [[nodiscard]] float radius() const noexcept;
  /// [any] Settled vertices, nearest first but for rounding and obtuse triangles: one whose distance has
  /// fallen since is there again.
  [[nodiscard]] std::span<const std::int32_t> settled() const noexcept { return settled_; }
  /// [any] How much longer [m] than straight the way to each vertex is; infinite where the front has not
  /// come, and in the entries that fill up to a multiple of kLanes.
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
  std::vector<std::int32_t> seen_;  // vertices whose entries above are not as at the beginning
  std::vector<std::int32_t> settled_;
  std::vector<std::pair<float, std::int32_t>> queue_;  // heap, nearest first; may hold outdated entries
};

}  // namespace palpate::deform
