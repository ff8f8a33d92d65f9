#include "core/geometry/ray.h"

#include <algorithm>

#include "core/base/index.h"
#include "core/base/infinity.h"

namespace palpate::geometry {

double distance_to_back(const TriangleMesh& mesh, const Triangle& triangle, const Ray& ray) {
  const Vec3& a = mesh.vertices[at(triangle[0])];
  const Vec3 ab = mesh.vertices[at(triangle[1])] - a;
  const Vec3 ac = mesh.vertices[at(triangle[2])] - a;
  const double facing = ab.cross(ac).dot(ray.direction);  // minus the determinant
  if (!(facing > 0.0)) return kInfinity;
  const Vec3 p = ray.direction.cross(ac);
  const Vec3 s = ray.origin - a;
  const double u = -s.dot(p) / facing;
  const Vec3 q = s.cross(ab);
  const double v = -ray.direction.dot(q) / facing;
  return u < 0.0 || v < 0.0 || u + v > 1.0 ? kInfinity : -ac.dot(q) / facing;
}

std::optional<Vec3> seen_point(const TriangleMesh& mesh, const Ray& ray) {
  double nearest = kInfinity;
  for (const auto& [a, b, c] : mesh.triangles) {
    const double distance = distance_to_back(mesh, {a, c, b}, ray);  // turned: its front faces the eye
    if (distance > 0.0) nearest = std::min(nearest, distance);
  }
  if (nearest == kInfinity) return std::nullopt;
  return ray.origin + nearest * ray.direction;
}

}  // namespace palpate::geometry
