#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "io/mesh_io/repair/repair_surface.h"

// Holes of a consistently oriented surface without bow-tie vertices, for repair.cc.
namespace palpate::mesh_io {

struct Hole {
  std::vector<std::int32_t> loop;  // vertices in the order of a patch's orientation
  double width = 0.0;              // diagonal of its bounding box [m]
  Vec3 middle = Vec3::Zero();      // of its bounding box [m]
};

/// All boundary loops. @param opposite half-edges of a surface without non-manifold edges
[[nodiscard]] std::vector<Hole> holes_of(const WorkSurface& surface, const Opposites& opposite);

/// The triangulation of a loop of vertices with the smallest total area [Barequet and Sharir 1995]; n^3 / 6
/// steps. It also triangulates a planar polygon of any shape. @param may_join whether an edge may connect two
/// vertices that are not neighbours @return empty if there is no solution
[[nodiscard]] std::vector<geometry::Triangle> least_area_patch(
    const geometry::TriangleMesh& mesh, const std::vector<std::int32_t>& loop,
    const std::function<bool(std::int32_t, std::int32_t)>& may_join);

/// The triangles that close a hole.
struct HolePatch {
  std::vector<geometry::Triangle> triangles;
  double area = 0.0;           // [m^2]
  std::optional<Vec3> middle;  // a new vertex, after those of the surface
};

/// All edges of a surface, sorted. Two holes share no vertex, so one list serves all holes of a surface.
[[nodiscard]] std::vector<std::uint64_t> edges_of(const WorkSurface& surface);

/// The patch of least area without an existing edge of the surface; if none exists, a fan around the loop's
/// centre.
[[nodiscard]] HolePatch patch_of(const WorkSurface& surface, const std::vector<std::uint64_t>& edges,
                                 const Hole& hole);

}  // namespace palpate::mesh_io
