#include "core/geometry/signed_distance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/index.h"
#include "core/base/infinity.h"
#include "core/base/parallel.h"
#include "core/base/portable_math.h"
#include "core/geometry/disc_search.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

std::atomic<std::uint64_t> built{0};  // hierarchies

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// A triangle whose height is below this fraction of its longest edge counts as its edges only, because its
// normal is rounding noise.
constexpr double kSliver = 1e-7;

// The nearest feature of a triangle: corner 0..2, edge 3..5 (from corner e - 3 to the next), or the face.
constexpr int kFirstEdge = 3;
constexpr int kFace = 6;

using Corners = std::array<Vec3, 3>;

constexpr std::array<std::size_t, 3> kNext{1, 2, 0};

struct OnTriangle {
  Vec3 point;
  double distance_squared = kInfinity;
  int feature = 0;
};

/// Normal of a triangle, not unit; zero for a sliver.
Vec3 plane_normal(const Corners& corner) noexcept {
  double longest_squared = 0.0;
  std::size_t longest_edge = 0;
  for (std::size_t e = 0; e < 3; ++e) {
    const double length_squared = (corner[kNext[e]] - corner[e]).squaredNorm();
    if (length_squared > longest_squared) {
      longest_squared = length_squared;
      longest_edge = e;
    }
  }
  // The cross product of the two shorter edges, at the corner opposite to the longest one, has the smallest
  // error.
  const Vec3& apex = corner[kNext[kNext[longest_edge]]];
  Vec3 normal = (corner[longest_edge] - apex).cross(corner[kNext[longest_edge]] - apex);
  if (!(normal.squaredNorm() > kSliver * kSliver * longest_squared * longest_squared)) normal.setZero();
  return normal;
}

/// The nearest point on edge e; replaces `best` if it is nearer.
void try_edge(const Corners& corner, std::size_t e, const Vec3& p, OnTriangle& best) noexcept {
  const Vec3& a = corner[e];
  const Vec3& b = corner[kNext[e]];
  const Vec3 ab = b - a;
  const double length_squared = ab.squaredNorm();
  const double u = length_squared > 0.0 ? (p - a).dot(ab) * (1.0 / length_squared) : 0.0;
  int feature = kFirstEdge + static_cast<int>(e);
  // From the nearer end, so that the results of the edge's two triangles agree closely.
  const Vec3& origin = u <= 0.5 ? a : b;
  double along = u <= 0.5 ? u : u - 1.0;
  if (u <= 0.0 || u >= 1.0) {
    along = 0.0;
    feature = static_cast<int>(u <= 0.0 ? e : kNext[e]);
  }
  const Vec3 point = origin + along * ab;
  const double distance_squared = (p - point).squaredNorm();
  if (distance_squared < best.distance_squared) best = {point, distance_squared, feature};
}

/// The projection of p if it is inside the triangle, otherwise the nearest point on the edges that p is
/// outside of (all edges of a sliver).
/// @param normal plane_normal(corner)
OnTriangle nearest_on(const Corners& corner, const Vec3& normal, const Vec3& p) noexcept {
  OnTriangle best;
  const double normal_squared = normal.squaredNorm();
  const bool is_sliver = normal_squared == 0.0;
  std::array<double, 3> side;
  for (std::size_t e = 0; e < 3; ++e) {
    side[e] = normal.cross(corner[kNext[e]] - corner[e]).dot(p - corner[e]);
  }
  if (!is_sliver && side[0] >= 0.0 && side[1] >= 0.0 && side[2] >= 0.0) {
    const double height = (p - corner[0]).dot(normal);
    const double inverse = 1.0 / normal_squared;
    best.point = p - (height * inverse) * normal;
    best.distance_squared = height * height * inverse;
    best.feature = kFace;
    return best;
  }
  for (std::size_t e = 0; e < 3; ++e) {
    if (is_sliver || side[e] < 0.0) try_edge(corner, e, p, best);
  }
  return best;
}

/// A segment, sheared to the z axis from 0 to 1, so that both triangles of an edge see the same edge and the
/// segment cannot slip between them [Woop, Benthin and Wald 2013].
struct ShearedSegment {
  Vec3 start;
  Vec3 direction;
  int kx = 0, ky = 1, kz = 2;
  double shear_x = 0.0, shear_y = 0.0, scale_z = 0.0;

  ShearedSegment(const Vec3& a, const Vec3& b) noexcept : start(a), direction(b - a) {
    direction.cwiseAbs().maxCoeff(&kz);
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    if (direction[kz] < 0.0) std::swap(kx, ky);  // keeps the orientation of triangles
    scale_z = 1.0 / direction[kz];
    shear_x = direction[kx] * scale_z;
    shear_y = direction[ky] * scale_z;
  }

  [[nodiscard]] Vec3 sheared(const Vec3& p) const noexcept {
    const Vec3 q = p - start;
    return {q[kx] - shear_x * q[kz], q[ky] - shear_y * q[kz], q[kz] * scale_z};
  }

  /// Fraction at which the segment's line enters through the triangle, or infinity. Rounding is monotonic, so
  /// an edge function may become zero but never changes its sign; zero counts as inside.
  [[nodiscard]] double entry_fraction(const Corners& corner) const noexcept {
    const Vec3 a = sheared(corner[0]);
    const Vec3 b = sheared(corner[1]);
    const Vec3 c = sheared(corner[2]);
    const double u = c.x() * b.y() - c.y() * b.x();
    const double v = a.x() * c.y() - a.y() * c.x();
    const double w = b.x() * a.y() - b.y() * a.x();
    if (!(u >= 0.0 && v >= 0.0 && w >= 0.0)) return kInfinity;
    const double determinant = u + v + w;
    const double low = std::min({a.z(), b.z(), c.z()});
    const double high = std::max({a.z(), b.z(), c.z()});
    if (determinant > 0.0) {
      return std::clamp((u * a.z() + v * b.z() + w * c.z()) / determinant, low, high);
    }
    // Seen almost edge-on: its projected area rounds to zero.
    const Vec3 normal = plane_normal(corner);
    const double approach = normal.dot(direction);
    if (!(approach < 0.0)) return kInfinity;
    return std::clamp(normal.dot(corner[0] - start) / approach, low, high);
  }
};

std::vector<std::array<std::int32_t, 3>> neighbours_of_closed(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw InputError("the mesh has no triangles");
  auto neighbours = edge_neighbours(mesh);
  int open_edges = 0;
  for (const auto& around : neighbours)
    open_edges += static_cast<int>(std::count(around.begin(), around.end(), -1));
  if (open_edges > 0) {
    throw InputError("the mesh is not closed: " + std::to_string(open_edges) + " boundary edges");
  }
  return neighbours;
}

}  // namespace

struct SignedDistance::Tree {
  struct Best {
    OnTriangle on;
    std::int32_t triangle = -1;
  };

  explicit Tree(const TriangleMesh& of) : neighbours(neighbours_of_closed(of)), mesh(of), discs(of) {}

  std::vector<std::array<std::int32_t, 3>> neighbours;  // across the edges, by triangle
  TriangleMesh mesh;
  DiscBvh discs;
  std::vector<Vec3> plane_normals;  // by triangle
  std::vector<Vec3> vertex_normals;
  double scale = 0.0;  // largest coordinate [m], for rounding bounds

  [[nodiscard]] Corners corners(std::int32_t triangle) const noexcept {
    const Triangle& vertex = mesh.triangles[at(triangle)];
    return {mesh.vertices[at(vertex[0])], mesh.vertices[at(vertex[1])], mesh.vertices[at(vertex[2])]};
  }

  void consider(std::int32_t triangle, const Vec3& p, Best& best) const noexcept {
    const OnTriangle on = nearest_on(corners(triangle), plane_normals[at(triangle)], p);
    const bool is_nearer = on.distance_squared < best.on.distance_squared ||
                           (on.distance_squared == best.on.distance_squared && triangle < best.triangle);
    if (is_nearer) best = {on, triangle};
  }

  /// The nearest of the triangles visited. Triangles beyond `share` of the smallest squared distance so far
  /// are skipped; share 1 is exact.
  [[nodiscard]] Best search(const Vec3& p, std::int32_t guess, double share) const noexcept {
    Best best;
    if (!p.allFinite()) return best;
    if (guess >= 0 && at(guess) < mesh.triangles.size()) consider(guess, p, best);
    discs.each_within(
        p,
        [&](std::int32_t slot) {
          const std::int32_t triangle = discs.triangle_of()[at(slot)];
          if (triangle != guess) consider(triangle, p, best);
        },
        [&best, share] { return share * best.on.distance_squared; });
    return best;
  }

  [[nodiscard]] NearestPoint finish(const Vec3& p, const Best& best) const noexcept;
  [[nodiscard]] Vec3 face_normal(std::int32_t triangle) const noexcept;
  [[nodiscard]] Vec3 pseudonormal(const Best& best) const noexcept;
};

namespace {

Vec3 unit_or_zero(const Vec3& v) {
  const double norm = v.norm();
  return norm > 0.0 ? Vec3(v / norm) : Vec3(Vec3::Zero());
}

/// Unit sums of the face normals around each vertex, weighted by the angles there.
std::vector<Vec3> angle_weighted_normals(const TriangleMesh& mesh, const std::vector<Vec3>& face_normals) {
  std::vector<Vec3> sums(mesh.vertices.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(triangle[k]);
      const Vec3 to_next = unit_or_zero(mesh.vertices[static_cast<std::size_t>(triangle[(k + 1) % 3])] -
                                        mesh.vertices[corner]);
      const Vec3 to_last = unit_or_zero(mesh.vertices[static_cast<std::size_t>(triangle[(k + 2) % 3])] -
                                        mesh.vertices[corner]);
      sums[corner] += portable::acos(to_next.dot(to_last)) * face_normals[t];
    }
  }
  for (Vec3& sum : sums) sum = unit_or_zero(sum);
  return sums;
}

}  // namespace

SignedDistance::SignedDistance(const TriangleMesh& mesh) {
  auto tree = std::make_shared<Tree>(mesh);
  const std::size_t count = mesh.triangles.size();
  std::vector<Vec3> face_normals(count);
  constexpr std::size_t kAtOnce = 8192;
  for_ranges(count, kAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      face_normals[t] = unit_or_zero(area_vector_doubled(mesh, mesh.triangles[t]));
    }
  });
  for (const Vec3& vertex : mesh.vertices) {
    tree->scale = std::max(tree->scale, vertex.cwiseAbs().maxCoeff());
  }
  tree->vertex_normals = angle_weighted_normals(mesh, face_normals);
  tree->plane_normals.resize(count);
  for_ranges(count, kAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      tree->plane_normals[t] = plane_normal(tree->corners(static_cast<std::int32_t>(t)));
    }
  });
  tree_ = std::move(tree);
  ++built;
}

std::uint64_t SignedDistance::builds() noexcept { return built; }

const TriangleMesh& SignedDistance::mesh() const noexcept { return tree_->mesh; }

const std::vector<std::array<std::int32_t, 3>>& SignedDistance::neighbours() const noexcept {
  return tree_->neighbours;
}

bool SignedDistance::is_of(const TriangleMesh& mesh) const {
  return mesh.triangles == tree_->mesh.triangles && mesh.vertices == tree_->mesh.vertices;
}

Vec3 SignedDistance::Tree::face_normal(std::int32_t triangle) const noexcept {
  const Corners corner = corners(triangle);
  return unit_or_zero((corner[1] - corner[0]).cross(corner[2] - corner[0]));
}

Vec3 SignedDistance::Tree::pseudonormal(const Best& best) const noexcept {
  if (best.on.feature < kFirstEdge) {
    return vertex_normals[at(mesh.triangles[at(best.triangle)][at(best.on.feature)])];
  }
  Vec3 own = face_normal(best.triangle);
  if (best.on.feature == kFace) return own;
  return unit_or_zero(own + face_normal(neighbours[at(best.triangle)][at(best.on.feature - kFirstEdge)]));
}

NearestPoint SignedDistance::Tree::finish(const Vec3& p, const Best& best) const noexcept {
  NearestPoint found;
  if (best.triangle < 0) {  // p is not finite
    found.distance = kNaN;
    return found;
  }
  found.point = best.on.point;
  found.normal = pseudonormal(best);
  found.triangle = best.triangle;
  // On a face, the height above its plane gives the sign even when the projection rounds to p.
  const double side = best.on.feature == kFace
                          ? (p - corners(best.triangle)[0]).dot(plane_normals[at(best.triangle)])
                          : (p - found.point).dot(found.normal);
  const double distance = std::sqrt(best.on.distance_squared);
  found.distance = side < 0.0 ? -distance : distance;
  return found;
}

NearestPoint SignedDistance::nearest(const Vec3& p) const noexcept { return nearest(p, -1); }

NearestPoint SignedDistance::nearest(const Vec3& p, std::int32_t guess) const noexcept {
  return tree_->finish(p, tree_->search(p, guess, 1.0));
}

Clearance SignedDistance::clearance(const Vec3& p, std::int32_t guess) const noexcept {
  const Tree::Best best = tree_->search(p, guess, kClearanceShare * kClearanceShare);
  if (best.triangle < 0) return {};
  // Skipped triangles were farther than this fraction of the smallest distance then, which was at least the
  // final one.
  return {kClearanceShare * std::sqrt(best.on.distance_squared), best.triangle};
}

std::optional<Entry> SignedDistance::first_entry(const Vec3& a, const Vec3& b) const noexcept {
  const Tree& tree = *tree_;
  const ShearedSegment segment(a, b);
  const double length = segment.direction.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  // Rounding error [m] of positions along the segment. An end on the surface counts as a crossing.
  const double slack = 32.0 * kEpsilon * (tree.scale + a.cwiseAbs().maxCoeff() + b.cwiseAbs().maxCoeff());
  const double slack_fraction = slack / length;
  double fraction = 1.0 + slack_fraction;
  std::int32_t triangle = -1;
  tree.discs.each_along(a, b, slack, [&](std::int32_t slot) {
    const std::int32_t index = tree.discs.triangle_of()[at(slot)];
    const double where = segment.entry_fraction(tree.corners(index));
    if (where < -slack_fraction) return;
    if (where < fraction || (where == fraction && index < triangle)) {
      fraction = where;
      triangle = index;
    }
  });
  if (triangle < 0) return std::nullopt;
  fraction = std::clamp(fraction, 0.0, 1.0);
  return Entry{fraction, a + fraction * segment.direction, triangle};
}

Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Corners corner{a, b, c};
  return nearest_on(corner, plane_normal(corner), p).point;
}

}  // namespace palpate::geometry
