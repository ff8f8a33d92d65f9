#include "palpate/geometry/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "palpate/base/error.h"
#include "palpate/base/portable_math.h"
#include "palpate/geometry/box_tree.h"

namespace palpate::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// A triangle lower than this share of its longest edge counts as its edges alone: its own normal is noise.
constexpr double kSliver = 1e-7;

// Which part of a triangle is nearest: corner 0..2, edge 3..5 (from corner e - 3 to the next), or the face.
constexpr int kFirstEdge = 3;
constexpr int kFace = 6;

/// A triangle with what the nearest-point query needs.
struct Prepared {
  std::array<Vec3, 3> corner;
  std::array<Vec3, 3> inward;     // of edge e: in the plane, square to it, not unit; zero for a sliver
  Vec3 normal;                    // not unit; zero for a sliver
  double inverse_normal_squared;  // 1 / normal^2, 0 for a sliver
  std::array<double, 3> inverse_length_squared;  // of edge e, 0 for an edge without length
};

struct OnTriangle {
  Vec3 point;
  double distance_squared = kInfinity;
  int feature = 0;
};

Prepared prepare(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  Prepared triangle{{a, b, c}, {}, Vec3::Zero(), 0.0, {0.0, 0.0, 0.0}};
  triangle.inward.fill(Vec3::Zero());
  double longest_squared = 0.0;
  std::size_t longest_edge = 0;
  for (std::size_t e = 0; e < 3; ++e) {
    const double length_squared = (triangle.corner[(e + 1) % 3] - triangle.corner[e]).squaredNorm();
    if (length_squared > 0.0) triangle.inverse_length_squared[e] = 1.0 / length_squared;
    if (length_squared > longest_squared) {
      longest_squared = length_squared;
      longest_edge = e;
    }
  }
  // From the corner across the longest edge, whose two edges are the shorter ones, the product is most exact.
  const Vec3& apex = triangle.corner[(longest_edge + 2) % 3];
  const Vec3 normal =
      (triangle.corner[longest_edge] - apex).cross(triangle.corner[(longest_edge + 1) % 3] - apex);
  const double normal_squared = normal.squaredNorm();
  if (normal_squared > kSliver * kSliver * longest_squared * longest_squared) {
    triangle.normal = normal;
    triangle.inverse_normal_squared = 1.0 / normal_squared;
    for (std::size_t e = 0; e < 3; ++e) {
      triangle.inward[e] = normal.cross(triangle.corner[(e + 1) % 3] - triangle.corner[e]);
    }
  }
  return triangle;
}

/// Nearest point on edge e, kept in `best` if it is nearer.
void try_edge(const Prepared& triangle, std::size_t e, const Vec3& p, OnTriangle& best) noexcept {
  constexpr std::array<std::size_t, 3> kNext{1, 2, 0};
  const Vec3& a = triangle.corner[e];
  const Vec3& b = triangle.corner[kNext[e]];
  const Vec3 ab = b - a;
  const double u = (p - a).dot(ab) * triangle.inverse_length_squared[e];
  int feature = kFirstEdge + static_cast<int>(e);
  // From the nearer end, so that the two triangles of an edge agree closely.
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

/// The foot of p on the plane if it lies inside, otherwise on the edges that p lies outside of (all of a
/// sliver's): with one such edge the nearest point is on it, with two on one of them.
OnTriangle nearest_on(const Prepared& triangle, const Vec3& p) noexcept {
  OnTriangle best;
  const bool is_sliver = triangle.inverse_normal_squared == 0.0;
  const std::array<double, 3> side{triangle.inward[0].dot(p - triangle.corner[0]),
                                   triangle.inward[1].dot(p - triangle.corner[1]),
                                   triangle.inward[2].dot(p - triangle.corner[2])};
  if (!is_sliver && side[0] >= 0.0 && side[1] >= 0.0 && side[2] >= 0.0) {
    const double height = (p - triangle.corner[0]).dot(triangle.normal);
    best.point = p - (height * triangle.inverse_normal_squared) * triangle.normal;
    best.distance_squared = height * height * triangle.inverse_normal_squared;
    best.feature = kFace;
    return best;
  }
  for (std::size_t e = 0; e < 3; ++e) {
    if (is_sliver || side[e] < 0.0) try_edge(triangle, e, p, best);
  }
  return best;
}

/// By value, so that it is one instruction and no branch.
double larger(double a, double b) noexcept { return a > b ? a : b; }

double squared_distance_to_box(const Vec3& low, const Vec3& high, const Vec3& p) noexcept {
  const double x = larger(0.0, larger(low.x() - p.x(), p.x() - high.x()));
  const double y = larger(0.0, larger(low.y() - p.y(), p.y() - high.y()));
  const double z = larger(0.0, larger(low.z() - p.z(), p.z() - high.z()));
  return x * x + y * y + z * z;
}

/// A segment in the coordinates in which it is the z axis from 0 to 1: a shear, so that a shared edge looks
/// the same to both of its triangles and none slips between them [Woop, Benthin and Wald 2013].
struct ShearedSegment {
  Vec3 start;
  Vec3 direction;
  int kx = 0, ky = 1, kz = 2;
  double shear_x = 0.0, shear_y = 0.0, scale_z = 0.0;

  ShearedSegment(const Vec3& a, const Vec3& b) noexcept : start(a), direction(b - a) {
    direction.cwiseAbs().maxCoeff(&kz);
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    if (direction[kz] < 0.0) std::swap(kx, ky);  // keeps the turning sense of triangles
    scale_z = 1.0 / direction[kz];
    shear_x = direction[kx] * scale_z;
    shear_y = direction[ky] * scale_z;
  }

  [[nodiscard]] Vec3 sheared(const Vec3& p) const noexcept {
    const Vec3 q = p - start;
    return {q[kx] - shear_x * q[kz], q[ky] - shear_y * q[kz], q[kz] * scale_z};
  }

  /// Fraction at which the segment's line goes in through the triangle, or infinity. Rounding is monotonic,
  /// so an edge function is never of the wrong sign, only zero; zero counts as inside.
  [[nodiscard]] double entry_fraction(const Prepared& triangle) const noexcept {
    const Vec3 a = sheared(triangle.corner[0]);
    const Vec3 b = sheared(triangle.corner[1]);
    const Vec3 c = sheared(triangle.corner[2]);
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
    // Seen so nearly from its side that its area rounds to nothing.
    const double approach = triangle.normal.dot(direction);
    if (!(approach < 0.0)) return kInfinity;
    return std::clamp(triangle.normal.dot(triangle.corner[0] - start) / approach, low, high);
  }
};

}  // namespace

struct SurfaceDistance::Tree {
  struct Normals {
    Vec3 face;
    std::array<Vec3, 3> edge;
    std::array<std::int32_t, 3> vertex;
  };
  struct Best {
    OnTriangle on;
    std::int32_t slot = -1;
    std::int32_t triangle = -1;
  };

  std::vector<BoxNode> nodes;
  std::vector<Prepared> prepared;         // by slot, in the order of the leaves
  std::vector<Normals> normals;           // by slot
  std::vector<std::int32_t> triangle_of;  // by slot
  std::vector<std::int32_t> slot_of;      // by triangle
  std::vector<Vec3> vertex_normals;
  double scale = 0.0;  // largest coordinate [m], for rounding bounds

  void consider(std::int32_t slot, const Vec3& p, Best& best) const noexcept {
    const OnTriangle on = nearest_on(prepared[static_cast<std::size_t>(slot)], p);
    const std::int32_t triangle = triangle_of[static_cast<std::size_t>(slot)];
    const bool is_nearer = on.distance_squared < best.on.distance_squared ||
                           (on.distance_squared == best.on.distance_squared && triangle < best.triangle);
    if (is_nearer) best = {on, slot, triangle};
  }

  void search(const Vec3& p, Best& best) const noexcept;
  [[nodiscard]] NearestPoint finish(const Vec3& p, const Best& best) const noexcept;
  [[nodiscard]] Vec3 pseudonormal(const Best& best) const noexcept;
};

namespace {

Vec3 unit_or_zero(const Vec3& v) {
  const double norm = v.norm();
  return norm > 0.0 ? Vec3(v / norm) : Vec3(Vec3::Zero());
}

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

/// Sum of the face normals around each vertex, each weighted by its angle there, to unit length.
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

SurfaceDistance::SurfaceDistance(const TriangleMesh& mesh) {
  const auto neighbours = neighbours_of_closed(mesh);
  auto tree = std::make_unique<Tree>();
  const std::size_t count = mesh.triangles.size();
  std::vector<Box> boxes(count);
  std::vector<Vec3> face_normals(count);
  for (std::size_t t = 0; t < count; ++t) {
    for (const std::int32_t corner : mesh.triangles[t]) {
      const Vec3& vertex = mesh.vertices[static_cast<std::size_t>(corner)];
      boxes[t].add({vertex, vertex});
      tree->scale = std::max(tree->scale, vertex.cwiseAbs().maxCoeff());
    }
    face_normals[t] = unit_or_zero(area_vector_doubled(mesh, mesh.triangles[t]));
  }
  // Wider than the rounding of a distance, so that no order of visits can change the answer.
  const double padding = 64.0 * kEpsilon * tree->scale;
  tree->triangle_of = BoxTreeBuilder(boxes, padding, tree->nodes).build();
  tree->vertex_normals = angle_weighted_normals(mesh, face_normals);
  tree->slot_of.resize(count);
  tree->prepared.reserve(count);
  tree->normals.reserve(count);
  for (std::size_t slot = 0; slot < count; ++slot) {
    const auto t = static_cast<std::size_t>(tree->triangle_of[slot]);
    tree->slot_of[t] = static_cast<std::int32_t>(slot);
    const Triangle& triangle = mesh.triangles[t];
    tree->prepared.push_back(prepare(mesh.vertices[static_cast<std::size_t>(triangle[0])],
                                     mesh.vertices[static_cast<std::size_t>(triangle[1])],
                                     mesh.vertices[static_cast<std::size_t>(triangle[2])]));
    Tree::Normals normals{face_normals[t], {}, triangle};
    for (std::size_t e = 0; e < 3; ++e) {
      normals.edge[e] =
          unit_or_zero(face_normals[t] + face_normals[static_cast<std::size_t>(neighbours[t][e])]);
    }
    tree->normals.push_back(normals);
  }
  tree_ = std::move(tree);
}

SurfaceDistance::~SurfaceDistance() = default;
SurfaceDistance::SurfaceDistance(SurfaceDistance&&) noexcept = default;
SurfaceDistance& SurfaceDistance::operator=(SurfaceDistance&&) noexcept = default;

void SurfaceDistance::Tree::search(const Vec3& p, Best& best) const noexcept {
  struct Visit {
    std::int32_t node;
    double distance_squared;
  };
  // A box's distance carries a relative rounding of its own, besides the padding.
  constexpr double kBelow = 1.0 - 32.0 * kEpsilon;
  std::array<Visit, kBoxTreeStack> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, 0.0};
  while (depth > 0) {
    const Visit visit = stack[--depth];
    if (visit.distance_squared > best.on.distance_squared) continue;
    const BoxNode& node = nodes[static_cast<std::size_t>(visit.node)];
    std::array<double, 2> to_child{};
    for (std::size_t side = 0; side < 2; ++side) {
      to_child[side] = kBelow * squared_distance_to_box(node.low[side], node.high[side], p);
    }
    const std::size_t near = to_child[1] < to_child[0] ? 1 : 0;
    std::array<Visit, 2> inner{};
    std::size_t inner_count = 0;
    for (const std::size_t side : {near, 1 - near}) {
      if (to_child[side] > best.on.distance_squared) continue;
      if (node.child[side] >= 0) {
        inner[inner_count++] = {node.child[side], to_child[side]};
        continue;
      }
      const std::int32_t first = -1 - node.child[side];
      for (std::int32_t slot = first; slot < first + node.count[side]; ++slot) consider(slot, p, best);
    }
    while (inner_count > 0) stack[depth++] = inner[--inner_count];  // the nearer one on top
  }
}

Vec3 SurfaceDistance::Tree::pseudonormal(const Best& best) const noexcept {
  const Normals& around = normals[static_cast<std::size_t>(best.slot)];
  if (best.on.feature == kFace) return around.face;
  if (best.on.feature < kFirstEdge) {
    const auto corner = static_cast<std::size_t>(best.on.feature);
    return vertex_normals[static_cast<std::size_t>(around.vertex[corner])];
  }
  return around.edge[static_cast<std::size_t>(best.on.feature - kFirstEdge)];
}

NearestPoint SurfaceDistance::Tree::finish(const Vec3& p, const Best& best) const noexcept {
  NearestPoint found;
  if (best.slot < 0) {  // p is not finite
    found.distance = std::numeric_limits<double>::quiet_NaN();
    return found;
  }
  found.point = best.on.point;
  found.normal = pseudonormal(best);
  found.triangle = best.triangle;
  const Prepared& triangle = prepared[static_cast<std::size_t>(best.slot)];
  // On a face the height over its plane has the sign even where the foot rounds onto p.
  const double side = best.on.feature == kFace ? (p - triangle.corner[0]).dot(triangle.normal)
                                               : (p - found.point).dot(found.normal);
  const double distance = std::sqrt(best.on.distance_squared);
  found.distance = side < 0.0 ? -distance : distance;
  return found;
}

NearestPoint SurfaceDistance::nearest(const Vec3& p) const noexcept { return nearest(p, -1); }

NearestPoint SurfaceDistance::nearest(const Vec3& p, std::int32_t guess) const noexcept {
  Tree::Best best;
  if (guess >= 0 && static_cast<std::size_t>(guess) < tree_->slot_of.size()) {
    tree_->consider(tree_->slot_of[static_cast<std::size_t>(guess)], p, best);
  }
  tree_->search(p, best);
  return tree_->finish(p, best);
}

std::optional<Entry> SurfaceDistance::first_entry(const Vec3& a, const Vec3& b) const noexcept {
  const Tree& tree = *tree_;
  const ShearedSegment segment(a, b);
  const double length = segment.direction.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  // Rounding [m] of positions along the segment; an end that lies on the surface counts as having crossed it.
  const double slack = 32.0 * kEpsilon * (tree.scale + a.cwiseAbs().maxCoeff() + b.cwiseAbs().maxCoeff());
  const double slack_fraction = slack / length;
  const Vec3 half = 0.5 * segment.direction;
  const Vec3 reach = half.cwiseAbs();
  const Vec3 middle = a + half;
  double fraction = 1.0 + slack_fraction;
  std::int32_t triangle = -1;
  const auto is_apart = [&](const Vec3& low, const Vec3& high) {
    const Vec3 extent = (0.5 * (high - low)).array() + slack;
    const Vec3 offset = middle - 0.5 * (low + high);
    for (int k = 0; k < 3; ++k) {
      if (std::abs(offset[k]) > extent[k] + reach[k]) return true;
    }
    for (int k = 0; k < 3; ++k) {  // the axes across the segment and each edge of the box
      const int u = (k + 1) % 3;
      const int v = (k + 2) % 3;
      if (std::abs(offset[u] * half[v] - offset[v] * half[u]) > extent[u] * reach[v] + extent[v] * reach[u])
        return true;
    }
    return false;
  };
  std::array<std::int32_t, kBoxTreeStack> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const BoxNode& node = tree.nodes[static_cast<std::size_t>(stack[--depth])];
    for (std::size_t side = 0; side < 2; ++side) {
      if (is_apart(node.low[side], node.high[side])) continue;
      if (node.child[side] >= 0) {
        stack[depth++] = node.child[side];
        continue;
      }
      const std::int32_t first = -1 - node.child[side];
      for (std::int32_t slot = first; slot < first + node.count[side]; ++slot) {
        const double at = segment.entry_fraction(tree.prepared[static_cast<std::size_t>(slot)]);
        const std::int32_t index = tree.triangle_of[static_cast<std::size_t>(slot)];
        if (at < -slack_fraction) continue;
        if (at < fraction || (at == fraction && index < triangle)) {
          fraction = at;
          triangle = index;
        }
      }
    }
  }
  if (triangle < 0) return std::nullopt;
  fraction = std::clamp(fraction, 0.0, 1.0);
  return Entry{fraction, a + fraction * segment.direction, triangle};
}

Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  return nearest_on(prepare(a, b, c), p).point;
}

}  // namespace palpate::geometry
