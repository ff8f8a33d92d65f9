#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "palpate/mesh.h"

/// Brute-force checks of generated meshes.
namespace palpate::geometry::test {

inline const Vec3& corner(const TriangleMesh& mesh, std::size_t t, std::size_t k) {
  return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])];
}

/// Closed and manifold; edge_neighbours() throws when it is not manifold.
inline bool is_closed(const TriangleMesh& mesh) {
  for (const auto& sides : edge_neighbours(mesh)) {
    if (std::any_of(sides.begin(), sides.end(), [](std::int32_t s) { return s < 0; })) return false;
  }
  return true;
}

/// Number of components that are connected by edges.
inline int shells(const TriangleMesh& mesh) {
  const auto neighbours = edge_neighbours(mesh);
  std::vector<bool> seen(mesh.triangles.size(), false);
  int count = 0;
  for (std::size_t t = 0; t < seen.size(); ++t) {
    if (seen[t]) continue;
    ++count;
    std::vector<std::size_t> open{t};
    seen[t] = true;
    while (!open.empty()) {
      const std::size_t now = open.back();
      open.pop_back();
      for (const std::int32_t next : neighbours[now]) {
        if (next < 0 || seen[static_cast<std::size_t>(next)]) continue;
        seen[static_cast<std::size_t>(next)] = true;
        open.push_back(static_cast<std::size_t>(next));
      }
    }
  }
  return count;
}

/// Euler characteristic V - E + F of a closed mesh: 2 for each component without handles.
inline int euler(const TriangleMesh& mesh) {
  return static_cast<int>(mesh.vertices.size()) - static_cast<int>(mesh.triangles.size()) / 2;
}

/// The smallest angle of all triangles [deg].
inline double smallest_angle(const TriangleMesh& mesh) {
  double least = 180.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 u = (corner(mesh, t, (k + 1) % 3) - corner(mesh, t, k)).normalized();
      const Vec3 v = (corner(mesh, t, (k + 2) % 3) - corner(mesh, t, k)).normalized();
      least = std::min(least, std::acos(std::clamp(u.dot(v), -1.0, 1.0)) * 180.0 / 3.14159265358979);
    }
  }
  return least;
}

struct EdgeLengths {
  double shortest = 1e9;
  double longest = 0.0;
};
inline EdgeLengths edge_lengths(const TriangleMesh& mesh) {
  EdgeLengths lengths;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = (corner(mesh, t, (k + 1) % 3) - corner(mesh, t, k)).norm();
      lengths.shortest = std::min(lengths.shortest, length);
      lengths.longest = std::max(lengths.longest, length);
    }
  }
  return lengths;
}

inline double volume_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Whether the segment p q passes through the interior of triangle a b c, by more than rounding.
inline bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double scale = (q - p).norm() + (b - a).norm() + (c - a).norm();
  const double rounding = 1e-12 * scale * scale * scale;
  const double before = volume_of(a, b, c, p);
  const double behind = volume_of(a, b, c, q);
  if (std::min(std::abs(before), std::abs(behind)) < rounding || (before > 0.0) == (behind > 0.0))
    return false;
  const double u = volume_of(p, q, a, b);
  const double v = volume_of(p, q, b, c);
  const double w = volume_of(p, q, c, a);
  return (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
}

inline bool cross(const TriangleMesh& m, std::size_t s, const TriangleMesh& n, std::size_t t) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (pierces(corner(m, s, k), corner(m, s, (k + 1) % 3), corner(n, t, 0), corner(n, t, 1),
                corner(n, t, 2)) ||
        pierces(corner(n, t, k), corner(n, t, (k + 1) % 3), corner(m, s, 0), corner(m, s, 1),
                corner(m, s, 2))) {
      return true;
    }
  }
  return false;
}

inline Bounds box_of(const TriangleMesh& mesh, std::size_t t) {
  return {corner(mesh, t, 0).cwiseMin(corner(mesh, t, 1)).cwiseMin(corner(mesh, t, 2)),
          corner(mesh, t, 0).cwiseMax(corner(mesh, t, 1)).cwiseMax(corner(mesh, t, 2))};
}

inline bool apart(const Bounds& a, const Bounds& b) {
  return (a.low.array() > b.high.array()).any() || (b.low.array() > a.high.array()).any();
}

inline bool share_vertex(const Triangle& a, const Triangle& b) {
  return std::any_of(a.begin(), a.end(),
                     [&b](std::int32_t v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

/// Number of intersecting pairs of triangles of two meshes, or of one mesh with itself. The second mesh's
/// triangles are sorted by their smallest x, so that only those with overlapping x ranges are tested.
inline int crossings(const TriangleMesh& m, const TriangleMesh& n) {
  const bool same = &m == &n;
  struct Boxed {
    Bounds box;
    std::size_t t;
  };
  std::vector<Boxed> sorted;
  double widest = 0.0;
  for (std::size_t t = 0; t < n.triangles.size(); ++t) {
    sorted.push_back({box_of(n, t), t});
    widest = std::max(widest, sorted.back().box.size().x());
  }
  const auto begins = [](const Boxed& one) { return one.box.low.x(); };
  std::sort(sorted.begin(), sorted.end(),
            [&](const Boxed& a, const Boxed& b) { return begins(a) < begins(b); });
  int count = 0;
  for (std::size_t s = 0; s < m.triangles.size(); ++s) {
    const Bounds box = box_of(m, s);
    auto other = std::lower_bound(sorted.begin(), sorted.end(), box.low.x() - widest,
                                  [&](const Boxed& one, double x) { return begins(one) < x; });
    for (; other != sorted.end() && begins(*other) <= box.high.x(); ++other) {
      if (apart(box, other->box)) continue;
      if (same && (other->t <= s || share_vertex(m.triangles[s], n.triangles[other->t]))) continue;
      count += cross(m, s, n, other->t) ? 1 : 0;
    }
  }
  return count;
}

/// An intersection of a line along z with a surface, with the unit normal there.
struct Hit {
  double z = 0.0;
  Vec3 normal = Vec3::Zero();
};
inline std::vector<Hit> hits_from_above(const TriangleMesh& mesh, double x, double y) {
  std::vector<Hit> hits;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 from(x, y, 1.0);
    const Vec3 to(x, y, -1.0);
    if (!pierces(from, to, corner(mesh, t, 0), corner(mesh, t, 1), corner(mesh, t, 2))) continue;
    const Vec3 normal = area_vector_doubled(mesh, mesh.triangles[t]).normalized();
    const double z = (normal.dot(corner(mesh, t, 0)) - normal.x() * x - normal.y() * y) / normal.z();
    hits.push_back({z, normal});
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.z > b.z; });
  return hits;
}

}  // namespace palpate::geometry::test
