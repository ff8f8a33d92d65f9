#pragma once
#include <functional>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::render {

/// How a surface is refined for the picture.
struct RefineRule {
  double crease_deg = 50.0;  // edges that bend more stay sharp and straight
  /// Whether an edge is to be split, given its middle, its length [m] and the angle [rad] between the normals
  /// at its ends.
  std::function<bool(const Vec3& middle, double length, double bend)> split;
};

/// [setup] Splits edges as `rule` says until none is left (at most 12 rounds). New vertices lie on the curve
/// that
/// the edge's end points and normals define (curved point-normal triangles, Vlachos et al. 2001), so a coarse
/// mesh becomes round where it is smooth, and stays flat where it is flat. Closed stays closed; every
/// original vertex keeps its index and place.
[[nodiscard]] geometry::TriangleMesh refine_smoothly(const geometry::TriangleMesh& mesh,
                                                     const RefineRule& rule);

/// [setup] Evens out the small bumps that a coarse mesh leaves, no vertex by more than `limit` [m]; vertices
/// on edges that bend more than `crease_deg` stay.
void even_out(geometry::TriangleMesh& mesh, double limit, double crease_deg);

/// [setup] Unit vertex normals: the triangles' normals weighted by their angle there; zero for a vertex
/// without triangles.
[[nodiscard]] std::vector<Vec3> vertex_normals(const std::vector<Vec3>& vertices,
                                               const std::vector<geometry::Triangle>& triangles);

/// [setup] Mean length of the edges [m].
[[nodiscard]] double mean_edge(const geometry::TriangleMesh& mesh);

/// [setup] One unit normal a corner (3 a triangle): the area-weighted mean of the triangles around the vertex
/// that bend at most `crease_deg` from this one, so that edges of instruments stay sharp.
[[nodiscard]] std::vector<Vec3> corner_normals(const geometry::TriangleMesh& mesh, double crease_deg);

}  // namespace palpate::render
