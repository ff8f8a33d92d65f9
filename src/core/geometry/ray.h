#pragma once
#include <optional>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// A line of sight.
struct Ray {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();  // unit
};

/// [any] Where the ray's line meets a triangle that faces in its direction, the far side of a solid [m];
/// negative behind the origin, infinity when it misses. [Moeller and Trumbore 1997]
[[nodiscard]] double distance_to_back(const TriangleMesh& mesh, const Triangle& triangle, const Ray& ray);

/// [setup] The first point of a closed mesh that an eye outside it sees along the ray; empty: none.
[[nodiscard]] std::optional<Vec3> seen_point(const TriangleMesh& mesh, const Ray& ray);

}  // namespace palpate::geometry
