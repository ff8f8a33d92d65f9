#pragma once
// A plain reference implementation of the displaced surface, for tests of SurfaceDeformer, DeformedSurface
// and GeodesicFront.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "core/base/infinity.h"
#include "core/geometry/signed_distance.h"
#include "palpate/mesh.h"
#include "palpate/surface.h"

namespace palpate::deform::test {

/// A point on a surface.
struct PlainPoint {
  std::int32_t triangle = -1;
  Vec3 point = Vec3::Zero();   // on that triangle [m]
  Vec3 normal = Vec3::Zero();  // unit, interpolated vertex normals; zero where the surface has none
};

/// Geodesic distances from one point, up to a limit.
///
/// A vertex takes the shortest path through its triangles (Novotni and Klein 2002).
/// The distances of the two other corners place the source in the unfolded plane of the triangle. The
/// straight line from there counts when it crosses the edge between them; otherwise the path along an edge
/// counts. A vertex whose distance falls later is propagated again, so obtuse triangles and slivers need no
/// special treatment. Distances on a flat surface are exact. Distances along edges only (Dijkstra) would be
/// up to 15 % too long.
class PlainGeodesic final {
 public:
  /// [setup] Copies the mesh and prepares adjacency. The mesh may be open and non-manifold.
  explicit PlainGeodesic(const geometry::TriangleMesh& mesh);

  /// [setup] The surface point nearest to p; among equally near triangles the first. O(triangles).
  [[nodiscard]] PlainPoint nearest(const Vec3& p) const;

  /// [setup] Computes the distances from `source` of all vertices nearer than `limit` [m]. Replaces the last
  /// result.
  void compute(const PlainPoint& source, double limit);

  /// [any] Vertices nearer than the limit.
  [[nodiscard]] std::span<const std::int32_t> reached() const noexcept { return reached_; }
  /// [any] Distance of a vertex [m]; infinity beyond the limit.
  [[nodiscard]] double at(std::int32_t vertex) const noexcept {
    return distance_[static_cast<std::size_t>(vertex)];
  }

  [[nodiscard]] const geometry::TriangleMesh& mesh() const noexcept { return mesh_; }

 private:
  void offer(std::int32_t vertex, double distance);
  void relax(std::int32_t from, std::int32_t known, std::int32_t to);

  geometry::TriangleMesh mesh_;
  std::vector<Vec3> normals_;
  std::vector<std::int32_t> start_;     // per vertex: start of its triangles in incident_
  std::vector<std::int32_t> incident_;  // triangles of each vertex
  std::vector<double> distance_;        // infinity if not reached
  std::vector<std::int32_t> reached_;
  std::vector<std::pair<double, std::int32_t>> queue_;  // heap, smallest first; may hold outdated entries
  double longest_edge_ = 0.0;                           // [m]
  double limit_ = 0.0;                                  // of propagation [m]
};

// m^8; the weight of a vertex that hardly moves
inline constexpr double kLeastWeight = 1e-200;

// A distance that falls by less than this ratio has changed by rounding only and is not propagated.
inline constexpr double kWorthwhile = 1.0 - 1e-9;

inline std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

// Length of the straight path to c across edge ab, from the distances of a and b; infinity when the straight
// line misses the edge.
inline double path_across(const Vec3& a, const Vec3& b, const Vec3& c, double distance_a, double distance_b) {
  const Vec3 edge = b - a;
  const double length = edge.norm();
  if (!(length > 0.0)) return kInfinity;
  const double c_x = (c - a).dot(edge) / length;
  const double c_y = std::sqrt(std::max(0.0, (c - a).squaredNorm() - c_x * c_x));
  const double s_x = (distance_a * distance_a - distance_b * distance_b + length * length) / (2.0 * length);
  const double s_y_squared = distance_a * distance_a - s_x * s_x;
  if (s_y_squared < 0.0) return kInfinity;
  const double s_y = std::sqrt(s_y_squared);  // the source is below the edge, c above
  const double height = c_y + s_y;
  if (!(height > 0.0)) return kInfinity;
  const double crossing = s_x + (c_x - s_x) * s_y / height;
  if (crossing < -1e-9 * length || crossing > (1.0 + 1e-9) * length) return kInfinity;
  return std::sqrt((c_x - s_x) * (c_x - s_x) + height * height);
}

inline PlainGeodesic::PlainGeodesic(const geometry::TriangleMesh& mesh)
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

inline PlainPoint PlainGeodesic::nearest(const Vec3& p) const {
  PlainPoint best;
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

inline void PlainGeodesic::offer(std::int32_t vertex, double distance) {
  double& now = distance_[index(vertex)];
  if (!(distance < limit_) || !(distance < now * kWorthwhile)) return;
  if (now == kInfinity) reached_.push_back(vertex);
  now = distance;
  queue_.emplace_back(distance, vertex);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

inline void PlainGeodesic::relax(std::int32_t from, std::int32_t known, std::int32_t to) {
  const Vec3& a = mesh_.vertices[index(from)];
  const Vec3& c = mesh_.vertices[index(to)];
  double distance = distance_[index(from)] + (c - a).norm();
  if (distance_[index(known)] < kInfinity) {
    distance = std::min(distance, path_across(a, mesh_.vertices[index(known)], c, distance_[index(from)],
                                              distance_[index(known)]));
  }
  offer(to, distance);
}

inline void PlainGeodesic::compute(const PlainPoint& source, double limit) {
  for (const std::int32_t v : reached_) distance_[index(v)] = kInfinity;
  reached_.clear();
  queue_.clear();
  // The shortest path to a vertex below the limit may cross an edge with an end beyond it.
  limit_ = limit + longest_edge_;
  if (source.triangle < 0) return;
  for (const std::int32_t v : mesh_.triangles[index(source.triangle)])
    offer(v, (mesh_.vertices[index(v)] - source.point).norm());
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [distance, v] = queue_.back();
    queue_.pop_back();
    if (distance > distance_[index(v)]) continue;  // outdated entry
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

/// The displaced surface by its rules, vertex by vertex in double precision: the reference for
/// SurfaceDeformer.
class PlainDeformer final {
 public:
  explicit PlainDeformer(const geometry::TriangleMesh& rest) : geodesic_(rest), sums_(rest.vertices.size()) {}

  [[nodiscard]] std::vector<Vec3> deformed(const model::FalloffRatios& reach,
                                           std::span<const Indentation> indentations, double rounding = 0.0) {
    std::vector<Vec3> vertices = geodesic_.mesh().vertices;
    sums_.assign(vertices.size(), {});
    const std::vector<double> shares = opposition_factors(indentations);
    for (std::size_t i = 0; i < indentations.size(); ++i) {
      Indentation indentation = indentations[i];
      indentation.depth *= shares[i];
      if (indentation.depth > 0.0) add(reach, indentation, rounding);
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const BlendSums& sums = sums_[v];
      if (sums.weight == 0.0) continue;
      const Vec3 direction = sums.directions / sums.squares;
      vertices[v] += sums.length / sums.weight * mean_direction_gain(direction.squaredNorm()) * direction;
    }
    return vertices;
  }

 private:
  // Sums over the contacts that move a vertex.
  struct BlendSums {
    double weight = 0.0;             // sum of u^8
    double length = 0.0;             // sum of u^9
    double squares = 0.0;            // sum of u^2
    Vec3 directions = Vec3::Zero();  // directions weighted by u^2
  };

  /// Distance [m] to the organ's far side; infinity if there is no far side.
  [[nodiscard]] double thickness_behind(const Vec3& start, const Vec3& direction) const {
    double nearest = kInfinity;
    for (const geometry::Triangle& t : geodesic_.mesh().triangles) {
      Eigen::Matrix3d edges;  // start + s direction = a + u ab + v ac
      const Vec3& a = geodesic_.mesh().vertices[index(t[0])];
      const Vec3 ab = geodesic_.mesh().vertices[index(t[1])] - a;
      const Vec3 ac = geodesic_.mesh().vertices[index(t[2])] - a;
      if (!(ab.cross(ac).dot(direction) > 0.0)) continue;
      edges << ab, ac, -direction;
      const Vec3 found = edges.partialPivLu().solve(start - a);
      if (found[0] < 0.0 || found[1] < 0.0 || found[0] + found[1] > 1.0 || !(found[2] > 1e-6)) continue;
      nearest = std::min(nearest, found[2]);
    }
    return nearest;
  }

  void add(const model::FalloffRatios& reach, const Indentation& indentation, double rounding) {
    const PlainPoint contact = geodesic_.nearest(indentation.point);
    const double along_normal = indentation.direction.dot(contact.normal);
    double depth = indentation.depth;
    if (along_normal < 0.0)
      depth = limited_depth(depth, thickness_behind(contact.point, indentation.direction));
    const DisplacementProfile profile(reach, depth, indentation.tip_radius, indentation.half_width);
    const Vec3 normal_part = along_normal * contact.normal;
    const Vec3 side_part = indentation.direction - normal_part;
    const double fold = side_part.norm() * profile.steepest() / kMaxTangentialSlope;
    const DisplacementProfile side_profile = profile.widened(std::max(1.0, fold));

    // The profile ends at its reach, the rounded one at reach / (1 - rounding).
    const double limit = side_profile.outer_radius() / (1.0 - rounding);
    geodesic_.compute(contact, limit);
    for (const std::int32_t v : geodesic_.reached()) {
      const double r = geodesic_.at(v);
      const Vec3 displacement =
          profile.rounded_at(r, rounding) * normal_part + side_profile.rounded_at(r, rounding) * side_part;
      const double length = displacement.norm();
      if (!(length > 0.0)) continue;
      const double squared = length * length;
      const double weight = std::max(squared * squared * squared * squared, kLeastWeight);
      BlendSums& sums = sums_[static_cast<std::size_t>(v)];
      sums.weight += weight;
      sums.length += weight * length;
      sums.squares += squared;
      sums.directions += length * displacement;
    }
  }

  PlainGeodesic geodesic_;
  std::vector<BlendSums> sums_;  // per vertex
};

}  // namespace palpate::deform::test
