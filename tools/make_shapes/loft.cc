#include "tools/make_shapes/loft.h"

#include <cstddef>
#include <cstdint>

namespace palpate::geometry {

TriangleMesh loft(const std::vector<std::vector<Vec3>>& rings, const Vec3& first_pole,
                  const Vec3& last_pole) {
  TriangleMesh mesh;
  for (const std::vector<Vec3>& ring : rings) {
    mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  }
  const auto around = static_cast<std::int32_t>(rings.front().size());
  const auto last = static_cast<std::int32_t>(mesh.vertices.size()) - around;
  for (std::int32_t low = 0; low < last; low += around) {
    for (std::int32_t k = 0; k < around; ++k) {
      const std::int32_t next = (k + 1) % around;
      mesh.triangles.push_back({low + k, low + next, low + around + next});
      mesh.triangles.push_back({low + k, low + around + next, low + around + k});
    }
  }
  const auto first_tip = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.push_back(first_pole);
  mesh.vertices.push_back(last_pole);
  for (std::int32_t k = 0; k < around; ++k) {
    const std::int32_t next = (k + 1) % around;
    mesh.triangles.push_back({first_tip, next, k});
    mesh.triangles.push_back({first_tip + 1, last + k, last + next});
  }
  return mesh;
}

}  // namespace palpate::geometry
