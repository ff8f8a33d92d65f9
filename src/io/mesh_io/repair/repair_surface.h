#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/infinity.h"
#include "core/geometry/half_edges.h"
#include "palpate/mesh.h"

// The mesh that is being repaired, its edges, and the steps that need no more than who meets whom; for
// repair.cc.
namespace palpate::geometry {

inline constexpr std::uint8_t kTurned = 1;   // the other way round than in the input
inline constexpr std::uint8_t kAdded = 2;    // not in the input
inline constexpr std::uint8_t kDoubled = 4;  // was there twice, once each way round

struct WorkSurface {
  TriangleMesh mesh;
  std::vector<std::uint8_t> marks;  // of each triangle

  explicit WorkSurface(TriangleMesh whole) : mesh(std::move(whole)), marks(mesh.triangles.size(), 0) {}

  [[nodiscard]] std::size_t corners() const { return 3 * mesh.triangles.size(); }
  [[nodiscard]] std::int32_t vertex_at(Corner corner) const { return mesh.triangles[corner / 3][corner % 3]; }
  [[nodiscard]] const Vec3& point(std::int32_t vertex) const {
    return mesh.vertices[static_cast<std::size_t>(vertex)];
  }
  [[nodiscard]] const Vec3& point_at(Corner corner) const { return point(vertex_at(corner)); }
  [[nodiscard]] double area(std::size_t triangle) const;
  [[nodiscard]] double area() const;

  void add(const Triangle& triangle, std::uint8_t mark) {
    mesh.triangles.push_back(triangle);
    marks.push_back(mark);
  }
  void turn(std::size_t triangle);
  /// Drops the triangles that are marked with anything but 0, and then the vertices that none uses.
  /// @return how many triangles were dropped
  std::size_t drop(const std::vector<std::uint8_t>& doomed);
};

/// Drops the vertices that no triangle uses. The others keep their order.
void drop_unused_vertices(TriangleMesh& mesh);

/// Half the solid angle at which a triangle is seen from the origin, positive from behind its outside. [van
/// Oosterom and Strackee 1983]
[[nodiscard]] double half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// Axis-aligned box of what was added; empty at first.
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

/// Groups of triangles that hang together in some way; the smallest member names the group.
class DisjointSets final {
 public:
  explicit DisjointSets(std::size_t count);
  std::uint32_t find(std::uint32_t n);
  void unite(std::uint32_t a, std::uint32_t b);

 private:
  std::vector<std::uint32_t> parent_;
};

/// Two triangles at an edge, each with its corner of it, are of one fan about either end.
void unite_fans(const std::vector<Triangle>& triangles, Corner a, Corner b, DisjointSets& fans);

inline constexpr Corner kNoOpposite = 0xffffffffU;

/// For each half-edge its opposite one, or kNoOpposite.
using Opposites = std::vector<Corner>;

/// Two half-edges of an edge are opposite; of a larger even number they are paired so that what lies between
/// two is solid. Half-edges of an edge with a larger odd number have no opposite.
[[nodiscard]] Opposites pair_half_edges(const WorkSurface& surface);

/// How often something was done, and to how many triangles.
struct Done {
  std::size_t times = 0;
  std::size_t triangles = 0;
};

/// Drops triangles that name a vertex twice. @return how many
std::size_t drop_collapsed(WorkSurface& surface);
/// Of triangles with the same three vertices keeps the first. @return how many went
std::size_t drop_duplicates(WorkSurface& surface);
/// Joins vertices at boundaries that lie within `tolerance` [m]. @return how many went
std::size_t weld_boundaries(WorkSurface& surface, double tolerance);
/// At edges of more than two triangles drops patches that end in a boundary.
Done drop_dangling_faces(WorkSurface& surface);
/// At edges of more than two triangles drops patches that were there once each way round: faces between two
/// solids.
Done drop_internal_faces(WorkSurface& surface);
/// Gives each fan of triangles about a bow-tie vertex a vertex of its own. @return how many vertices came
std::size_t split_bow_tie_vertices(WorkSurface& surface, const Opposites& opposite);
/// Where an edge is still of more than two triangles after that, cuts the triangles of each pair of
/// half-edges in half at a middle of their own. @return how many middles came
std::size_t split_non_manifold_edges(WorkSurface& surface, const Opposites& opposite);
/// Turns triangles so that all of one component agree, the fewer to the more. @return false for one-sided
/// surfaces
bool orient_consistently(WorkSurface& surface, const Opposites& opposite);
/// The component of each triangle, by its smallest triangle.
[[nodiscard]] std::vector<std::uint32_t> components_of(const Opposites& opposite);

}  // namespace palpate::geometry
