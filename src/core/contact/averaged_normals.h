#pragma once
// Averaged normals at the organ's vertices (docs/model.md, section 4). Used in set-up only.
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::contact {

inline constexpr double kSharpCosine = 0.5;  // cos 60 degrees: faces turned by more do not count
inline constexpr double kFullCosine = 0.65;  // cos 49 degrees: faces turned by less count in full

/// A surface with its connectivity.
struct SurfaceView {
  const geometry::TriangleMesh& mesh;
  const std::vector<std::array<std::int32_t, 3>>& neighbours;  // geometry::edge_neighbours
  const std::vector<Vec3>& face_normals;                       // unit
};

/// Sides of vertices. A side is the set of triangles around a vertex that no sharp edge separates; it has one
/// normal. Side v is the first side of vertex v. Further sides, of vertices on sharp edges, follow after
/// those of all vertices.
struct Sides {
  std::vector<std::int32_t> first_corner;  // per side: 3 x triangle + corner; -1: no triangle has this vertex
  std::vector<std::int32_t> of_corner;     // side of each triangle corner, three per triangle
  std::vector<Vec3> mean_normal;           // per side: SideFan::reference; zero without a triangle
};

/// [setup] Finds all sides, in the order of the triangles.
[[nodiscard]] Sides find_sides(const SurfaceView& surface);

/// The triangles of one side and their mean normal.
class SideFan final {
 public:
  /// [setup] Collects the triangles of the side at `first_corner`, beginning with that corner's triangle.
  void collect(const SurfaceView& surface, std::int32_t first_corner);
  [[nodiscard]] std::span<const std::int32_t> triangles() const noexcept { return triangles_; }
  [[nodiscard]] const Vec3& reference() const noexcept { return reference_; }  // unit

 private:
  std::vector<std::int32_t> triangles_;
  std::vector<std::int32_t> seen_by_;  // per triangle: number of the last collection that contains it
  std::int32_t collection_ = 0;
  Vec3 reference_ = Vec3::Zero();
};

/// Receives the progress, 0..1, on the calling thread.
using ProgressCallback = std::function<void(double)>;

/// An averaged normal and its gradient along the surface.
struct NormalAndSlope {
  Vec3 normal = Vec3::Zero();                       // unit
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();  // [1/m]

  /// [setup] Normalizes a sum [m^2] with its slope [m]. @param otherwise the normal to use where the sum is
  /// zero
  [[nodiscard]] static NormalAndSlope of(const Vec3& sum, const Eigen::Matrix3d& slope,
                                         const Vec3& otherwise);
};

/// [setup] Spacing of samples [m] for averaged_normals(): 0 (every side) for small meshes, else a fixed part
/// of the radius. So small meshes get the bits of the plain sum.
[[nodiscard]] double sample_spacing_for(const SurfaceView& surface, const Sides& sides, double radius);

/// [setup] The unit normal of every side and its slope. The normal is the area-weighted mean of the face
/// normals within `radius` [m], of the triangles connected within that radius, with weight 1 - (r/radius)^2
/// at the edge midpoints. Faces turned by more than 60 degrees do not count. The slope is the derivative for
/// a fixed set of midpoints. With a spacing, for fine meshes: faces are turned from the mean normal within
/// 0.4 `radius` instead of that of the side's own triangles, whose normals may be noise, and triangles within
/// `radius`/20 are joined to facets.
/// @param spacing of the samples between which normals are blended [m] (normal_samples.h); 0: none
[[nodiscard]] std::vector<NormalAndSlope> averaged_normals(const SurfaceView& surface, const Sides& sides,
                                                           double radius, double spacing,
                                                           const ProgressCallback& progress = {});

}  // namespace palpate::contact
