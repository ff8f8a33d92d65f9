#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/implicit.h"

namespace palpate::geometry {

/// What remesh() shall make.
struct RemeshGoal {
  int vertices = 0;      // exactly so many, before `quadruplings`
  int quadruplings = 0;  // how often every triangle is then divided into four (and relaxed): V -> 4 V - 6
  double bend_radius =
      0.015;            // [m] an edge is half as long where the surface bends by this radius as on a plane
  double finest = 0.3;  // shortest edge over the longest, at most this fine
  int rounds = 9;       // of splitting, collapsing, flipping and smoothing before the count is fixed
  int polish = 8;       // of flipping and smoothing after it
  int touch = 3;        // the same after each quadrupling
};

/// [setup] Meshes a solid's surface anew: well-shaped triangles, smaller where the surface bends, every
/// vertex on the surface, an exact count. Split, collapse, flip and tangential smoothing in turn (as Botsch
/// and Kobbelt 2004), each round followed by a Newton step back to the surface; the topology of `start`
/// stays. Deterministic: fixed order, only + - * / and sqrt.
/// @param start closed manifold mesh of about the solid's surface, turned outwards (see polygonise)
/// @throws InputError when the count cannot be reached.
[[nodiscard]] TriangleMesh remesh(const ImplicitSolid& solid, const TriangleMesh& start,
                                  const RemeshGoal& goal);

}  // namespace palpate::geometry
