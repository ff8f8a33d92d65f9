#include "core/contact/organ_surface.h"

#include <algorithm>
#include <utility>

#include "core/base/index.h"
#include "core/contact/averaged_normals.h"
#include "core/contact/segment.h"

namespace palpate::contact {
namespace {

constexpr int kMaxCrossings = 64;  // edges that one walk may cross; real steps cross far fewer

/// Normals of the sides beyond nearby sharp edges. Edges of one chain lead to the same side: the nearest one
/// counts.
class OtherSides final {
 public:
  void add(const Vec3& normal, double share) noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (normals_[i].dot(normal) < kSharpCosine) continue;
      if (share > shares_[i]) {
        shares_[i] = share;
        normals_[i] = normal;
      }
      return;
    }
    if (count_ == normals_.size()) return;  // at a spike four sides are enough
    normals_[count_] = normal;
    shares_[count_++] = share;
  }

  [[nodiscard]] Vec3 sum(Vec3 own) const noexcept {
    for (std::size_t i = 0; i < count_; ++i) own += shares_[i] * normals_[i];
    return own;
  }

 private:
  std::array<Vec3, 4> normals_;
  std::array<double, 4> shares_{};
  std::size_t count_ = 0;
};

}  // namespace

OrganSurface::OrganSurface(const geometry::TriangleMesh& organ, double reference_radius,
                           const Preparation& how, const DistanceOf& distance_of)
    : OrganSurface(prepare(organ, reference_radius, how, distance_of)) {}

OrganSurface::OrganSurface(Prepared&& prepared)
    : arrays_(std::move(prepared.arrays)),
      distance_(std::move(prepared.distance)),
      mesh_(&distance_.mesh()),
      neighbours_(&distance_.neighbours()) {}

OrganArrays OrganSurface::arrays() const {
  OrganArrays all = arrays_;
  all.mesh = *mesh_;
  all.neighbours = *neighbours_;
  return all;
}

std::array<double, 3> OrganSurface::barycentric(std::int32_t triangle, const Vec3& point) const noexcept {
  const geometry::Triangle& corners = mesh_->triangles[at(triangle)];
  const Vec3& a = mesh_->vertices[at(corners[0])];
  const Vec3 ab = mesh_->vertices[at(corners[1])] - a;
  const Vec3 ac = mesh_->vertices[at(corners[2])] - a;
  const Vec3 ap = point - a;
  const Vec3 doubled = ab.cross(ac);
  const double area = doubled.squaredNorm();
  if (!(area > 0.0)) return {1.0, 0.0, 0.0};
  const double v = std::clamp(ap.cross(ac).dot(doubled) / area, 0.0, 1.0);
  const double w = std::clamp(ab.cross(ap).dot(doubled) / area, 0.0, 1.0 - v);
  return {1.0 - v - w, v, w};
}

Vec3 OrganSurface::smooth_normal(std::int32_t triangle, const Vec3& point) const noexcept {
  const std::array<double, 3> weight = barycentric(triangle, point);
  const std::int32_t row = arrays_.row_of[at(triangle)];
  const std::array<std::int32_t, 3>& side =
      row < 0 ? mesh_->triangles[at(triangle)] : arrays_.side_rows[at(row)];
  Vec3 sum = weight[0] * arrays_.normals[at(side[0])] + weight[1] * arrays_.normals[at(side[1])] +
             weight[2] * arrays_.normals[at(side[2])];
  const NormalBends& bends = arrays_.bends[at(triangle)];
  for (std::size_t e = 0; e < 3; ++e) {
    const double share = weight[e] * weight[(e + 1) % 3] * kBendUnit;
    sum += share * Vec3(bends[e][0], bends[e][1], bends[e][2]);
  }
  return sum.normalized();
}

Vec3 OrganSurface::normal_at(const SurfacePoint& where) const noexcept {
  const Vec3 own = smooth_normal(where.triangle, where.point);
  OtherSides others;
  const std::int32_t end = arrays_.sharp_start[at(where.triangle) + 1];
  for (std::int32_t i = arrays_.sharp_start[at(where.triangle)]; i < end; ++i) {
    const SharpEdge& sharp = arrays_.sharp_edges[at(arrays_.sharp_near[at(i)])];
    const geometry::Triangle& corners = mesh_->triangles[at(sharp.triangle[0])];
    const Vec3& a = mesh_->vertices[at(corners[at(sharp.edge[0])])];
    const Vec3& b = mesh_->vertices[at(corners[at((sharp.edge[0] + 1) % 3)])];
    double along = 0.0;
    const double distance = distance_to_segment(where.point, a, b, along);
    if (distance >= kBlendWidth) continue;
    const Vec3 on_edge = a + along * (b - a);
    const Vec3 side0 = smooth_normal(sharp.triangle[0], on_edge);
    const Vec3 side1 = smooth_normal(sharp.triangle[1], on_edge);
    const bool own_is_0 = own.dot(side0) >= own.dot(side1);
    if (own.dot(own_is_0 ? side0 : side1) < kSharpCosine) continue;  // an edge of another side
    const double closeness = 1.0 - distance / kBlendWidth;
    others.add(own_is_0 ? side1 : side0, closeness * closeness);
  }
  const Vec3 sum = others.sum(own);
  const double length = sum.norm();
  return length > 0.1 ? Vec3(sum / length) : own;
}

SurfacePoint OrganSurface::walk(const SurfacePoint& from, const Vec3& step,
                                const Vec3& normal) const noexcept {
  SurfacePoint here = from;
  // Rotate the step from the tangent plane of `normal` into the triangle's plane; its length stays.
  Vec3 face = face_normal(here.triangle);
  const double one_plus_cosine = 1.0 + normal.dot(face);
  if (one_plus_cosine < 1e-3) return here;  // opposite normals: the direction is undefined
  Vec3 left = step - (face.dot(step) / one_plus_cosine) * (normal + face);
  std::int32_t came_from = -1;
  for (int crossing = 0; crossing < kMaxCrossings; ++crossing) {
    const geometry::Triangle& corners = mesh_->triangles[at(here.triangle)];
    double stop = 1.0;
    int exit_edge = -1;
    for (int e = 0; e < 3; ++e) {
      if (came_from >= 0 && (*neighbours_)[at(here.triangle)][at(e)] == came_from) continue;
      const Vec3& a = mesh_->vertices[at(corners[at(e)])];
      const Vec3& b = mesh_->vertices[at(corners[at((e + 1) % 3)])];
      const Vec3 outward = (b - a).cross(face);  // in the plane, perpendicular to the edge
      const double speed = outward.dot(left);
      if (speed <= 0.0) continue;
      const double fraction = std::max(0.0, outward.dot(a - here.point) / speed);
      if (fraction < stop) {
        stop = fraction;
        exit_edge = e;
      }
    }
    here.point += stop * left;
    if (exit_edge < 0) return here;
    const std::int32_t next = (*neighbours_)[at(here.triangle)][at(exit_edge)];
    if (next < 0) return here;
    left *= 1.0 - stop;
    // Unfold: keep the component along the edge, rotate the one across it into the next triangle's plane.
    const Vec3& a = mesh_->vertices[at(corners[at(exit_edge)])];
    const Vec3 edge = (mesh_->vertices[at(corners[at((exit_edge + 1) % 3)])] - a).normalized();
    const Vec3 across = edge.cross(face);
    face = face_normal(next);
    left = left.dot(edge) * edge + left.dot(across) * edge.cross(face);
    here.point = a + (here.point - a).dot(edge) * edge;  // back onto the edge, so that errors do not add up
    came_from = here.triangle;
    here.triangle = next;
  }
  return here;
}

}  // namespace palpate::contact
