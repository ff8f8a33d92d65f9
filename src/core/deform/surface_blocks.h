#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/deform/float4x3.h"
#include "core/deform/profile_table.h"

namespace palpate::deform {

/// A vertex of the displaced surface, organ frame.
struct SurfaceVertex {
  Eigen::Vector3f position;  // [m]
  Eigen::Vector3f normal;    // unit
  float moved = 0.0F;        // length of the displacement [m]; negative: inwards
};

/// Four vertices of the displaced surface.
struct FourVertices {
  Float4x3 position, normal;
};
[[nodiscard]] FourVertices read_vertices(const std::array<const SurfaceVertex*, kLanes>& from) noexcept;
/// [any] Writes as many of four vertices as `out` has. @param displacement their whole one [m]
void write_vertices(const FourVertices& four, const Float4x3& displacement, const Float4x3& rest_normal,
                    std::span<SurfaceVertex* const> out) noexcept;

/// The displacement field of one contact, organ frame.
struct ContactField {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();        // the contact's position [m]
  Eigen::Vector3f normal_part = Eigen::Vector3f::Zero();  // normal part of the displacement there [m]
  Eigen::Vector3f side_part = Eigen::Vector3f::Zero();    // tangential part there [m]
  float reach = 1.0F;                                     // R_6 [m]
  float side_reach = 1.0F;                                // R_6 of the tangential part, at least `reach` [m]
  float lowered = 0.0F;                                   // u/D at which the profile is cut off
  float lowered_side = 0.0F;
  float limit = 0.0F;       // nothing farther than this moves [m]
  float own_excess = 0.0F;  // `excess` at the contact itself [m]
  // per vertex: geodesic minus straight distance from the contact [m]; infinity where nothing moves. Read to
  // a multiple of kLanes.
  std::span<const float> excess;
};

/// The rest vertices in blocks of 64, displaced four vertices at a time. Blocks should be small in space for
/// speed (OrganPicture orders its vertices so); results do not depend on it.
class SurfaceBlocks final {
 public:
  static constexpr std::size_t kBlock = 64;  // vertices

  /// [setup] @param normals unit, one per vertex
  SurfaceBlocks(std::span<const Eigen::Vector3f> vertices, std::span<const Eigen::Vector3f> normals);

  [[nodiscard]] std::size_t count() const noexcept { return spheres_.size(); }
  [[nodiscard]] std::size_t first(std::size_t block) const noexcept { return block * kBlock; }
  /// [any] Vertices of a block: kBlock, fewer in the last.
  [[nodiscard]] std::size_t size(std::size_t block) const noexcept;
  /// [any] Whether a vertex of the block may be within `radius` [m] of a point.
  [[nodiscard]] bool near(std::size_t block, const Eigen::Vector3f& point, float radius) const noexcept {
    const Sphere& sphere = spheres_[block];
    const float reach = radius + sphere.radius;
    return (sphere.middle - point).squaredNorm() < reach * reach;
  }

  /// [any] Lower bound of the distance [m] of the block's vertices from a point.
  [[nodiscard]] float distance(std::size_t block, const Eigen::Vector3f& point) const noexcept {
    return std::max(0.0F, (spheres_[block].middle - point).norm() - spheres_[block].radius);
  }

  /// [any] Writes the block's vertices under these contacts, blended as described at SurfaceDeformer. Normals
  /// follow from the displacement's derivative.
  /// @param out one entry per vertex of the block @return whether any vertex moves
  bool move(std::size_t block, std::span<const ContactField* const> contacts, const ProfileTable& profile,
            SurfaceVertex* out) const noexcept;
  /// [any] Writes the block's vertices at rest.
  void rest(std::size_t block, SurfaceVertex* out) const noexcept;

 private:
  struct Sphere {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    float radius = 0.0F;  // [m]
  };

  std::size_t vertices_;
  std::vector<Sphere> spheres_;
  // Per vertex, padded to a multiple of kLanes.
  std::vector<float> x_, y_, z_;     // [m]
  std::vector<float> nx_, ny_, nz_;  // unit
};

}  // namespace palpate::deform
