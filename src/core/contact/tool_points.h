#pragma once
#include <cstdint>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/tool.h"

namespace palpate::contact {

/// Rounding margin [m]: a cluster's bound sums in another order than the points' depths.
inline constexpr double kBoundSlack = 1e-12;

/// Sampled surface points of one rigid part, in the part's frame P (the handle's, jaws closed). One array per
/// component. Neighbouring points are adjacent and form clusters, which a search can skip as a whole.
struct PartPoints {
  static constexpr std::uint32_t kClusterSize = 32;
  static constexpr std::size_t kMaxPoints = 2000;  // per part; denser surfaces are thinned out

  /// A run of kClusterSize points (the last one may be shorter), with a bounding box and a bounding sphere
  /// about the same centre.
  struct Cluster {
    Vec3 centre = Vec3::Zero();
    Vec3 half_size = Vec3::Zero();  // of the box [m]
    double radius = 0.0;            // of the sphere [m]
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  static_assert(kMaxPoints <= std::size_t{64} * kClusterSize);  // DepthSearch has one bit per cluster

  std::vector<double> x, y, z;     // m
  std::vector<double> area;        // m^2, > 0, of the surface that the point represents
  std::vector<double> tip_radius;  // R, radius of curvature there [m]
  std::vector<double> half_width;  // of the part there [m]
  std::vector<Cluster> clusters;
  std::vector<double> offset;  // distance of each point from its cluster's centre [m]
  Vec3 box_middle = Vec3::Zero();
  Vec3 box_reach = Vec3::Zero();  // half the box's size [m]
  geometry::ToolPart joint;       // is_jaw, pivot, axis, open_angle; without mesh

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] Vec3 point(std::size_t i) const noexcept { return {x[i], y[i], z[i]}; }
};

/// [setup] Samples a part's surface: spacing at most 2 mm, including the mesh's vertices, with area weights.
/// If there are more than 2,000 points, the outermost are kept, spread over position and direction, so that a
/// tick's cost does not grow with the mesh.
/// @param given_radius the user's tip_radius [m]; replaces the estimate when > 0
/// @throws InputError when the part has no triangles.
[[nodiscard]] PartPoints sample_part(const geometry::ToolPart& part, double given_radius);

}  // namespace palpate::contact
