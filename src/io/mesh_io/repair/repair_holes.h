#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "io/mesh_io/repair/repair_surface.h"

// Holes of an evenly turned surface whose vertices each have one fan, for repair.cc.
namespace palpate::geometry {

struct Hole {
  std::vector<std::int32_t> loop;  // vertices in the order in which a patch runs along them
  double width = 0.0;              // diagonal of its bounding box [m]
  Vec3 middle = Vec3::Zero();      // of its bounding box [m]
};

/// All boundary loops. @param opposite half-edges of a surface without edges of more than two triangles
[[nodiscard]] std::vector<Hole> holes_of(const WorkSurface& surface, const Opposites& opposite);

/// The triangles over a loop of vertices that have the least area together; for a polygon in a plane that is
/// one way to cut it up, whatever its shape. [Barequet and Sharir 1995] n^3 / 6 steps.
/// @param may_join whether an edge may be made between two vertices that are not next to each other
/// @return empty where there is no way
[[nodiscard]] std::vector<Triangle> least_area_patch(
    const TriangleMesh& mesh, const std::vector<std::int32_t>& loop,
    const std::function<bool(std::int32_t, std::int32_t)>& may_join);

/// What closes a hole.
struct HolePatch {
  std::vector<Triangle> triangles;
  double area = 0.0;           // [m^2]
  std::optional<Vec3> middle;  // a new vertex, behind those that the surface has
};

/// All edges of a surface, sorted. Two holes share no vertex, so these serve for all its holes.
[[nodiscard]] std::vector<std::uint64_t> edges_of(const WorkSurface& surface);

/// The patch of the least area that has no edge of the surface; where there is none, a fan about the middle.
[[nodiscard]] HolePatch patch_of(const WorkSurface& surface, const std::vector<std::uint64_t>& edges,
                                 const Hole& hole);

}  // namespace palpate::geometry
