#pragma once
#include <cstdint>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// A closed manifold triangle surface with edge splits, collapses and flips. It stores the triangles around
/// each vertex. Removed vertices and triangles stay in the arrays until compact().
class EditableSurface final {
 public:
  struct Edge {
    std::int32_t a = 0;
    std::int32_t b = 0;
  };

  /// [setup] @param mesh closed and manifold (not checked)
  explicit EditableSurface(const TriangleMesh& mesh);

  std::vector<Vec3> points;   // [m]
  std::vector<Vec3> normals;  // unit, of the exact surface at each point; set by the caller
  std::vector<double> sizes;  // target edge length, relative; set by the caller

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<std::int32_t>& around(std::int32_t v) const {
    return around_[static_cast<std::size_t>(v)];
  }
  [[nodiscard]] int living_vertices() const { return living_; }
  /// All edges once, a < b, in a fixed order.
  [[nodiscard]] std::vector<Edge> edges() const;
  [[nodiscard]] bool has_edge(const Edge& edge) const;
  [[nodiscard]] double length(const Edge& edge) const { return (point(edge.a) - point(edge.b)).norm(); }
  /// Length divided by the mean target length of its ends.
  [[nodiscard]] double relative_length(const Edge& edge) const;

  /// Inserts a vertex at the midpoint of an edge.
  void split(const Edge& edge);
  /// Merges both ends at the midpoint, unless that changes the topology, folds a triangle, makes a sliver or
  /// an edge longer than `longest` (relative). @return whether it merged them
  bool collapse(const Edge& edge, double longest);
  /// Flips the edge in its two triangles if that increases their smallest angle and folds none.
  bool flip_if_better(const Edge& edge);

  /// Cosine of the triangle's smallest angle: 0.5 for an equilateral triangle, 1 for a degenerate one.
  [[nodiscard]] double sharpest(const Vec3& a, const Vec3& b, const Vec3& c) const;

  void compact();
  [[nodiscard]] TriangleMesh mesh() const;

 private:
  [[nodiscard]] const Vec3& point(std::int32_t v) const { return points[static_cast<std::size_t>(v)]; }
  struct Wing {
    std::int32_t triangle = -1;
    std::int32_t opposite = -1;
  };
  /// The triangle in which b follows a.
  [[nodiscard]] Wing wing(std::int32_t a, std::int32_t b) const;
  [[nodiscard]] bool faces_outward(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) const;
  [[nodiscard]] bool collapse_allowed(const Edge& edge, const Wing& left, const Wing& right) const;
  [[nodiscard]] bool collapse_shapes_well(const Edge& edge, const Vec3& middle, double longest) const;
  void replace_corner(std::int32_t triangle, std::int32_t from, std::int32_t to);
  void set_triangle(std::int32_t triangle, const Triangle& corners);
  void detach(std::int32_t triangle, std::int32_t vertex);
  std::int32_t add_triangle(const Triangle& corners);

  std::vector<Triangle> triangles_;
  std::vector<std::vector<std::int32_t>> around_;
  int living_ = 0;
};

}  // namespace palpate::geometry
