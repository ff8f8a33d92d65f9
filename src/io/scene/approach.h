#pragma once
// Where a tool can press an organ squarely: for the default path.
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/cell.h"
#include "core/geometry/surface_distance.h"
#include "palpate/mesh.h"

namespace palpate::scene {

/// A tool's straight way onto an organ, in the organ's frame.
struct Approach {
  Vec3 touch = Vec3::Zero();       // m, where the tool's tip meets the surface
  Vec3 direction = Vec3::UnitZ();  // unit, of the motion: the tool's +z
};

/// A tool that hangs down, its +z towards -z.
struct HangingTool {
  std::vector<Vec3> points;  // m, all over its surface, about its tip
  double clearance = 0.0;    // m, of the tip above the touch, where it starts
};

/// What comes of an approach to some depth.
struct Judgement {
  bool square = false;     // the tool starts outside and has a straight way in, the place is flat, and the
                           // tip alone presses there without sliding aside
  bool thick = false;      // square, and the organ goes on behind the tip
  double thickness = 0.0;  // m, of the organ behind the touch, up to what is enough
};

struct JudgedApproach {
  Approach approach;
  Judgement judgement;
};

/// Judges approaches to one organ and looks for good ones.
class ApproachFinder final {
 public:
  /// [setup] Keeps references to surface and tool. @throws InputError when the organ is not closed
  ApproachFinder(const geometry::TriangleMesh& organ, const geometry::SurfaceDistance& surface,
                 const HangingTool& tool);

  /// [setup] A press `depth` [m] behind the touch.
  [[nodiscard]] Judgement judge(const Approach& approach, double depth) const;

  /// [setup] Of approaches along the normal to places all over the organ a thick one, else a square one, else
  /// none in particular: the flattest; of about as flat ones the nearest to `up` (unit).
  [[nodiscard]] JudgedApproach best(const Vec3& up, double depth) const;

 private:
  struct Place {
    Vec3 normal = Vec3::UnitZ();  // unit, the mean around it
    double flatness = 0.0;        // 0 .. 1: how far the faces around it agree, without those of the far side
    double breadth = 0.0;         // 0 .. 1: how much of a plane's disc they make up
  };

  /// As judge(), for a place that is flat, from the triangle of fine_ that the touch is on.
  [[nodiscard]] Judgement judge_from(const Approach& approach, std::int32_t start, double depth) const;
  [[nodiscard]] Place place_at(const Vec3& point, const Vec3& outward, double depth) const;
  [[nodiscard]] double depth_reached(const Approach& approach, std::int32_t start, double depth) const;
  [[nodiscard]] double thickness(const Approach& approach, double enough) const;
  [[nodiscard]] bool is_free(const Approach& approach, double depth) const;

  const geometry::SurfaceDistance& surface_;
  const HangingTool& tool_;
  double length_;                // of the organ's box from corner to corner [m]
  geometry::TriangleMesh fine_;  // the organ, refined until a triangle is small beside a place
  std::vector<std::array<std::int32_t, 3>> neighbours_;
  std::vector<Vec3> middles_;  // of its triangles
  std::vector<Vec3> areas_;    // twice their areas, along the outward normals
  std::vector<std::pair<geometry::Cell, std::int32_t>> cells_;  // sorted: where each middle is
};

/// [any] The shortest turn of -z towards `direction` (unit).
[[nodiscard]] Quat turn_from_down(const Vec3& direction) noexcept;

}  // namespace palpate::scene
