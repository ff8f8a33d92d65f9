#pragma once
#include <cstdint>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/tool.h"

namespace palpate::contact {

/// A bound of a cluster is a sum in another order than its points' own: no cluster is left out within this of
/// counting [m].
inline constexpr double kBoundSlack = 1e-12;

/// The surface points of one rigid part of a tool, in the part's own frame P (the handle's, drawn closed).
/// Arrays by component; points that lie together are neighbours in the arrays, in clusters that can be passed
/// over whole.
struct PartPoints {
  static constexpr std::uint32_t kClusterSize = 32;
  static constexpr std::size_t kMostPoints = 2000;  // of a part: denser surfaces are thinned out

  /// A run of kClusterSize points (the last one shorter) within a box and a ball about its middle.
  struct Cluster {
    Vec3 centre = Vec3::Zero();
    Vec3 half_size = Vec3::Zero();  // of the box [m]
    double radius = 0.0;            // of the ball [m]
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  static_assert(kMostPoints <= std::size_t{64} * kClusterSize);  // DepthSearch has one bit a cluster

  std::vector<double> x, y, z;     // m
  std::vector<double> area;        // m^2, of the surface that the point stands for, > 0
  std::vector<double> tip_radius;  // R, radius of curvature there [m]
  std::vector<double> half_width;  // of the part there [m]
  std::vector<Cluster> clusters;
  std::vector<double> offset;  // of a point from its cluster's centre [m]
  Vec3 box_middle = Vec3::Zero();
  Vec3 box_reach = Vec3::Zero();  // half the box's size
  geometry::ToolPart joint;       // is_jaw, pivot, axis, open_angle; no mesh

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] Vec3 point(std::size_t i) const noexcept { return {x[i], y[i], z[i]}; }
};

/// [setup] Resamples a part's surface: spacing at most 2 mm, the mesh's own vertices among the points, area
/// weights. Of a part with more than 2,000 points those that stand out are kept, spread over place and
/// direction, so that a mesh of any number of triangles costs the same in a tick.
/// @param given_radius the user's tip_radius [m], used instead of the estimate when > 0
/// @throws InputError when the part has no triangles.
[[nodiscard]] PartPoints sample_part(const geometry::ToolPart& part, double given_radius);

}  // namespace palpate::contact
