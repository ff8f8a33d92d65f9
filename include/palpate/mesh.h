#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/pose.h"

namespace palpate::geometry {

using Triangle = std::array<std::int32_t, 3>;  // vertex indices, counter-clockwise seen from outside

/// A triangle surface; vertices in metres.
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

/// [setup] Smallest box around all vertices (zero box for an empty mesh).
[[nodiscard]] Bounds bounds(const TriangleMesh& mesh);

/// [setup] Twice the area vector of a triangle (its direction is the outward normal).
[[nodiscard]] Vec3 area_vector_doubled(const TriangleMesh& mesh, const Triangle& triangle);

/// [setup] Volume enclosed [m^3], negative when the triangles are turned inwards.
[[nodiscard]] double signed_volume(const TriangleMesh& mesh);

/// [setup] Moves every vertex by `pose`.
void transform(TriangleMesh& mesh, const Pose& pose);

/// For triangle t and its edge e (from corner e to corner (e+1)%3): the triangle on the other side, or -1 at
/// a boundary. [setup] @throws InputError when an edge has more than two triangles or two that run the same
/// way.
[[nodiscard]] std::vector<std::array<std::int32_t, 3>> edge_neighbours(const TriangleMesh& mesh);

/// [setup] Splits edges longer than `longest` [m] until none is left; the surface stays where it is, closed
/// stays closed. Every original vertex keeps its index.
[[nodiscard]] TriangleMesh refine(const TriangleMesh& mesh, double longest);

/// [setup] Every triangle into four, by the middles of its edges (the surface stays where it is).
[[nodiscard]] TriangleMesh subdivide(const TriangleMesh& mesh);

/// [setup] Ball of `radius` [m] about the origin: an icosahedron divided until it has at least `triangles`
/// (20, 80, 320, 1280, ...). Every vertex lies on the sphere.
[[nodiscard]] TriangleMesh make_ball(double radius, int triangles = 1280);

/// [setup] Box of `size` [m] about the origin, each side divided into squares of edge <= `longest` and those
/// into two triangles; closed.
[[nodiscard]] TriangleMesh make_box(const Vec3& size, double longest);

}  // namespace palpate::geometry
