#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "core/base/infinity.h"
#include "core/geometry/half_edges.h"
#include "palpate/mesh.h"

// The mesh under repair, its edges, and the repairs that need only its connectivity; for repair.cc.
namespace palpate::mesh_io {

using geometry::Corner;
using geometry::for_each_edge;
using geometry::HalfEdge;
using geometry::next_corner;
using geometry::previous_corner;
using geometry::sorted_half_edges;

inline constexpr std::uint8_t kReversed = 1;    // reversed against the input
inline constexpr std::uint8_t kAdded = 2;       // not in the input
inline constexpr std::uint8_t kDuplicated = 4;  // in the input twice, with opposite orientations

struct WorkSurface {
  geometry::TriangleMesh mesh;
  std::vector<std::uint8_t> marks;  // one per triangle

  explicit WorkSurface(geometry::TriangleMesh whole)
      : mesh(std::move(whole)), marks(mesh.triangles.size(), 0) {}

  [[nodiscard]] std::size_t corners() const { return 3 * mesh.triangles.size(); }
  [[nodiscard]] std::int32_t vertex_at(Corner corner) const { return mesh.triangles[corner / 3][corner % 3]; }
  [[nodiscard]] const Vec3& point(std::int32_t vertex) const {
    return mesh.vertices[static_cast<std::size_t>(vertex)];
  }
  [[nodiscard]] const Vec3& point_at(Corner corner) const { return point(vertex_at(corner)); }
  [[nodiscard]] double area(std::size_t triangle) const;
  [[nodiscard]] double area() const;

  void add(const geometry::Triangle& triangle, std::uint8_t mark) {
    mesh.triangles.push_back(triangle);
    marks.push_back(mark);
  }
  void turn(std::size_t triangle);
  /// Drops the triangles whose mark is not 0, then the unused vertices. @return the number of dropped
  /// triangles
  std::size_t drop(const std::vector<std::uint8_t>& doomed);
};

/// Drops unused vertices. The others keep their order.
void drop_unused_vertices(geometry::TriangleMesh& mesh);

/// Half the solid angle of a triangle seen from the origin, positive from behind the triangle [van Oosterom
/// and Strackee 1983].
[[nodiscard]] double half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// Axis-aligned bounding box of the added points; empty at first.
struct Box {
  Vec3 low = Vec3::Constant(kInfinity);
  Vec3 high = Vec3::Constant(-kInfinity);
  void add(const Vec3& point) { add(Box{point, point}); }
  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  [[nodiscard]] bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  [[nodiscard]] bool holds(const Box& other) const {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
};

/// Unites the fans of two triangles with a common edge, around both ends of the edge.
void unite_fans(const std::vector<geometry::Triangle>& triangles, Corner a, Corner b, DisjointSets& fans);

inline constexpr Corner kNoOpposite = 0xffffffffU;

/// The opposite half-edge of each half-edge, or kNoOpposite.
using Opposites = std::vector<Corner>;

/// The two half-edges of a manifold edge are opposite. A larger even number is paired so that each pair
/// encloses solid. With a larger odd number they have no opposite.
[[nodiscard]] Opposites pair_half_edges(const WorkSurface& surface);

/// How often a repair was made, and the number of its triangles.
struct RepairCount {
  std::size_t times = 0;
  std::size_t triangles = 0;
};

/// Drops triangles that use a vertex twice. @return their number
std::size_t drop_collapsed(WorkSurface& surface);
/// Keeps the first of triangles with the same three vertices. @return the number of dropped ones
std::size_t drop_duplicates(WorkSurface& surface);
/// Welds boundary vertices within `tolerance` [m]. @return the number of removed vertices
std::size_t weld_boundaries(WorkSurface& surface, double tolerance);
/// Drops patches at non-manifold edges that have a boundary.
RepairCount drop_dangling_faces(WorkSurface& surface);
/// Drops patches at non-manifold edges whose triangles existed with both orientations: faces between two
/// solids.
RepairCount drop_internal_faces(WorkSurface& surface);
/// Gives each fan of triangles around a bow-tie vertex its own vertex. @return the number of new vertices
std::size_t split_bow_tie_vertices(WorkSurface& surface, const Opposites& opposite);
/// For edges that are still non-manifold after that: divides the triangles of each pair of half-edges at
/// their own new midpoint. @return the number of new vertices
std::size_t split_non_manifold_edges(WorkSurface& surface, const Opposites& opposite);
/// Orients the triangles of each component consistently; the minority is reversed. @return false for a
/// one-sided surface
bool orient_consistently(WorkSurface& surface, const Opposites& opposite);
/// The component of each triangle, identified by its smallest triangle.
[[nodiscard]] std::vector<std::uint32_t> components_of(const Opposites& opposite);

}  // namespace palpate::mesh_io
