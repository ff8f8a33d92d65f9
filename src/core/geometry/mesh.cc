#include "palpate/mesh.h"

#include <unordered_map>

#include "core/geometry/half_edges.h"

namespace palpate::geometry {
Bounds bounds(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Bounds box{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vec3& vertex : mesh.vertices) {
    box.low = box.low.cwiseMin(vertex);
    box.high = box.high.cwiseMax(vertex);
  }
  return box;
}

Vec3 area_vector_doubled(const TriangleMesh& mesh, const Triangle& triangle) {
  const Vec3& a = mesh.vertices[static_cast<std::size_t>(triangle[0])];
  const Vec3& b = mesh.vertices[static_cast<std::size_t>(triangle[1])];
  const Vec3& c = mesh.vertices[static_cast<std::size_t>(triangle[2])];
  return (b - a).cross(c - a);
}

double signed_volume(const TriangleMesh& mesh) {
  const Vec3 origin = bounds(mesh).middle();  // near the surface, against cancellation
  double six_volumes = 0.0;
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3 a = mesh.vertices[static_cast<std::size_t>(triangle[0])] - origin;
    six_volumes += a.dot(area_vector_doubled(mesh, triangle));
  }
  return six_volumes / 6.0;
}

void transform(TriangleMesh& mesh, const Pose& pose) {
  for (Vec3& vertex : mesh.vertices) vertex = pose * vertex;
}

TriangleMesh subdivide(const TriangleMesh& mesh) {
  TriangleMesh fine;
  fine.vertices = mesh.vertices;
  fine.triangles.reserve(4 * mesh.triangles.size());
  std::unordered_map<std::uint64_t, std::int32_t> middles;
  middles.reserve(2 * mesh.triangles.size());
  const auto middle_of = [&](std::int32_t a, std::int32_t b) {
    const auto [entry, is_new] =
        middles.try_emplace(edge_key(a, b), static_cast<std::int32_t>(fine.vertices.size()));
    if (is_new) {
      const Vec3 point =
          0.5 * (fine.vertices[static_cast<std::size_t>(a)] + fine.vertices[static_cast<std::size_t>(b)]);
      fine.vertices.push_back(point);
    }
    return entry->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::int32_t ab = middle_of(a, b);
    const std::int32_t bc = middle_of(b, c);
    const std::int32_t ca = middle_of(c, a);
    fine.triangles.push_back({a, ab, ca});
    fine.triangles.push_back({ab, b, bc});
    fine.triangles.push_back({ca, bc, c});
    fine.triangles.push_back({ab, bc, ca});
  }
  return fine;
}

}  // namespace palpate::geometry
