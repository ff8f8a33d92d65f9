#include "palpate/contact/organ_surface.h"

#include <algorithm>
#include <cmath>

namespace palpate::contact {
namespace {

constexpr double kSharpCosine = 0.5;  // of 60 degrees: a face turned more belongs to another side
constexpr double kFullCosine = 0.65;  // of about 49 degrees: up to here a face counts in full
constexpr double kBlendWidth = 1e-3;  // m, over which the two sides of a sharp edge blend
constexpr std::size_t kMostTriangles =
    2'000'000;                      // of the refined surface: a 2 m organ is refined less finely
constexpr int kMostCrossings = 64;  // edges one walk may cross; a step is far shorter than that

std::size_t at(std::int32_t i) noexcept { return static_cast<std::size_t>(i); }

double total_area(const geometry::TriangleMesh& mesh) {
  double doubled = 0.0;
  for (const geometry::Triangle& triangle : mesh.triangles) {
    doubled += geometry::area_vector_doubled(mesh, triangle).norm();
  }
  return 0.5 * doubled;
}

geometry::TriangleMesh refined(const geometry::TriangleMesh& organ, double reference_radius) {
  // Longest-edge splitting leaves triangles of about a quarter of longest^2.
  const double affordable = std::sqrt(4.0 * total_area(organ) / static_cast<double>(kMostTriangles));
  return geometry::refine(organ, std::max(reference_radius / 4.0, affordable));
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b, double& along) noexcept {
  const Vec3 edge = b - a;
  const double length_squared = edge.squaredNorm();
  along = length_squared > 0.0 ? std::clamp((p - a).dot(edge) / length_squared, 0.0, 1.0) : 0.0;
  return (p - (a + along * edge)).norm();
}

/// The sides beyond the sharp edges near a point. Several edges of one line lead to one side: the nearest
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
    if (count_ == normals_.size()) return;  // a spike: what is there says enough
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

OrganSurface::OrganSurface(const geometry::TriangleMesh& organ, double reference_radius)
    : mesh_(refined(organ, reference_radius)),
      distance_(mesh_),
      neighbours_(geometry::edge_neighbours(mesh_)) {
  face_normals_.reserve(mesh_.triangles.size());
  for (const geometry::Triangle& triangle : mesh_.triangles) {
    face_normals_.push_back(geometry::area_vector_doubled(mesh_, triangle).normalized());
  }
  average_normals(reference_radius / 2.0);
  list_sharp_edges();
}

void OrganSurface::average_normals(double support_radius) {
  const std::size_t triangle_count = mesh_.triangles.size();
  corner_normals_.resize(triangle_count);
  std::vector<std::int32_t> visited_by(triangle_count, -1);
  std::vector<std::int32_t> queue;
  std::vector<std::int32_t> group;
  std::vector<std::array<bool, 3>> done(triangle_count, {false, false, false});
  std::int32_t visit = 0;
  for (std::size_t t = 0; t < triangle_count; ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      if (done[t][corner]) continue;
      const std::int32_t vertex = mesh_.triangles[t][corner];
      // The fan of triangles around the vertex on this side of sharp edges: one side, one normal.
      group.assign(1, static_cast<std::int32_t>(t));
      done[t][corner] = true;
      Vec3 reference = Vec3::Zero();
      for (std::size_t g = 0; g < group.size(); ++g) {
        const std::int32_t face = group[g];
        reference += geometry::area_vector_doubled(mesh_, mesh_.triangles[at(face)]);
        for (std::size_t e = 0; e < 3; ++e) {
          const geometry::Triangle& triangle = mesh_.triangles[at(face)];
          if (triangle[e] != vertex && triangle[(e + 1) % 3] != vertex) continue;
          const std::int32_t other = neighbours_[at(face)][e];
          if (other < 0 || face_normals_[at(face)].dot(face_normals_[at(other)]) < kSharpCosine) continue;
          const geometry::Triangle& next = mesh_.triangles[at(other)];
          const std::size_t c = next[0] == vertex ? 0U : (next[1] == vertex ? 1U : 2U);
          if (done[at(other)][c]) continue;
          done[at(other)][c] = true;
          group.push_back(other);
        }
      }
      reference.normalize();
      const Vec3 normal =
          averaged_normal(vertex, group, reference, support_radius, visited_by, visit++, queue);
      for (const std::int32_t face : group) {
        const geometry::Triangle& triangle = mesh_.triangles[at(face)];
        for (std::size_t c = 0; c < 3; ++c) {
          if (triangle[c] == vertex) corner_normals_[at(face)][c] = normal;
        }
      }
    }
  }
}

Vec3 OrganSurface::averaged_normal(std::int32_t vertex, std::span<const std::int32_t> seeds,
                                   const Vec3& reference, double support_radius,
                                   std::vector<std::int32_t>& visited_by, std::int32_t visit,
                                   std::vector<std::int32_t>& queue) const {
  const Vec3 centre = mesh_.vertices[at(vertex)];
  const double radius_squared = support_radius * support_radius;
  queue.assign(seeds.begin(), seeds.end());
  for (const std::int32_t face : seeds) visited_by[at(face)] = visit;
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::int32_t face = queue[i];
    const geometry::Triangle& triangle = mesh_.triangles[at(face)];
    const Vec3& a = mesh_.vertices[at(triangle[0])];
    const Vec3& b = mesh_.vertices[at(triangle[1])];
    const Vec3& c = mesh_.vertices[at(triangle[2])];
    // The middles of the edges integrate a quadratic weight exactly.
    double weight = 0.0;
    for (const Vec3& middle : {Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a))}) {
      weight += std::max(0.0, 1.0 - (middle - centre).squaredNorm() / radius_squared);
    }
    const double cosine = reference.dot(face_normals_[at(face)]);
    const double side = std::clamp((cosine - kSharpCosine) / (kFullCosine - kSharpCosine), 0.0, 1.0);
    sum += weight * side * geometry::area_vector_doubled(mesh_, triangle);
    for (const std::int32_t other : neighbours_[at(face)]) {
      if (other < 0 || visited_by[at(other)] == visit) continue;
      const geometry::Triangle& next = mesh_.triangles[at(other)];
      const double reach = std::min({(mesh_.vertices[at(next[0])] - centre).squaredNorm(),
                                     (mesh_.vertices[at(next[1])] - centre).squaredNorm(),
                                     (mesh_.vertices[at(next[2])] - centre).squaredNorm()});
      if (reach >= radius_squared) continue;
      visited_by[at(other)] = visit;
      queue.push_back(other);
    }
  }
  const double length = sum.norm();
  return length > 0.0 ? Vec3(sum / length) : reference;
}

void OrganSurface::list_sharp_edges() {
  std::vector<std::vector<std::int32_t>> near(mesh_.triangles.size());
  std::vector<std::int32_t> queue;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t other = neighbours_[t][e];
      if (other < static_cast<std::int32_t>(t)) continue;  // boundary, or listed from the other side
      if (face_normals_[t].dot(face_normals_[at(other)]) >= kSharpCosine) continue;
      const auto& back = neighbours_[at(other)];
      const std::int32_t edge_of_other =
          back[0] == static_cast<std::int32_t>(t) ? 0 : (back[1] == static_cast<std::int32_t>(t) ? 1 : 2);
      const auto index = static_cast<std::int32_t>(sharp_edges_.size());
      sharp_edges_.push_back(
          {{static_cast<std::int32_t>(t), other}, {static_cast<std::int32_t>(e), edge_of_other}});
      const Vec3& a = mesh_.vertices[at(mesh_.triangles[t][e])];
      const Vec3& b = mesh_.vertices[at(mesh_.triangles[t][(e + 1) % 3])];
      queue.assign({static_cast<std::int32_t>(t), other});
      for (const std::int32_t face : queue) near[at(face)].push_back(index);
      for (std::size_t i = 0; i < queue.size(); ++i) {
        for (const std::int32_t next : neighbours_[at(queue[i])]) {
          if (next < 0 || (!near[at(next)].empty() && near[at(next)].back() == index)) continue;
          const geometry::Triangle& triangle = mesh_.triangles[at(next)];
          double along = 0.0;
          double closest = 1.0;
          for (std::size_t c = 0; c < 3; ++c) {
            const Vec3& p = mesh_.vertices[at(triangle[c])];
            const Vec3& q = mesh_.vertices[at(triangle[(c + 1) % 3])];
            closest = std::min({closest, distance_to_segment(p, a, b, along),
                                distance_to_segment(a, p, q, along), distance_to_segment(b, p, q, along)});
          }
          if (closest >= kBlendWidth) continue;
          near[at(next)].push_back(index);
          queue.push_back(next);
        }
      }
    }
  }
  sharp_start_.assign(1, 0);
  for (const auto& list : near) {
    sharp_near_.insert(sharp_near_.end(), list.begin(), list.end());
    sharp_start_.push_back(static_cast<std::int32_t>(sharp_near_.size()));
  }
}

std::array<double, 3> OrganSurface::barycentric(std::int32_t triangle, const Vec3& point) const noexcept {
  const geometry::Triangle& corners = mesh_.triangles[at(triangle)];
  const Vec3& a = mesh_.vertices[at(corners[0])];
  const Vec3 ab = mesh_.vertices[at(corners[1])] - a;
  const Vec3 ac = mesh_.vertices[at(corners[2])] - a;
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
  const std::array<Vec3, 3>& corner = corner_normals_[at(triangle)];
  return (weight[0] * corner[0] + weight[1] * corner[1] + weight[2] * corner[2]).normalized();
}

Vec3 OrganSurface::normal_at(const SurfacePoint& where) const noexcept {
  const Vec3 own = smooth_normal(where.triangle, where.point);
  OtherSides others;
  const std::int32_t end = sharp_start_[at(where.triangle) + 1];
  for (std::int32_t i = sharp_start_[at(where.triangle)]; i < end; ++i) {
    const SharpEdge& sharp = sharp_edges_[at(sharp_near_[at(i)])];
    const geometry::Triangle& corners = mesh_.triangles[at(sharp.triangle[0])];
    const Vec3& a = mesh_.vertices[at(corners[at(sharp.edge[0])])];
    const Vec3& b = mesh_.vertices[at(corners[at((sharp.edge[0] + 1) % 3)])];
    double along = 0.0;
    const double distance = distance_to_segment(where.point, a, b, along);
    if (distance >= kBlendWidth) continue;
    const Vec3 on_edge = a + along * (b - a);
    const Vec3 side0 = smooth_normal(sharp.triangle[0], on_edge);
    const Vec3 side1 = smooth_normal(sharp.triangle[1], on_edge);
    const bool own_is_0 = own.dot(side0) >= own.dot(side1);
    if (own.dot(own_is_0 ? side0 : side1) < kSharpCosine) continue;  // an edge of another side altogether
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
  // Turn the step from the tangent plane of `normal` into the triangle's plane, its length kept.
  const Vec3& start_normal = face_normal(here.triangle);
  const double one_plus_cosine = 1.0 + normal.dot(start_normal);
  if (one_plus_cosine < 1e-3) return here;  // turned right round: no direction is meant
  Vec3 left = step - (start_normal.dot(step) / one_plus_cosine) * (normal + start_normal);
  std::int32_t came_from = -1;
  for (int crossing = 0; crossing < kMostCrossings; ++crossing) {
    const geometry::Triangle& corners = mesh_.triangles[at(here.triangle)];
    const Vec3& face = face_normal(here.triangle);
    double stop = 1.0;
    int exit_edge = -1;
    for (int e = 0; e < 3; ++e) {
      if (came_from >= 0 && neighbours_[at(here.triangle)][at(e)] == came_from) continue;
      const Vec3& a = mesh_.vertices[at(corners[at(e)])];
      const Vec3& b = mesh_.vertices[at(corners[at((e + 1) % 3)])];
      const Vec3 outward = (b - a).cross(face);  // in the plane, across the edge
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
    const std::int32_t next = neighbours_[at(here.triangle)][at(exit_edge)];
    if (next < 0) return here;
    left *= 1.0 - stop;
    // Unfold: the part along the edge stays, the part across goes on into the next triangle's plane.
    const Vec3& a = mesh_.vertices[at(corners[at(exit_edge)])];
    const Vec3 edge = (mesh_.vertices[at(corners[at((exit_edge + 1) % 3)])] - a).normalized();
    const Vec3 across = edge.cross(face);
    const Vec3 across_next = edge.cross(face_normal(next));
    left = left.dot(edge) * edge + left.dot(across) * across_next;
    here.point = a + (here.point - a).dot(edge) * edge;  // on the edge, so that errors do not add up
    came_from = here.triangle;
    here.triangle = next;
  }
  return here;
}

}  // namespace palpate::contact
