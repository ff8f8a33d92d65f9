#pragma once
// Patches of a surface with what their triangles add up to, for normals_by_clusters(); set-up only.
#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/averaged_normals.h"

namespace palpate::contact {

/// Some triangles, as one thing as long as they are far inside the reach. With u from `centre` to the point
/// whose normal is wanted, h the radius of the mean, A_f twice the area vector of a triangle and m the
/// middles of its three edges from `centre`:
///   sum_f A_f sum_m (1 - |m - u|^2/h^2) = sum_A (3 - 3 |u|^2/h^2) + (2 M u - sum_q)/h^2
/// exactly, with sum_A = sum A_f, M = sum A_f (sum m)^T, sum_q = sum A_f sum |m|^2.
struct Patch {
  std::array<float, 3> centre{};
  float reach = 0.0F;             // no vertex is farther from `centre` [m]
  std::array<float, 3> axis{};    // mean of the unit normals
  float spread = 0.0F;            // no unit normal is farther from `axis`
  std::array<float, 3> sum_A{};   // [m^2]
  std::array<float, 9> sum_Am{};  // M by rows [m^3]
  std::array<float, 3> sum_Aq{};  // [m^4]
  float longest_edge = 0.0F;      // [m]
};

/// Up to eight triangles by component, from the centre of their patch; what is not filled has no area.
struct Block {
  static constexpr std::size_t kSize = 8;
  using Row = std::array<float, kSize>;
  Patch patch;
  std::array<Row, 3> middle{};  // of the triangle: x, y, z [m]
  Row size{};  // sum over the middles of its edges of |from there to the triangle's middle|^2 [m^2]
  std::array<Row, 3> normal{};  // unit
  Row area{};                   // doubled [m^2]
  std::int32_t edges = -1;      // where the middles of the edges are, in edge_middles(); -1: edges are short
};

/// The middles of the edges of a block's triangles: x, y, z of the first edge's, the second's, the third's.
struct EdgeMiddles {
  std::array<Block::Row, 9> middle{};
};

/// The surface cut into clusters: triangles that hang together over edges, lie within a cell of an octree and
/// look within 90 degrees of one of them.
class NormalClusters final {
 public:
  /// Two triangles on either side of an edge between clusters.
  struct Link {
    std::int32_t from;
    std::int32_t to;
  };
  /// A cluster beside another, and its links from `first_link` to `last_link`.
  struct Neighbour {
    std::int32_t cluster;
    std::int32_t first_link;
    std::int32_t last_link;
  };
  struct Cluster {
    Patch patch;
    std::int32_t first_triangle;  // of triangles(); the next cluster's is the end
    std::int32_t first_block;
    std::int32_t first_neighbour;
  };

  /// [setup] @param largest edge of a cluster's cell at most [m] @param short_edge blocks with no longer edge
  /// go without EdgeMiddles [m]
  NormalClusters(const SurfaceView& surface, double largest, double short_edge);

  [[nodiscard]] std::size_t size() const noexcept { return clusters_.size() - 1; }
  /// Cluster i; number size() has only the ends of the last one.
  [[nodiscard]] const Cluster& cluster(std::size_t i) const noexcept { return clusters_[i]; }
  [[nodiscard]] const std::vector<Block>& blocks() const noexcept { return blocks_; }
  [[nodiscard]] const std::vector<EdgeMiddles>& edge_middles() const noexcept { return edge_middles_; }
  [[nodiscard]] const std::vector<Neighbour>& neighbours() const noexcept { return neighbours_; }
  [[nodiscard]] const std::vector<Link>& links() const noexcept { return links_; }
  [[nodiscard]] const std::vector<std::int32_t>& triangles() const noexcept { return triangles_; }
  [[nodiscard]] std::int32_t cluster_of(std::int32_t triangle) const noexcept {
    return cluster_of_[static_cast<std::size_t>(triangle)];
  }

 private:
  void grow(const SurfaceView& surface, const std::vector<std::int32_t>& order,
            const std::vector<std::int32_t>& cell_of);
  void sum_up(const SurfaceView& surface, double short_edge);
  void link(const SurfaceView& surface);

  std::vector<Cluster> clusters_;
  std::vector<Block> blocks_;
  std::vector<EdgeMiddles> edge_middles_;
  std::vector<Neighbour> neighbours_;
  std::vector<Link> links_;
  std::vector<std::int32_t> triangles_;   // by cluster, within one along a space-filling curve
  std::vector<std::int32_t> cluster_of_;  // of each triangle
};

}  // namespace palpate::contact
