#pragma once
#include <algorithm>
#include <cmath>

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

}  // namespace palpate::deform
