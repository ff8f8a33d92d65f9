#include "core/deform/geodesic.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/infinity.h"
#include "core/geometry/surface_distance.h"

namespace palpate::deform {
namespace {

// Improvements below this share of the distance are rounding and are not propagated again.
constexpr double kWorthwhile = 1.0 - 1e-9;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

// Length of the straight way to c that crosses edge ab, given the distances of a and b; infinity when the
// straight line does not cross it.
double way_across(const Vec3& a, const Vec3& b, const Vec3& c, double distance_a, double distance_b) {
  const Vec3 edge = b - a;
  const double length = edge.norm();
  if (!(length > 0.0)) return kInfinity;
  const double c_x = (c - a).dot(edge) / length;
  const double c_y = std::sqrt(std::max(0.0, (c - a).squaredNorm() - c_x * c_x));
  const double s_x = (distance_a * distance_a - distance_b * distance_b + length * length) / (2.0 * length);
  const double s_y_squared = distance_a * distance_a - s_x * s_x;
  if (s_y_squared < 0.0) return kInfinity;
  const double s_y = std::sqrt(s_y_squared);  // below the edge, c above it
  const double height = c_y + s_y;
  if (!(height > 0.0)) return kInfinity;
  const double crossing = s_x + (c_x - s_x) * s_y / height;
  if (crossing < -1e-9 * length || crossing > (1.0 + 1e-9) * length) return kInfinity;
  return std::sqrt((c_x - s_x) * (c_x - s_x) + height * height);
}

}  // namespace

GeodesicDistance::GeodesicDistance(const geometry::TriangleMesh& mesh)
    : mesh_(mesh),
      normals_(mesh.vertices.size(), Vec3::Zero()),
      start_(mesh.vertices.size() + 1, 0),
      distance_(mesh.vertices.size(), kInfinity) {
  for (const geometry::Triangle& triangle : mesh_.triangles) {
    const Vec3 area = geometry::area_vector_doubled(mesh_, triangle);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t v = triangle[k];
      const Vec3 edge = mesh_.vertices[index(triangle[(k + 1) % 3])] - mesh_.vertices[index(v)];
      longest_edge_ = std::max(longest_edge_, edge.norm());
      normals_[index(v)] += area;
      ++start_[index(v) + 1];
    }
  }
  for (std::size_t v = 1; v < start_.size(); ++v) start_[v] += start_[v - 1];
  incident_.resize(mesh_.triangles.size() * 3);
  std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    for (const std::int32_t v : mesh_.triangles[t])
      incident_[index(next[index(v)]++)] = static_cast<std::int32_t>(t);
  for (Vec3& normal : normals_) normal.normalize();
}

SurfacePoint GeodesicDistance::nearest(const Vec3& p) const {
  SurfacePoint best;
  double best_squared = kInfinity;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto [a, b, c] = mesh_.triangles[t];
    const Vec3 q = geometry::nearest_on_triangle(p, mesh_.vertices[index(a)], mesh_.vertices[index(b)],
                                                 mesh_.vertices[index(c)]);
    const double squared = (q - p).squaredNorm();
    if (squared < best_squared) {
      best_squared = squared;
      best.triangle = static_cast<std::int32_t>(t);
      best.point = q;
    }
  }
  if (best.triangle < 0) return best;
  // Barycentric weights from the areas opposite to each corner.
  const geometry::Triangle& corners = mesh_.triangles[index(best.triangle)];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 u = mesh_.vertices[index(corners[(k + 1) % 3])] - best.point;
    const Vec3 v = mesh_.vertices[index(corners[(k + 2) % 3])] - best.point;
    best.normal += u.cross(v).norm() * normals_[index(corners[k])];
  }
  best.normal.normalize();
  return best;
}

void GeodesicDistance::offer(std::int32_t vertex, double distance) {
  double& now = distance_[index(vertex)];
  if (!(distance < limit_) || !(distance < now * kWorthwhile)) return;
  if (now == kInfinity) reached_.push_back(vertex);
  now = distance;
  queue_.emplace_back(distance, vertex);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

void GeodesicDistance::relax(std::int32_t from, std::int32_t known, std::int32_t to) {
  const Vec3& a = mesh_.vertices[index(from)];
  const Vec3& c = mesh_.vertices[index(to)];
  double distance = distance_[index(from)] + (c - a).norm();
  if (distance_[index(known)] < kInfinity) {
    distance = std::min(distance, way_across(a, mesh_.vertices[index(known)], c, distance_[index(from)],
                                             distance_[index(known)]));
  }
  offer(to, distance);
}

void GeodesicDistance::compute(const SurfacePoint& source, double limit) {
  for (const std::int32_t v : reached_) distance_[index(v)] = kInfinity;
  reached_.clear();
  queue_.clear();
  // The shortest way to a vertex below the limit may cross an edge whose far end lies beyond it.
  limit_ = limit + longest_edge_;
  if (source.triangle < 0) return;
  for (const std::int32_t v : mesh_.triangles[index(source.triangle)])
    offer(v, (mesh_.vertices[index(v)] - source.point).norm());
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [distance, v] = queue_.back();
    queue_.pop_back();
    if (distance > distance_[index(v)]) continue;  // outdated
    for (std::int32_t i = start_[index(v)]; i < start_[index(v) + 1]; ++i) {
      const geometry::Triangle& t = mesh_.triangles[index(incident_[index(i)])];
      const std::size_t k = t[0] == v ? 0 : (t[1] == v ? 1 : 2);
      const std::int32_t p = t[(k + 1) % 3];
      const std::int32_t q = t[(k + 2) % 3];
      relax(v, q, p);
      relax(v, p, q);
    }
  }
  std::erase_if(reached_, [this, limit](std::int32_t v) {
    const bool beyond = !(distance_[index(v)] < limit);
    if (beyond) distance_[index(v)] = kInfinity;
    return beyond;
  });
}

}  // namespace palpate::deform
