#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/organ_surface.h"
#include "palpate/mesh.h"

namespace palpate::deform {

/// Finds triangles near a point or along a ray with a grid of cells about two edges wide. Each cell lists the
/// triangles whose bounding boxes touch it. The mesh may be open. It must outlive the grid.
class TriangleGrid final {
 public:
  /// [setup]
  explicit TriangleGrid(const geometry::TriangleMesh& mesh);

  /// [any] The surface point nearest to p; among equally near triangles the first. Triangle -1 for an empty
  /// mesh.
  [[nodiscard]] contact::SurfacePoint nearest(const Vec3& p) const;

  /// [any] Distance [m] from a point along a unit direction to the first triangle that faces in that
  /// direction (the far side of an organ), if it is nearer than `limit` [m]; otherwise infinity. Triangles
  /// through the start itself do not count.
  [[nodiscard]] double far_side(const Vec3& start, const Vec3& direction, double limit) const;

 private:
  using Cell = std::array<int, 3>;
  [[nodiscard]] Cell cell_of(const Vec3& p) const noexcept;  // clamped into the grid
  [[nodiscard]] std::size_t place(const Cell& c) const noexcept;
  void nearest_in(const Cell& c, const Vec3& p, contact::SurfacePoint& best, double& best_squared) const;

  const geometry::TriangleMesh& mesh_;
  Vec3 low_ = Vec3::Zero();
  double width_ = 1.0;  // of a cell [m]
  Cell count_{1, 1, 1};
  std::vector<std::int32_t> start_;  // per cell: start of its triangles in inside_
  std::vector<std::int32_t> inside_;
};

}  // namespace palpate::deform
