#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/index.h"
#include "palpate/mesh.h"

namespace palpate::deform {

/// [setup] Calls use(point, area vector) for parts of every triangle that are smaller than `size` [m].
template <typename Use>
void for_each_part(const geometry::TriangleMesh& mesh, double size, const Use& use) {
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[at(t[0])];
    const Vec3 ab = mesh.vertices[at(t[1])] - a;
    const Vec3 ac = mesh.vertices[at(t[2])] - a;
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(longest / size)));
    const Vec3 area = ab.cross(ac) / (2.0 * n * n);
    if (area.squaredNorm() == 0.0) continue;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        use(Vec3(a + (i + 1.0 / 3.0) / n * ab + (j + 1.0 / 3.0) / n * ac), area);
        if (i + j + 1 < n) use(Vec3(a + (i + 2.0 / 3.0) / n * ab + (j + 2.0 / 3.0) / n * ac), area);
      }
    }
  }
}

/// [setup] Unit vertex normals: means of the triangles' normals weighted by their angle at the vertex; zero
/// for a vertex without triangles.
[[nodiscard]] inline std::vector<Vec3> vertex_normals(const geometry::TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const geometry::Triangle& t : mesh.triangles) {
    const std::array<Vec3, 3> edge = {mesh.vertices[at(t[1])] - mesh.vertices[at(t[0])],
                                      mesh.vertices[at(t[2])] - mesh.vertices[at(t[1])],
                                      mesh.vertices[at(t[0])] - mesh.vertices[at(t[2])]};
    const Vec3 area = edge[0].cross(edge[1]);
    const double doubled = area.norm();
    if (!(doubled > 0.0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = std::atan2(doubled, -edge[k].dot(edge[(k + 2) % 3]));
      normals[at(t[k])] += (angle / doubled) * area;
    }
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

}  // namespace palpate::deform
