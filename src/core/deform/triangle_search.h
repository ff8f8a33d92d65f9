#pragma once
#include <optional>

#include "core/contact/organ_surface.h"
#include "core/geometry/disc_bvh.h"
#include "palpate/mesh.h"

namespace palpate::deform {

/// Finds triangles near a point or along a ray. The mesh may be open or empty. It must outlive the search.
class TriangleSearch final {
 public:
  /// [setup]
  explicit TriangleSearch(const geometry::TriangleMesh& mesh);

  /// [any] The surface point nearest to p; among equally near triangles the first. Triangle -1 for an empty
  /// mesh.
  [[nodiscard]] contact::SurfacePoint nearest(const Vec3& p) const;

  /// [any] Distance [m] from a point along a unit direction to the first triangle that faces in that
  /// direction (the far side of an organ), if it is nearer than `limit` [m]; otherwise infinity. Triangles
  /// through the start itself do not count.
  [[nodiscard]] double far_side(const Vec3& start, const Vec3& direction, double limit) const;

 private:
  const geometry::TriangleMesh& mesh_;
  std::optional<geometry::DiscBvh> discs_;  // none: an empty mesh
};

}  // namespace palpate::deform
