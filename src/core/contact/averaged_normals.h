#pragma once
// The organ's normals at its vertices (model.md, section 4); set-up only.
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::contact {

inline constexpr double kSharpCosine = 0.5;  // of 60 degrees: a face turned more belongs to another side
inline constexpr double kFullCosine = 0.65;  // of about 49 degrees: up to here a face counts in full

/// A surface and what lies side by side on it.
struct SurfaceView {
  const geometry::TriangleMesh& mesh;
  const std::vector<std::array<std::int32_t, 3>>& neighbours;  // geometry::edge_neighbours
  const std::vector<Vec3>& face_normals;                       // unit
};

/// The sides of the vertices: the triangles around a vertex that no sharp edge parts share one normal. Side v
/// is the first of vertex v; the further sides of vertices on sharp edges follow after those of all vertices.
struct Sides {
  std::vector<std::int32_t> first_corner;  // of each side: three times the triangle plus the corner; -1: no
                                           // triangle has that vertex
  std::vector<std::int32_t> of_corner;     // side of each corner of each triangle, three a triangle
};

/// [setup] Finds all sides, in the order of the triangles.
[[nodiscard]] Sides find_sides(const SurfaceView& surface);

/// The triangles of one side and where their mean looks.
class SideFan final {
 public:
  /// [setup] Collects the triangles of side `first_corner`, that one first.
  void collect(const SurfaceView& surface, std::int32_t first_corner);
  [[nodiscard]] std::span<const std::int32_t> triangles() const noexcept { return triangles_; }
  [[nodiscard]] const Vec3& reference() const noexcept { return reference_; }  // unit

 private:
  std::vector<std::int32_t> triangles_;
  std::vector<std::int32_t> seen_by_;  // of each triangle: the collection that found it last
  std::int32_t collection_ = 0;
  Vec3 reference_ = Vec3::Zero();
};

/// How far, 0..1; on the calling thread.
using Share = std::function<void(double)>;

/// An averaged normal and how it changes with the place.
struct NormalAndSlope {
  Vec3 normal = Vec3::Zero();                       // unit
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();  // [1/m]

  /// [setup] Of a sum [m^2] and its slope [m] the direction and its slope; `otherwise` where the sum is
  /// nothing.
  [[nodiscard]] static NormalAndSlope of(const Vec3& sum, const Eigen::Matrix3d& slope,
                                         const Vec3& otherwise);
};

/// [setup] Size [m] of the groups in which averaged_normals() takes triangles: 0, each triangle by itself,
/// where that is quick; else a part of the radius. Small meshes so have the bits of the rule itself.
[[nodiscard]] double group_size_for(const SurfaceView& surface, const Sides& sides, double radius);

/// [setup] The unit normal of every side: the area-weighted mean of the face normals within `radius` [m]
/// along the surface, weight 1 - (r/radius)^2 at the middles of the edges, without faces turned more than 60
/// degrees; and its slope while the same middles are in reach. Groups of neighbouring triangles, or halves of
/// them and so on, that lie in reach and are turned less than 49 degrees are added whole, by their moments,
/// which is exact but for rounding (docs/decisions/0022).
/// @param group_size no corner of a group's triangles is farther from its first triangle [m]; 0: no groups
[[nodiscard]] std::vector<NormalAndSlope> averaged_normals(const SurfaceView& surface, const Sides& sides,
                                                           double radius, double group_size,
                                                           const Share& share = {});

}  // namespace palpate::contact
