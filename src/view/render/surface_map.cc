#include "view/render/surface_map.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/base/index.h"
#include "core/deform/surface_parts.h"
#include "core/geometry/cell.h"
#include "core/geometry/signed_distance.h"

namespace palpate::render {
namespace {

constexpr double kLeastCosine = 0.25;  // between the normals of a vertex and its point

using PointsByCell = std::unordered_map<geometry::Cell, std::vector<std::int32_t>, geometry::ThreeWordsHash>;

// The nearest point within kReach with a similar normal, or -1.
std::int32_t nearest_point(const Vec3& vertex, const Vec3& normal, std::span<const Vec3> points,
                           const std::vector<Vec3>& normals, const PointsByCell& cells) {
  const geometry::Cell middle = geometry::cell_at(vertex, SurfaceMap::kReach);
  std::int32_t nearest = -1;
  double best = SurfaceMap::kReach * SurfaceMap::kReach;
  for (int neighbour = 0; neighbour < 27; ++neighbour) {
    const auto found = cells.find(
        {middle[0] + neighbour % 3 - 1, middle[1] + neighbour / 3 % 3 - 1, middle[2] + neighbour / 9 - 1});
    if (found == cells.end()) continue;
    for (const std::int32_t i : found->second) {
      const double squared = (points[at(i)] - vertex).squaredNorm();
      if (squared >= best || normals[at(i)].dot(normal) < kLeastCosine) continue;
      best = squared;
      nearest = i;
    }
  }
  return nearest;
}

}  // namespace

std::vector<Vec3> normals_at(const geometry::TriangleMesh& mesh, std::span<const Vec3> points) {
  std::vector<Vec3> normals;
  if (points.empty()) return normals;
  const geometry::SignedDistance surface(mesh);
  normals.reserve(points.size());
  geometry::NearestPoint nearest;
  for (const Vec3& p : points) {
    nearest = surface.nearest(p, nearest.triangle);
    normals.push_back(nearest.normal);
  }
  return normals;
}

void smooth_outline(std::span<const geometry::Triangle> triangles, std::vector<MapVertex>& vertices) {
  struct Sum {
    float share = 0.0F;
    float known = 0.0F;
    float corners = 0.0F;
  };
  std::vector<Sum> sums(vertices.size());
  for (const geometry::Triangle& t : triangles) {
    Sum sum{0.0F, 0.0F, 3.0F};
    for (const std::int32_t v : t) {
      sum.share += vertices[at(v)].share * vertices[at(v)].known;
      sum.known += vertices[at(v)].known;
    }
    for (const std::int32_t v : t) {
      sums[at(v)].share += sum.share;
      sums[at(v)].known += sum.known;
      sums[at(v)].corners += sum.corners;
    }
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (!(sums[v].known > 0.0F)) continue;
    if (!(vertices[v].known > 0.0F)) vertices[v].share = sums[v].share / sums[v].known;
    vertices[v].known = sums[v].known / sums[v].corners;
  }
}

SurfaceMap::SurfaceMap(const geometry::TriangleMesh& mesh, std::span<const Vec3> points_S) {
  const std::vector<Vec3> point_normals = normals_at(mesh, points_S);
  PointsByCell cells;
  for (std::size_t i = 0; i < points_S.size(); ++i)
    cells[geometry::cell_at(points_S[i], kReach)].push_back(static_cast<std::int32_t>(i));
  const std::vector<Vec3> vertex_normals_S = deform::vertex_normals(mesh);
  point_of_.reserve(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    point_of_.push_back(nearest_point(mesh.vertices[v], vertex_normals_S[v], points_S, point_normals, cells));
}

std::vector<MapVertex> SurfaceMap::attributes(std::span<const geometry::Triangle> triangles,
                                              std::span<const float> values, double low, double high) const {
  std::vector<MapVertex> vertices(point_of_.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (point_of_[v] < 0) continue;
    const float value = values[at(point_of_[v])];
    if (std::isnan(value)) continue;
    vertices[v] = {static_cast<float>(std::clamp((value - low) / (high - low), 0.0, 1.0)), 1.0F};
  }
  smooth_outline(triangles, vertices);
  return vertices;
}

}  // namespace palpate::render
