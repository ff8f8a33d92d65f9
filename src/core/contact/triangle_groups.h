#pragma once
// Groups of neighbouring triangles, each with what its triangles add to an averaged normal; set-up only.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/averaged_normals.h"

namespace palpate::contact {

/// The sum of an averaged normal [m^2] and its slope with the point [m].
struct NormalSum {
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
};

/// Moments of one triangle for averaged normals.
struct Piece {
  Vec3 centre = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // unit
  Vec3 area = Vec3::Zero();    // twice the area vector
  std::array<Vec3, 3> middle;  // of its edges, from `centre`; the corner across from one is twice as far
  double squares = 0.0;        // sum of their squared distances
  double middles = 0.0;        // no middle is farther [m]
};

/// What a group's triangles add to the sum at a point, where all of them are within the radius h of the mean
/// and count in full. With u from `centre` to the point, A_f twice a triangle's area vector and m the middles
/// of its three edges from `centre`:
///   sum_f A_f sum_m (1 - |m - u|^2/h^2) = sum_A (3 - 3 |u|^2/h^2) + (2 M u - sum_q)/h^2
/// exactly, with sum_A = sum A_f, M = sum A_f (sum m)^T, sum_q = sum A_f sum |m|^2.
struct GroupMoments {
  Vec3 centre = Vec3::Zero();
  double reach = 0.0;        // no corner is farther from `centre` [m]
  Vec3 axis = Vec3::Zero();  // mean of the unit normals
  double spread = 0.0;       // no unit normal is farther from `axis`
  Vec3 sum_A = Vec3::Zero();
  Eigen::Matrix3d sum_Am = Eigen::Matrix3d::Zero();  // M
  Vec3 sum_Aq = Vec3::Zero();
  std::size_t first = 0;  // of its triangles, in the order of groups
  std::size_t count = 0;
  std::size_t after = 0;  // the node that follows when this is not looked into

  /// [setup] Adds all triangles at the point `centre + u`.
  void add_to(NormalSum& sum, const Vec3& u, double radius) const noexcept;
};

/// A surface in groups: triangles that hang together over edges, lie near one of them and look nearly its
/// way.
class TriangleGroups final {
 public:
  /// [setup] @param size no corner is farther from the first triangle's middle [m]; 0: one triangle a group,
  /// with the triangle's number
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
  /// Whether the size is not 0: only then there are nodes and pieces.
  [[nodiscard]] bool are_larger() const noexcept { return !nodes_.empty(); }
  /// The group, then its first half with all halves of that, then its second half in the same way.
  [[nodiscard]] const std::vector<GroupMoments>& nodes(std::int32_t group) const noexcept {
    return nodes_[static_cast<std::size_t>(group)];
  }
  [[nodiscard]] std::span<const Piece> pieces(const GroupMoments& of) const noexcept {
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
  std::vector<std::int32_t> start_;      // of each group, and the end, in triangles_
  std::vector<std::int32_t> group_of_;   // of each triangle
  std::vector<std::int32_t> neighbours_;
  std::vector<std::int32_t> first_neighbour_;     // of each group, and the end, in neighbours_
  std::vector<Piece> pieces_;                     // of triangles_
  std::vector<std::vector<GroupMoments>> nodes_;  // of each group
};

}  // namespace palpate::contact
