#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "palpate/mesh.h"

// Bounding-volume hierarchy for signed_distance.cc.
namespace palpate::geometry {

/// Four bounding volumes, one per SIMD lane: flat cylinders (discs) along the surface. A disc bounds a
/// surface patch more closely than an axis-aligned box does, so a query visits few triangles. Coordinates are
/// relative to the tree's origin, in single precision, rounded outwards.
struct alignas(64) DiscNode {
  std::array<float, 4> centre_x, centre_y, centre_z;  // m
  std::array<float, 4> axis_x, axis_y, axis_z;        // unit
  std::array<float, 4> radius;                        // perpendicular to the axis [m]; negative: empty lane
  std::array<float, 4> height;                        // half the height, along the axis [m]
};

/// Four triangles, one per lane, relative to the tree's origin, rounded to single precision.
struct alignas(16) TriangleNode {
  std::array<float, 4> corner_x, corner_y, corner_z;  // first corner [m]; infinitely far in an empty lane
  std::array<float, 4> ab_x, ab_y, ab_z;              // first to second corner [m]
  std::array<float, 4> ac_x, ac_y, ac_z;              // first to third corner
};

/// A tree with four children per node over the triangles of a mesh, without pointers: triangles are sorted so
/// that each run of 4, 16, 64 ... is a compact patch. The four triangles of leaf k are at slots 4k to 4k + 3.
class DiscBvh final {
 public:
  static constexpr int kMaxLevels = 16;  // 4^16 triangles are more than 32 bits can count
  static constexpr int kMaxVisits = 3 * kMaxLevels + 4;

  /// [setup] `mesh` has at least one triangle and finite vertices.
  explicit DiscBvh(const TriangleMesh& mesh);

  /// The triangle at each slot.
  [[nodiscard]] std::span<const std::int32_t> triangle_of() const noexcept { return triangle_of_; }
  /// [any] Memory of the tree [bytes].
  [[nodiscard]] std::size_t bytes() const noexcept {
    return nodes_.size() * sizeof(DiscNode) + leaves_.size() * sizeof(TriangleNode) +
           triangle_of_.size() * sizeof(std::int32_t);
  }

  /// [rt] Calls visit(slot) for triangles in the order of the lower bounds of their distances to p, while
  /// these do not exceed reach(). reach() returns a squared distance, which may shrink with every call.
  template <typename Visit, typename Reach>
  void each_within(const Vec3& p, Visit visit, Reach reach) const noexcept;

  /// [rt] Calls visit(slot) for every triangle that may be within `slack` [m] of the segment from a to b.
  template <typename Visit>
  void each_along(const Vec3& a, const Vec3& b, double slack, Visit visit) const noexcept;

 private:
  [[nodiscard]] const DiscNode& node_at(int level, std::uint32_t index) const noexcept {
    return nodes_[start_[static_cast<std::size_t>(level - 1)] + index];
  }
  template <typename Visit>
  void visit_leaf(std::uint32_t leaf, Visit visit) const noexcept {
    const auto end = static_cast<std::uint32_t>(triangle_of_.size());
    for (std::uint32_t slot = 4 * leaf; slot < 4 * leaf + 4 && slot < end; ++slot) {
      visit(static_cast<std::int32_t>(slot));
    }
  }

  void order(const std::vector<Vec3>& centres, std::int32_t begin, std::int32_t end);
  void fill_leaves(const TriangleMesh& mesh);
  void fill_lane(const TriangleMesh& mesh, std::size_t slot);
  void bound_level(const TriangleMesh& mesh, int level);

  std::vector<TriangleNode> leaves_;                   // level 0
  std::vector<DiscNode> nodes_;                        // level by level from 1, the root last
  std::array<std::uint32_t, kMaxLevels + 1> start_{};  // of each level
  int levels_ = 0;                                     // without the leaves
  std::vector<std::int32_t> triangle_of_;
  Vec3 origin_ = Vec3::Zero();
  double extent_ = 0.0;  // largest coordinate relative to the origin [m]
};

}  // namespace palpate::geometry
