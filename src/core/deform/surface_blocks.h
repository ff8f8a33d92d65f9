#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/deform/profile_table.h"

namespace palpate::deform {

/// A vertex of a surface that moves, as the picture takes it. Organ frame.
struct LiveVertex {
  Eigen::Vector3f position;  // [m]
  Eigen::Vector3f normal;    // unit
  float moved = 0.0F;        // how far from its place at rest [m]; negative: inwards
};

/// What one contact does to the surface around it. Organ frame.
struct ContactField {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();        // the contact [m]
  Eigen::Vector3f normal_part = Eigen::Vector3f::Zero();  // displacement there across the surface [m]
  Eigen::Vector3f side_part = Eigen::Vector3f::Zero();    // and along it [m]
  float reach = 1.0F;                                     // R_6 [m]
  float side_reach = 1.0F;                                // the same of the side part, at least `reach` [m]
  float lowered = 0.0F;                                   // u/D at which the profile is taken to end
  float lowered_side = 0.0F;
  float limit = 0.0F;             // nothing farther than this from the point moves [m]
  float own_excess = 0.0F;        // `excess` at the contact itself [m]
  std::span<const float> excess;  // of each vertex: how much longer than straight the way from the contact
                                  // is; infinite where nothing moves. Read to a multiple of kLanes.
};

/// The vertices of a surface at rest, in runs of 64 that are moved together, four at a time. For speed runs
/// should be small in space (OrganPicture orders its vertices so); the result does not depend on it.
class SurfaceBlocks final {
 public:
  static constexpr std::size_t kBlock = 64;  // vertices

  /// [setup] @param normals unit, as many as vertices
  SurfaceBlocks(std::span<const Eigen::Vector3f> vertices, std::span<const Eigen::Vector3f> normals);

  [[nodiscard]] std::size_t count() const noexcept { return spheres_.size(); }
  [[nodiscard]] std::size_t first(std::size_t block) const noexcept { return block * kBlock; }
  /// [any] Vertices of a block: kBlock but for the last.
  [[nodiscard]] std::size_t size(std::size_t block) const noexcept;
  /// [any] Whether a vertex of the block may be within `radius` [m] of a point.
  [[nodiscard]] bool near(std::size_t block, const Eigen::Vector3f& point, float radius) const noexcept {
    const Sphere& sphere = spheres_[block];
    const float reach = radius + sphere.radius;
    return (sphere.middle - point).squaredNorm() < reach * reach;
  }

  /// [any] Writes where the block's vertices are under these contacts together, several as SurfaceDeformer
  /// says. Normals follow from the displacement's derivative.
  /// @param out as many as the block has @return whether any of them moves
  bool move(std::size_t block, std::span<const ContactField* const> contacts, const ProfileTable& profile,
            LiveVertex* out) const noexcept;
  /// [any] Writes the block's vertices at rest.
  void rest(std::size_t block, LiveVertex* out) const noexcept;

 private:
  struct Sphere {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    float radius = 0.0F;  // [m]
  };

  std::size_t vertices_;
  std::vector<Sphere> spheres_;
  // Of each vertex, filled up to a multiple of kLanes.
  std::vector<float> x_, y_, z_;     // [m]
  std::vector<float> nx_, ny_, nz_;  // unit
};

}  // namespace palpate::deform
