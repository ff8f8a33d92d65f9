#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/contact/organ_arrays.h"
#include "core/geometry/surface_distance.h"
#include "palpate/mesh.h"
#include "palpate/preparation.h"

namespace palpate::contact {

/// A place on the rest surface. Organ frame.
struct SurfacePoint {
  Vec3 point = Vec3::Zero();
  std::int32_t triangle = -1;
};

/// The organ's rest surface as contact sees it: refined, with normals that do not show the mesh, and a way to
/// walk on it. Everything is in the organ's frame S, metres.
class OrganSurface final {
 public:
  /// [setup] Refines `organ` until edges are at most R_ref/5 and averages its normals within R_ref/2, on all
  /// processors; the same bits on any number of them, and from the cache. No thread of it is left at the end.
  /// @throws InputError as geometry::SurfaceDistance.
  OrganSurface(const geometry::TriangleMesh& organ, double reference_radius, const Preparation& how = {});

  [[nodiscard]] const geometry::TriangleMesh& mesh() const noexcept { return arrays_.mesh; }
  [[nodiscard]] const OrganArrays& arrays() const noexcept { return arrays_; }

  /// [rt] Nearest surface point to p, signed; `guess` as geometry::SurfaceDistance::nearest.
  [[nodiscard]] geometry::NearestPoint nearest(const Vec3& p, std::int32_t guess) const noexcept {
    return distance_.nearest(p, guess);
  }

  /// [rt] How far p is from the surface at least; as geometry::SurfaceDistance::clearance.
  [[nodiscard]] geometry::Clearance clearance(const Vec3& p, std::int32_t guess) const noexcept {
    return distance_.clearance(p, guess);
  }

  /// [rt] Where the segment from a to b first goes in.
  [[nodiscard]] std::optional<geometry::Entry> first_entry(const Vec3& a, const Vec3& b) const noexcept {
    return distance_.first_entry(a, b);
  }

  /// [rt] Unit outward normal at a surface point: the area-weighted mean of the face normals within R_ref/2,
  /// weight 1 - (r/h)^2, without faces turned more than 60 degrees; across sharper edges the two sides blend
  /// within 1 mm, weight (1 - d/1 mm)^2 (model.md, section 4).
  [[nodiscard]] Vec3 normal_at(const SurfacePoint& at) const noexcept;

  /// [rt] Goes from `from` by `step` [m], a vector in the tangent plane of `normal`, straight on over edges
  /// (the triangles unfolded), never off the surface. Only neighbours are visited, so the far side is never
  /// reached by a jump.
  [[nodiscard]] SurfacePoint walk(const SurfacePoint& from, const Vec3& step,
                                  const Vec3& normal) const noexcept;

  /// [rt] Unit normal of a triangle's plane.
  [[nodiscard]] const Vec3& face_normal(std::int32_t triangle) const noexcept {
    return arrays_.face_normals[static_cast<std::size_t>(triangle)];
  }

 private:
  struct Prepared {
    OrganArrays arrays;
    geometry::SurfaceDistance distance;
  };
  [[nodiscard]] static Prepared prepare(const geometry::TriangleMesh& organ, double reference_radius,
                                        const Preparation& how);
  explicit OrganSurface(Prepared&& prepared);

  [[nodiscard]] Vec3 smooth_normal(std::int32_t triangle, const Vec3& point) const noexcept;
  [[nodiscard]] std::array<double, 3> barycentric(std::int32_t triangle, const Vec3& point) const noexcept;

  OrganArrays arrays_;
  geometry::SurfaceDistance distance_;
};

}  // namespace palpate::contact
