#pragma once
// Groups of neighbouring triangles with their moments for averaged normals. Used in set-up only.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/averaged_normals.h"

namespace palpate::contact {

/// Weighted sum of face normals [m^2] and its derivative with respect to the centre [m].
struct NormalSum {
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
};

/// Moments of one triangle.
struct TriangleMoments {
  Vec3 centre = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // unit
  Vec3 area = Vec3::Zero();    // twice the area vector
  std::array<Vec3, 3> middle;  // edge midpoints relative to `centre`; the opposite corner is twice as far
  double squares = 0.0;        // sum of the midpoints' squared distances
  double middles = 0.0;        // largest distance of a midpoint [m]
};

/// Sum of a group's triangles, for a centre from which all of them are within the radius h and count in full.
/// u is from `centre` to that point, A_f is twice a triangle's area vector, m are its edge midpoints relative
/// to `centre`. Then sum_f A_f sum_m (1 - |m - u|^2/h^2) = sum_A (3 - 3 |u|^2/h^2) + (2 M u - sum_q)/h^2
/// exactly, with sum_A = sum A_f, M = sum A_f (sum m)^T, sum_q = sum A_f sum |m|^2.
struct GroupMoments {
  Vec3 centre = Vec3::Zero();
  double reach = 0.0;        // largest distance of a corner from `centre` [m]
  Vec3 axis = Vec3::Zero();  // mean of the unit normals
  double spread = 0.0;       // largest distance of a unit normal from `axis`
  Vec3 sum_A = Vec3::Zero();
  Eigen::Matrix3d sum_Am = Eigen::Matrix3d::Zero();  // M
  Vec3 sum_Aq = Vec3::Zero();
  std::size_t first = 0;  // first piece, in the order of the groups
  std::size_t count = 0;
  std::size_t after = 0;  // index of the next node when this one's halves are skipped

  /// [setup] Adds all triangles, for a centre at `centre + u`.
  void add_to(NormalSum& sum, const Vec3& u, double radius) const noexcept;
};

/// A surface divided into groups: connected triangles near a first one, with similar normals.
class TriangleGroups final {
 public:
  /// [setup] @param size largest distance of a corner from the middle of the first triangle [m]; 0: one group
  /// per triangle, with the triangle's number
  TriangleGroups(const SurfaceView& surface, double size);

  [[nodiscard]] std::size_t size() const noexcept { return start_.size() - 1; }
  [[nodiscard]] std::span<const std::int32_t> triangles(std::int32_t group) const noexcept {
    return part(triangles_, start_, group);
  }
  /// Groups that share an edge with this one.
  [[nodiscard]] std::span<const std::int32_t> neighbours(std::int32_t group) const noexcept {
    return part(neighbours_, first_neighbour_, group);
  }
  [[nodiscard]] std::int32_t group_of(std::int32_t triangle) const noexcept {
    return group_of_[static_cast<std::size_t>(triangle)];
  }
  /// Whether the size is not 0; only then there are nodes and pieces.
  [[nodiscard]] bool are_larger() const noexcept { return !nodes_.empty(); }
  /// The group's binary tree in depth-first order.
  [[nodiscard]] const std::vector<GroupMoments>& nodes(std::int32_t group) const noexcept {
    return nodes_[static_cast<std::size_t>(group)];
  }
  [[nodiscard]] std::span<const TriangleMoments> pieces(const GroupMoments& of) const noexcept {
    return std::span(pieces_).subspan(of.first, of.count);
  }

 private:
  [[nodiscard]] static std::span<const std::int32_t> part(const std::vector<std::int32_t>& list,
                                                          const std::vector<std::int32_t>& start,
                                                          std::int32_t i) noexcept {
    const auto first = static_cast<std::size_t>(start[static_cast<std::size_t>(i)]);
    return std::span(list).subspan(first,
                                   static_cast<std::size_t>(start[static_cast<std::size_t>(i) + 1]) - first);
  }
  void grow(const SurfaceView& surface, double size);
  void link(const SurfaceView& surface);

  std::vector<std::int32_t> triangles_;  // by group
  std::vector<std::int32_t> start_;      // per group, and the end: start in triangles_
  std::vector<std::int32_t> group_of_;   // per triangle
  std::vector<std::int32_t> neighbours_;
  std::vector<std::int32_t> first_neighbour_;     // per group, and the end: start in neighbours_
  std::vector<TriangleMoments> pieces_;           // parallel to triangles_
  std::vector<std::vector<GroupMoments>> nodes_;  // per group
};

}  // namespace palpate::contact
