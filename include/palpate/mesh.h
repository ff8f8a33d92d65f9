#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/pose.h"

namespace palpate::geometry {

using Triangle = std::array<std::int32_t, 3>;  // vertex indices, counter-clockwise seen from outside

/// A triangle mesh; vertices in metres.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

/// Axis-aligned box [m].
struct Bounds {
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
  [[nodiscard]] Vec3 size() const noexcept { return high - low; }
  [[nodiscard]] Vec3 middle() const noexcept { return 0.5 * (low + high); }
};

/// [setup] Bounding box of all vertices; all zero for an empty mesh.
[[nodiscard]] Bounds bounds(const TriangleMesh& mesh);

/// [setup] Twice the area vector [m^2] of a triangle; its direction is the outward normal.
[[nodiscard]] Vec3 area_vector_doubled(const TriangleMesh& mesh, const Triangle& triangle);

/// [setup] Enclosed volume [m^3]; negative when the normals point inwards.
[[nodiscard]] double signed_volume(const TriangleMesh& mesh);

/// [setup] Applies the rigid transform `pose` to every vertex.
void transform(TriangleMesh& mesh, const Pose& pose);

/// [setup] Entry [t][e] is the triangle on the other side of edge e of triangle t, or -1 at a boundary. Edge
/// e goes from corner e to corner (e+1)%3. @throws InputError when an edge has more than two triangles, or
/// two triangles that are not consistently oriented.
[[nodiscard]] std::vector<std::array<std::int32_t, 3>> edge_neighbours(const TriangleMesh& mesh);

/// [setup] Splits edges until none is longer than `longest` [m]. The shape does not change, and a closed mesh
/// stays closed. Every original vertex keeps its index.
[[nodiscard]] TriangleMesh refine(const TriangleMesh& mesh, double longest);

/// [setup] Midpoint subdivision: divides every triangle into four at the midpoints of its edges. The shape
/// does not change.
[[nodiscard]] TriangleMesh subdivide(const TriangleMesh& mesh);

/// [setup] Ball of `radius` [m] about the origin: an icosahedron that is subdivided until it has at least
/// `triangles` triangles (20, 80, 320, 1280, ...). Every vertex is on the sphere.
[[nodiscard]] TriangleMesh make_ball(double radius, int triangles = 1280);

/// [setup] Closed box of `size` [m] about the origin. Each side consists of rectangles with edges of at most
/// `longest` [m]; each rectangle is two triangles.
[[nodiscard]] TriangleMesh make_box(const Vec3& size, double longest);

}  // namespace palpate::geometry
