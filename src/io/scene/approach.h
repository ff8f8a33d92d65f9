#pragma once
// Finds where a tool can press an organ along its normal; for the default tool path.
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/cell.h"
#include "core/geometry/signed_distance.h"
#include "palpate/mesh.h"

namespace palpate::scene {

/// A straight path of a tool towards an organ, in the organ's frame.
struct Approach {
  Vec3 touch = Vec3::Zero();       // m, first contact of the tip with the surface
  Vec3 direction = Vec3::UnitZ();  // unit, of the motion; the tool's +z
};

/// A tool that points down: its +z is the frame's -z.
struct HangingTool {
  std::vector<Vec3> points;  // m, samples of its surface, relative to its tip
  double clearance = 0.0;    // m, height of the tip above the touch at the start
};

/// Result of checking an approach down to some depth.
struct ApproachCheck {
  bool square = false;     // the tool starts outside, its path is free, the surface is flat, and only the tip
                           // presses, without sliding
  bool thick = false;      // square, and the organ continues behind the tip
  double thickness = 0.0;  // m, of the organ behind the touch, at most the thickness needed
};

struct CheckedApproach {
  Approach approach;
  ApproachCheck result;
};

/// Checks approaches to one organ and searches for good ones.
class ApproachFinder final {
 public:
  /// [setup] Keeps references to surface and tool. @throws InputError when the organ is not closed.
  ApproachFinder(const geometry::TriangleMesh& organ, const geometry::SignedDistance& surface,
                 const HangingTool& tool);
  ApproachFinder(const ApproachFinder&) = delete;
  ApproachFinder& operator=(const ApproachFinder&) = delete;

  /// [setup] Checks a press down to `depth` [m] behind the touch.
  [[nodiscard]] ApproachCheck check(const Approach& approach, double depth) const;

  /// [setup] Searches approaches along the normals of sample points all over the organ. Prefers a thick one,
  /// then a square one. Among those it takes the flattest; of two that are about as flat, the one nearer to
  /// `up` (unit).
  [[nodiscard]] CheckedApproach best(const Vec3& up, double depth) const;

 private:
  struct LocalShape {
    Vec3 normal = Vec3::UnitZ();  // unit, mean around the point
    double flatness = 0.0;        // 0 .. 1: how well the normals on this side agree
    double breadth = 0.0;         // 0 .. 1: area around the point, relative to a flat disc
    [[nodiscard]] bool is_flat() const;
  };

  /// As check(), for a flat point; `start` is the triangle of fine_ that has the touch.
  [[nodiscard]] ApproachCheck check_from(const Approach& approach, std::int32_t start, double depth) const;
  [[nodiscard]] LocalShape local_shape(const Vec3& point, const Vec3& outward, double depth) const;
  [[nodiscard]] double depth_reached(const Approach& approach, std::int32_t start, double depth) const;
  [[nodiscard]] double thickness(const Approach& approach, double enough) const;
  [[nodiscard]] bool is_free(const Approach& approach, double depth) const;

  /// Three numbers of 21 bits: the cell's coordinates above lowest_, clamped. Ordered as the cells.
  [[nodiscard]] std::uint64_t key_of(const geometry::Cell& cell) const;

  const geometry::SignedDistance& surface_;
  const HangingTool& tool_;
  double length_;  // m, diagonal of the organ's bounding box
  using Neighbours = std::vector<std::array<std::int32_t, 3>>;
  geometry::TriangleMesh own_;  // empty where the organ's triangles are small
  bool is_fine_;
  const geometry::TriangleMesh& fine_;  // the organ, refined to small triangles
  Neighbours own_neighbours_;           // empty where own_ is
  const Neighbours& neighbours_;
  std::vector<Vec3> middles_;  // centroids of its triangles
  std::vector<Vec3> areas_;    // twice their areas, along the outward normals
  geometry::Cell lowest_;      // grid cell of the lowest corner of the organ's box
  std::vector<std::pair<std::uint64_t, std::int32_t>> cells_;  // sorted: the grid cell of each centroid
};

/// [any] The smallest rotation that turns -z to `direction` (unit).
[[nodiscard]] Quat turn_from_down(const Vec3& direction) noexcept;

}  // namespace palpate::scene
