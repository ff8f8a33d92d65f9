#include "view/render/display_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "core/base/index.h"
#include "core/deform/surface_parts.h"
#include "core/geometry/half_edges.h"

namespace palpate::render {
namespace {

using geometry::edge_key;
using geometry::Triangle;
using geometry::TriangleMesh;

constexpr int kMaxRounds = 12;
constexpr int kEvenRounds = 12;

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

// Numbered edges of a mesh, with marks for creases and boundaries.
struct Edges {
  std::vector<std::array<std::int32_t, 2>> ends;
  std::vector<std::array<std::int32_t, 3>> of_triangle;  // edge e runs from corner e to corner (e+1)%3
  std::vector<char> sharp;                               // per edge
  std::vector<char> sharp_vertex;                        // per vertex: whether it is on a sharp edge
};

Edges find_edges(const TriangleMesh& mesh, double crease_deg) {
  Edges edges;
  geometry::EdgeNumbers numbers;
  std::vector<Vec3> first_normal;
  std::vector<int> uses;
  const double crease = std::cos(radians(crease_deg));
  for (const Triangle& t : mesh.triangles) {
    const Vec3 normal = geometry::area_vector_doubled(mesh, t).normalized();
    std::array<std::int32_t, 3> own{};
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t a = t[e];
      const std::int32_t b = t[(e + 1) % 3];
      own[e] = numbers[edge_key(a, b)];
      const std::size_t i = at(own[e]);
      if (i == edges.ends.size()) {
        edges.ends.push_back({a, b});
        edges.sharp.push_back(0);
        first_normal.push_back(normal);
        uses.push_back(1);
      } else {
        ++uses[i];
        if (normal.dot(first_normal[i]) < crease) edges.sharp[i] = 1;
      }
    }
    edges.of_triangle.push_back(own);
  }
  edges.sharp_vertex.assign(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < edges.ends.size(); ++i) {
    if (uses[i] != 2) edges.sharp[i] = 1;
    if (edges.sharp[i] == 0) continue;
    for (const std::int32_t v : edges.ends[i]) edges.sharp_vertex[at(v)] = 1;
  }
  return edges;
}

// Subdivides a triangle at the midpoints of its marked edges (index -1: not marked).
void cut(const Triangle& t, const std::array<std::int32_t, 3>& middle, const std::vector<Vec3>& vertices,
         std::vector<Triangle>& out) {
  const int marked =
      static_cast<int>(std::count_if(middle.begin(), middle.end(), [](int m) { return m >= 0; }));
  if (marked == 0) {
    out.push_back(t);
    return;
  }
  if (marked == 3) {
    out.push_back({t[0], middle[0], middle[2]});
    out.push_back({middle[0], t[1], middle[1]});
    out.push_back({middle[2], middle[1], t[2]});
    out.push_back({middle[0], middle[1], middle[2]});
    return;
  }
  // Rotate so that edge 0 is the only marked one, or edge 2 the only unmarked one.
  std::size_t first = 0;
  while (marked == 1 ? middle[first] < 0 : middle[(first + 2) % 3] >= 0) ++first;
  const std::int32_t a = t[first];
  const std::int32_t b = t[(first + 1) % 3];
  const std::int32_t c = t[(first + 2) % 3];
  const std::int32_t ab = middle[first];
  if (marked == 1) {
    out.push_back({a, ab, c});
    out.push_back({ab, b, c});
    return;
  }
  const std::int32_t bc = middle[(first + 1) % 3];
  out.push_back({ab, b, bc});
  const Vec3 across_a = vertices[at(a)] - vertices[at(bc)];
  const Vec3 across_c = vertices[at(c)] - vertices[at(ab)];
  if (across_a.squaredNorm() < across_c.squaredNorm()) {
    out.push_back({a, ab, bc});
    out.push_back({a, bc, c});
  } else {
    out.push_back({a, ab, c});
    out.push_back({ab, bc, c});
  }
}

// Midpoint of the cubic curve over an edge, perpendicular to the normals at its ends; straight for a sharp
// edge.
Vec3 curved_middle(const Vec3& a, const Vec3& b, const Vec3& normal_a, const Vec3& normal_b, bool straight_a,
                   bool straight_b) {
  const Vec3 along = b - a;
  const double lift_a = straight_a ? 0.0 : along.dot(normal_a);
  const double lift_b = straight_b ? 0.0 : -along.dot(normal_b);
  return 0.5 * (a + b) - 0.125 * (lift_a * normal_a + lift_b * normal_b);
}

// Splits each edge for which `point_on(its number)` gives a point; false: there is none.
template <typename PointOn>
bool split(TriangleMesh& mesh, const Edges& edges, const PointOn& point_on) {
  std::vector<std::int32_t> middle(edges.ends.size(), -1);
  bool any = false;
  for (std::size_t i = 0; i < edges.ends.size(); ++i) {
    const std::optional<Vec3> point = point_on(i);
    if (!point) continue;
    middle[i] = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.push_back(*point);
    any = true;
  }
  if (!any) return false;
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size() * 2);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& own = edges.of_triangle[t];
    cut(mesh.triangles[t], {middle[at(own[0])], middle[at(own[1])], middle[at(own[2])]}, mesh.vertices,
        triangles);
  }
  mesh.triangles = std::move(triangles);
  return true;
}

bool refine_once(TriangleMesh& mesh, const RefineRule& rule) {
  const Edges edges = find_edges(mesh, rule.crease_deg);
  const std::vector<Vec3> normals = deform::vertex_normals(mesh);
  return split(mesh, edges, [&](std::size_t i) -> std::optional<Vec3> {
    const auto [ia, ib] = edges.ends[i];
    const Vec3& a = mesh.vertices[at(ia)];
    const Vec3& b = mesh.vertices[at(ib)];
    const bool straight_a = edges.sharp_vertex[at(ia)] != 0;
    const bool straight_b = edges.sharp_vertex[at(ib)] != 0;
    const Vec3& normal_a = normals[at(ia)];
    const Vec3& normal_b = normals[at(ib)];
    const double bend =
        straight_a || straight_b ? 0.0 : std::acos(std::clamp(normal_a.dot(normal_b), -1.0, 1.0));
    if (!rule.split(0.5 * (a + b), (b - a).norm(), bend)) return std::nullopt;
    return curved_middle(a, b, normal_a, normal_b, straight_a, straight_b);
  });
}

}  // namespace

TriangleMesh refine_smoothly(const TriangleMesh& mesh, const RefineRule& rule) {
  TriangleMesh fine = mesh;
  for (int round = 0; round < kMaxRounds && refine_once(fine, rule); ++round) {
  }
  return fine;
}

bool has_clean_creases(const TriangleMesh& mesh, double crease_deg) {
  constexpr double kLeastShare = 0.9;  // of the ends of sharp edges
  const double straight = std::cos(radians(40.0));
  const Edges edges = find_edges(mesh, crease_deg);
  std::vector<std::vector<Vec3>> leaving(mesh.vertices.size());  // directions of the sharp edges at a vertex
  for (std::size_t i = 0; i < edges.ends.size(); ++i) {
    if (edges.sharp[i] == 0) continue;
    const auto [a, b] = edges.ends[i];
    const Vec3 way = (mesh.vertices[at(b)] - mesh.vertices[at(a)]).normalized();
    leaving[at(a)].push_back(way);
    leaving[at(b)].emplace_back(-way);
  }
  double ends = 0.0;
  double clean = 0.0;  // at a corner, or followed by an edge in about the same direction
  for (const std::vector<Vec3>& ways : leaving) {
    ends += static_cast<double>(ways.size());
    if (ways.size() > 2 || (ways.size() == 2 && -ways[0].dot(ways[1]) > straight))
      clean += static_cast<double>(ways.size());
  }
  return clean > kLeastShare * ends;
}

void narrow_creases(TriangleMesh& mesh, double crease_deg, double band) {
  // Where sharp edges meet, an edge may lead from one to another.
  const Edges before = find_edges(mesh, crease_deg);
  split(mesh, before, [&](std::size_t i) -> std::optional<Vec3> {
    const auto [a, b] = before.ends[i];
    if (before.sharp[i] != 0 || before.sharp_vertex[at(a)] == 0 || before.sharp_vertex[at(b)] == 0)
      return std::nullopt;
    return Vec3(0.5 * (mesh.vertices[at(a)] + mesh.vertices[at(b)]));
  });
  const Edges edges = find_edges(mesh, crease_deg);
  split(mesh, edges, [&](std::size_t i) -> std::optional<Vec3> {
    const auto [a, b] = edges.ends[i];
    const bool from_a = edges.sharp_vertex[at(a)] != 0;
    if (from_a == (edges.sharp_vertex[at(b)] != 0)) return std::nullopt;
    const Vec3& sharp = mesh.vertices[at(from_a ? a : b)];
    const Vec3 way = mesh.vertices[at(from_a ? b : a)] - sharp;
    const double length = way.norm();
    if (length < 2.0 * band) return std::nullopt;
    return Vec3(sharp + band / length * way);
  });
}

void smooth_bumps(TriangleMesh& mesh, double limit, double crease_deg) {
  const Edges edges = find_edges(mesh, crease_deg);
  const std::vector<Vec3> original = mesh.vertices;
  std::vector<Vec3> sum(original.size());
  std::vector<double> count(original.size());
  for (int round = 0; round < kEvenRounds; ++round) {
    std::fill(sum.begin(), sum.end(), Vec3::Zero());
    std::fill(count.begin(), count.end(), 0.0);
    for (const auto& [a, b] : edges.ends) {
      sum[at(a)] += mesh.vertices[at(b)];
      sum[at(b)] += mesh.vertices[at(a)];
      count[at(a)] += 1.0;
      count[at(b)] += 1.0;
    }
    for (std::size_t v = 0; v < original.size(); ++v) {
      if (edges.sharp_vertex[v] != 0 || count[v] == 0.0) continue;
      Vec3 offset = 0.5 * (mesh.vertices[v] + sum[v] / count[v]) - original[v];
      const double length = offset.norm();
      if (length > limit) offset *= limit / length;
      mesh.vertices[v] = original[v] + offset;
    }
  }
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t e = 0; e < 3; ++e)
      sum += (mesh.vertices[at(t[e])] - mesh.vertices[at(t[(e + 1) % 3])]).norm();
  return mesh.triangles.empty() ? 0.0 : sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

std::vector<Vec3> corner_normals(const TriangleMesh& mesh, double crease_deg) {
  std::vector<Vec3> area(mesh.triangles.size());
  std::vector<std::vector<std::int32_t>> around(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    area[t] = geometry::area_vector_doubled(mesh, mesh.triangles[t]);
    for (const std::int32_t v : mesh.triangles[t]) around[at(v)].push_back(static_cast<std::int32_t>(t));
  }
  const double crease = std::cos(radians(crease_deg));
  std::vector<Vec3> normals;
  normals.reserve(mesh.triangles.size() * 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 own = area[t].normalized();
    for (const std::int32_t v : mesh.triangles[t]) {
      Vec3 sum = area[t];
      for (const std::int32_t other : around[at(v)]) {
        if (at(other) != t && area[at(other)].normalized().dot(own) >= crease) sum += area[at(other)];
      }
      normals.push_back(sum.normalized());
    }
  }
  return normals;
}

}  // namespace palpate::render
