#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "core/contact/organ_arrays.h"
#include "core/geometry/signed_distance.h"
#include "palpate/mesh.h"
#include "palpate/preparation.h"

namespace palpate::contact {

/// Returns the signed distance of a refined organ.
using DistanceOf = std::function<geometry::SignedDistance(const geometry::TriangleMesh& refined)>;

/// [setup] Builds the signed distance; the default of DistanceOf.
[[nodiscard]] inline geometry::SignedDistance build_distance(const geometry::TriangleMesh& refined) {
  return geometry::SignedDistance(refined);
}

/// A point on the rest surface, organ frame.
struct SurfacePoint {
  Vec3 point = Vec3::Zero();
  std::int32_t triangle = -1;
};

/// The organ's refined rest surface: distances, averaged normals without steps at edges, and walks along it.
/// Organ frame S, metres.
class OrganSurface final {
 public:
  /// [setup] Refines `organ` until its edges are at most R_ref/5 and averages its normals within R_ref/2.
  /// Uses all processors; its threads end before it returns. Gives the same bits on any number of processors
  /// and from the cache.
  /// @throws InputError as geometry::SignedDistance.
  OrganSurface(const geometry::TriangleMesh& organ, double reference_radius, const Preparation& how = {},
               const DistanceOf& distance_of = build_distance);

  [[nodiscard]] const geometry::TriangleMesh& mesh() const noexcept { return *mesh_; }
  /// [setup] A copy of all arrays.
  [[nodiscard]] OrganArrays arrays() const;
  [[nodiscard]] const geometry::SignedDistance& distance() const noexcept { return distance_; }

  /// [rt] The surface point nearest to p, with signed distance; `guess` as in
  /// geometry::SignedDistance::nearest.
  [[nodiscard]] geometry::NearestPoint nearest(const Vec3& p, std::int32_t guess) const noexcept {
    return distance_.nearest(p, guess);
  }

  /// [rt] A lower bound of p's distance; see geometry::SignedDistance::clearance.
  [[nodiscard]] geometry::Clearance clearance(const Vec3& p, std::int32_t guess) const noexcept {
    return distance_.clearance(p, guess);
  }

  /// [rt] Where the segment from a to b first enters the organ.
  [[nodiscard]] std::optional<geometry::Entry> first_entry(const Vec3& a, const Vec3& b) const noexcept {
    return distance_.first_entry(a, b);
  }

  /// [rt] Unit outward normal at a surface point: area-weighted mean of the face normals within h = R_ref/2,
  /// weight 1 - (r/h)^2, without faces turned by more than 60 degrees. At sharper edges the two sides blend
  /// within 1 mm, weight (1 - d/1 mm)^2 (docs/model.md, section 4).
  [[nodiscard]] Vec3 normal_at(const SurfacePoint& at) const noexcept;

  /// [rt] Moves from `from` along the surface by `step` [m], a vector in the tangent plane of `normal`,
  /// straight over edges (triangles unfolded). Only neighbouring triangles are visited, so it never jumps to
  /// the far side of the organ.
  [[nodiscard]] SurfacePoint walk(const SurfacePoint& from, const Vec3& step,
                                  const Vec3& normal) const noexcept;

  /// [rt] Unit normal of a triangle.
  [[nodiscard]] Vec3 face_normal(std::int32_t triangle) const noexcept {
    return geometry::area_vector_doubled(*mesh_, mesh_->triangles[static_cast<std::size_t>(triangle)])
        .normalized();
  }

 private:
  struct Prepared {
    OrganArrays arrays;
    geometry::SignedDistance distance;
  };
  [[nodiscard]] static Prepared prepare(const geometry::TriangleMesh& organ, double reference_radius,
                                        const Preparation& how, const DistanceOf& distance_of);
  explicit OrganSurface(Prepared&& prepared);

  [[nodiscard]] Vec3 smooth_normal(std::int32_t triangle, const Vec3& point) const noexcept;
  [[nodiscard]] std::array<double, 3> barycentric(std::int32_t triangle, const Vec3& point) const noexcept;

  OrganArrays arrays_;  // without mesh and neighbours, which are those of the distance
  geometry::SignedDistance distance_;
  const geometry::TriangleMesh* mesh_;
  const std::vector<std::array<std::int32_t, 3>>* neighbours_;
};

}  // namespace palpate::contact
