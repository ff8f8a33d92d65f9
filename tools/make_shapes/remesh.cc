#include "tools/make_shapes/remesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <fmt/core.h>

#include "core/base/index.h"
#include "palpate/error.h"

#include "tools/make_shapes/editable_surface.h"

namespace palpate::geometry {

namespace {

using Edge = EditableSurface::Edge;

// Edges outside these fractions of the target length are split or collapsed (Botsch and Kobbelt 2004).
constexpr double kSplitAbove = 4.0 / 3.0;
constexpr double kCollapseBelow = 4.0 / 5.0;

class Remesher final {
 public:
  Remesher(const ImplicitSolid& solid, const TriangleMesh& start, const RemeshParameters& goal)
      : solid_(solid), goal_(goal), surface_(start) {
    for (int step = 0; step < 3; ++step) project();
    measure_sizes();
  }

  [[nodiscard]] TriangleMesh run() {
    for (int round = 0; round < goal_.rounds; ++round) {
      const double length = wanted_length();
      split_long(kSplitAbove * length);
      collapse_short(kCollapseBelow * length, kSplitAbove * length);
      relax();
      measure_sizes();
    }
    reach_count();
    for (int round = 0; round < goal_.polish; ++round) relax();
    for (int level = 0; level < goal_.subdivisions; ++level) divide();
    for (int step = 0; step < 3; ++step) project();
    return surface_.mesh();
  }

 private:
  /// One Newton step of all vertices to the surface, and the normals there.
  void project() {
    for (std::size_t v = 0; v < surface_.points.size(); ++v) {
      const FieldValue field = solid_.at(surface_.points[v]);
      const double slope2 = field.gradient.squaredNorm();
      if (slope2 <= 0.0) continue;
      surface_.normals[v] = field.gradient / std::sqrt(slope2);
      surface_.points[v] -= field.value / slope2 * field.gradient;
    }
  }

  /// Target relative edge length at each vertex: 1 on a plane, less where the normals change fast; smoothed
  /// over the neighbours.
  void measure_sizes() {
    std::vector<double> bend(surface_.points.size(), 0.0);
    const std::vector<Edge> edges = surface_.edges();
    for (const Edge& e : edges) {
      const double turn = (surface_.normals[at(e.a)] - surface_.normals[at(e.b)]).norm();
      const double here = turn / std::max(surface_.length(e), 1e-9);
      bend[at(e.a)] = std::max(bend[at(e.a)], here);
      bend[at(e.b)] = std::max(bend[at(e.b)], here);
    }
    for (std::size_t v = 0; v < bend.size(); ++v) {
      surface_.sizes[v] = std::max(goal_.finest, 1.0 / (1.0 + goal_.bend_radius * bend[v]));
    }
    for (int round = 0; round < 4; ++round) {
      std::vector<double> sum = surface_.sizes;
      std::vector<double> weight(sum.size(), 1.0);
      for (const Edge& e : edges) {
        sum[at(e.a)] += surface_.sizes[at(e.b)];
        sum[at(e.b)] += surface_.sizes[at(e.a)];
        weight[at(e.a)] += 1.0;
        weight[at(e.b)] += 1.0;
      }
      for (std::size_t v = 0; v < sum.size(); ++v) surface_.sizes[v] = sum[v] / weight[v];
    }
  }

  /// The edge length [m] at relative size 1 for which about equilateral triangles give the target count.
  [[nodiscard]] double wanted_length() const {
    double area = 0.0;
    for (const Triangle& t : surface_.triangles()) {
      const double size =
          (surface_.sizes[at(t[0])] + surface_.sizes[at(t[1])] + surface_.sizes[at(t[2])]) / 3.0;
      const Vec3& a = surface_.points[at(t[0])];
      area +=
          0.5 * (surface_.points[at(t[1])] - a).cross(surface_.points[at(t[2])] - a).norm() / (size * size);
    }
    const double triangles = 2.0 * (goal_.vertices - 2);
    return std::sqrt(4.0 / std::sqrt(3.0) * area / triangles);
  }

  /// Divides every triangle into four, interpolates the target sizes, and relaxes `touch` times.
  void divide() {
    surface_ = EditableSurface(subdivide(surface_.mesh()));
    for (int step = 0; step < 3; ++step) project();
    measure_sizes();
    for (int round = 0; round < goal_.touch; ++round) relax();
  }

  void split_long(double longest) {
    for (const Edge& e : surface_.edges()) {
      if (surface_.relative_length(e) > longest) surface_.split(e);
    }
  }

  void collapse_short(double shortest, double longest) {
    for (const Edge& e : surface_.edges()) {
      if (surface_.has_edge(e) && surface_.relative_length(e) < shortest) surface_.collapse(e, longest);
    }
    surface_.compact();
  }

  /// Flips edges, moves each vertex along the surface to the weighted centroid of its triangles, and projects
  /// it.
  void relax() {
    flip();
    std::vector<Vec3> moved(surface_.points.size());
    for (std::size_t v = 0; v < moved.size(); ++v) {
      Vec3 sum = Vec3::Zero();
      double total = 0.0;
      for (const std::int32_t t : surface_.around(static_cast<std::int32_t>(v))) {
        const Triangle& corners = surface_.triangles()[at(t)];
        const Vec3& a = surface_.points[at(corners[0])];
        const Vec3& b = surface_.points[at(corners[1])];
        const Vec3& c = surface_.points[at(corners[2])];
        const double size = (surface_.sizes[at(corners[0])] + surface_.sizes[at(corners[1])] +
                             surface_.sizes[at(corners[2])]) /
                            3.0;
        const double weight = (b - a).cross(c - a).norm() / (size * size);
        sum += weight / 3.0 * (a + b + c);
        total += weight;
      }
      const Vec3 step = total > 0.0 ? Vec3(sum / total - surface_.points[v]) : Vec3::Zero();
      const Vec3& normal = surface_.normals[v];
      moved[v] = surface_.points[v] + step - step.dot(normal) * normal;
    }
    surface_.points = std::move(moved);
    project();
    flip();
  }

  void flip() {
    for (const Edge& e : surface_.edges()) {
      if (surface_.has_edge(e)) surface_.flip_if_better(e);
    }
  }

  struct Ranked {
    double length;
    Edge edge;
  };
  [[nodiscard]] std::vector<Ranked> ranked(bool shortest_first) const {
    std::vector<Ranked> list;
    for (const Edge& e : surface_.edges()) list.push_back({surface_.relative_length(e), e});
    std::sort(list.begin(), list.end(), [shortest_first](const Ranked& x, const Ranked& y) {
      if (x.length != y.length) return (x.length < y.length) == shortest_first;
      return x.edge.a != y.edge.a ? x.edge.a < y.edge.a : x.edge.b < y.edge.b;
    });
    return list;
  }

  /// Collapses the shortest or splits the longest edges, a few between two relaxations, until the count is
  /// reached.
  void reach_count() {
    constexpr int kMostRounds = 60;
    for (int round = 0; round < kMostRounds && surface_.living_vertices() != goal_.vertices; ++round) {
      const int excess = surface_.living_vertices() - goal_.vertices;
      int left = std::max(1, std::min(std::abs(excess), goal_.vertices / 40));
      for (const Ranked& r : ranked(excess > 0)) {
        if (left == 0) break;
        if (!surface_.has_edge(r.edge)) continue;
        if (excess > 0) {
          left -= surface_.collapse(r.edge, 1e9) ? 1 : 0;
        } else {
          surface_.split(r.edge);
          --left;
        }
      }
      surface_.compact();
      relax();
    }
    if (surface_.living_vertices() != goal_.vertices) {
      throw InputError(fmt::format("remesh: {} vertices cannot be reached ({})", goal_.vertices,
                                   surface_.living_vertices()));
    }
  }

  const ImplicitSolid& solid_;
  RemeshParameters goal_;
  EditableSurface surface_;
};

}  // namespace

TriangleMesh remesh(const ImplicitSolid& solid, const TriangleMesh& start, const RemeshParameters& goal) {
  return Remesher(solid, start, goal).run();
}

}  // namespace palpate::geometry
