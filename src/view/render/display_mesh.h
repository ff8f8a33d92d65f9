#pragma once
#include <functional>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::render {

/// How a surface is subdivided for display.
struct RefineRule {
  double crease_deg = 50.0;  // edges with a larger dihedral angle stay sharp and straight
  /// Whether to split an edge, given its midpoint, its length [m] and the angle [rad] between the normals at
  /// its ends.
  std::function<bool(const Vec3& middle, double length, double bend)> split;
};

/// [setup] Splits edges while `rule.split` asks for it (at most 12 rounds). New vertices lie on the curve
/// given by the end points and normals of the edge (curved point-normal triangles, Vlachos et al. 2001):
/// smooth parts of a coarse mesh become round, flat parts stay flat. A closed mesh stays closed; each
/// original vertex keeps its index and position.
[[nodiscard]] geometry::TriangleMesh refine_smoothly(const geometry::TriangleMesh& mesh,
                                                     const RefineRule& rule);

/// [setup] Smooths the small bumps of a coarse mesh. No vertex moves by more than `limit` [m]; vertices on
/// edges with a dihedral angle above `crease_deg` stay.
void smooth_bumps(geometry::TriangleMesh& mesh, double limit, double crease_deg);

/// [setup] Whether the sharp edges form straight lines and smooth curves, as those of blocks and instruments
/// do. Over a tight fold of a coarse organ they form a zigzag, which has to be smoothed away.
[[nodiscard]] bool has_clean_creases(const geometry::TriangleMesh& mesh, double crease_deg);

/// [setup] Splits the edges that lead from sharp edges into the surface at `band` [m] from them, so that
/// normals interpolated over the triangles turn within the band.
void narrow_creases(geometry::TriangleMesh& mesh, double crease_deg, double band);

/// [setup] Mean length of the edges [m].
[[nodiscard]] double mean_edge(const geometry::TriangleMesh& mesh);

/// [setup] One unit normal per corner (3 per triangle): area-weighted mean over the triangles around the
/// vertex whose angle to this one is at most `crease_deg`, so that edges of instruments stay sharp.
[[nodiscard]] std::vector<Vec3> corner_normals(const geometry::TriangleMesh& mesh, double crease_deg);

}  // namespace palpate::render
