#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/implicit.h"

namespace palpate::geometry {

/// Parameters of remesh().
struct RemeshParameters {
  int vertices = 0;      // exact number, before `subdivisions`
  int subdivisions = 0;  // midpoint subdivisions after that, each with relaxation: V -> 4 V - 6
  double bend_radius =
      0.015;            // [m] an edge is half as long where the surface bends by this radius as on a plane
  double finest = 0.3;  // smallest ratio of the shortest to the longest target edge
  int rounds = 9;       // of splitting, collapsing, flipping and smoothing, before the count is fixed
  int polish = 8;       // of flipping and smoothing, after it
  int touch = 3;        // of flipping and smoothing, after each subdivision
};

/// [setup] Remeshes a solid's surface: well-shaped triangles, smaller where the curvature is large, all
/// vertices on the surface, an exact count. Rounds of split, collapse, flip and tangential smoothing (as
/// Botsch and Kobbelt 2004), each followed by a Newton step to the surface. The topology of `start` does not
/// change. Deterministic: fixed order, only + - * / and sqrt. @param start closed manifold mesh near the
/// solid's surface, oriented outwards (see polygonise) @throws InputError when the count cannot be reached.
[[nodiscard]] TriangleMesh remesh(const ImplicitSolid& solid, const TriangleMesh& start,
                                  const RemeshParameters& goal);

}  // namespace palpate::geometry
