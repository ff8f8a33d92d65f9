#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "palpate/mesh.h"
#include "view/render/gl_objects.h"

namespace palpate::render {

/// [setup] Unit normals of a closed mesh at points on or near it. @throws InputError when it is not closed
[[nodiscard]] std::vector<Vec3> normals_at(const geometry::TriangleMesh& mesh, std::span<const Vec3> points);

/// [setup] Averages `known` over the triangles around each vertex, so that the outline of a map does not
/// follow single triangles. An unknown vertex takes the mean share of its known neighbours. Public for tests.
void smooth_outline(std::span<const geometry::Triangle> triangles, std::vector<MapVertex>& vertices);

/// Assigns points of the rest surface to the vertices of the displayed mesh, so that values at the points can
/// be drawn as colours. A vertex takes the value of the nearest point within kReach whose surface normal
/// differs by less than about 75 degrees. So a vertex never takes the value of the far side of a thin organ.
class SurfaceMap final {
 public:
  static constexpr double kReach = 3e-3;  // m

  SurfaceMap() = default;
  /// [setup] @param mesh displayed rest mesh @param points_S on or near that surface, organ frame [m]
  SurfaceMap(const geometry::TriangleMesh& mesh, std::span<const Vec3> points_S);

  /// [any] Index of the point that a vertex takes its value from; -1: none.
  [[nodiscard]] std::span<const std::int32_t> point_of() const noexcept { return point_of_; }
  /// [setup] Attributes of all vertices for these values, one per point; NaN: not known. The outline of the
  /// known region is smoothed over the neighbours of each vertex.
  /// @param triangles of the mesh
  [[nodiscard]] std::vector<MapVertex> attributes(std::span<const geometry::Triangle> triangles,
                                                  std::span<const float> values, double low,
                                                  double high) const;

 private:
  std::vector<std::int32_t> point_of_;
};

}  // namespace palpate::render
