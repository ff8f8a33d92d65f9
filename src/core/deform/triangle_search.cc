#include "core/deform/triangle_search.h"

#include <algorithm>

#include "core/base/index.h"
#include "core/base/infinity.h"
#include "core/geometry/disc_search.h"
#include "core/geometry/ray.h"
#include "core/geometry/signed_distance.h"

namespace palpate::deform {

TriangleSearch::TriangleSearch(const geometry::TriangleMesh& mesh) : mesh_(mesh) {
  if (!mesh.triangles.empty()) discs_.emplace(mesh);
}

contact::SurfacePoint TriangleSearch::nearest(const Vec3& p) const {
  contact::SurfacePoint best;
  double best_squared = kInfinity;
  if (!discs_ || !p.allFinite()) return best;
  discs_->each_within(
      p,
      [&](std::int32_t slot) {
        const std::int32_t t = discs_->triangle_of()[at(slot)];
        const auto [a, b, c] = mesh_.triangles[at(t)];
        const Vec3 q = geometry::nearest_on_triangle(p, mesh_.vertices[at(a)], mesh_.vertices[at(b)],
                                                     mesh_.vertices[at(c)]);
        const double squared = (q - p).squaredNorm();
        if (squared > best_squared || (squared == best_squared && t > best.triangle)) return;
        best_squared = squared;
        best = {q, t};
      },
      [&best_squared] { return best_squared; });
  return best;
}

double TriangleSearch::far_side(const Vec3& start, const Vec3& direction, double limit) const {
  constexpr double kOwnFace = 1e-6;  // m; a nearer hit is the start's own triangle
  double nearest = kInfinity;
  if (!discs_ || !(limit > 0.0)) return nearest;
  discs_->each_along(start, start + limit * direction, 0.0, [&](std::int32_t slot) {
    const geometry::Triangle& triangle = mesh_.triangles[at(discs_->triangle_of()[at(slot)])];
    const double distance = geometry::distance_to_back(mesh_, triangle, {start, direction});
    if (distance > kOwnFace) nearest = std::min(nearest, distance);
  });
  return nearest <= limit ? nearest : kInfinity;
}

}  // namespace palpate::deform
