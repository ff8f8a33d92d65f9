#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::geometry {
namespace {

constexpr int kMaxDivisions = 2000;                   // of one side of a box
constexpr std::size_t kMaxBallTriangles = 5'242'880;  // 20 x 4^9

TriangleMesh unit_icosahedron() {
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  TriangleMesh mesh;
  for (const double one : {-1.0, 1.0}) {
    for (const double g : {-golden, golden}) {
      mesh.vertices.insert(mesh.vertices.end(), {Vec3(0.0, one, g), Vec3(one, g, 0.0), Vec3(g, 0.0, one)});
    }
  }
  // Three vertices at mutual distance 2 (the edge length in these coordinates) form a face.
  const auto is_edge = [&](std::size_t a, std::size_t b) {
    return std::abs((mesh.vertices[a] - mesh.vertices[b]).squaredNorm() - 4.0) < 1e-9;
  };
  for (std::size_t a = 0; a < 12; ++a) {
    for (std::size_t b = a + 1; b < 12; ++b) {
      for (std::size_t c = b + 1; c < 12; ++c) {
        if (!is_edge(a, b) || !is_edge(b, c) || !is_edge(c, a)) continue;
        Triangle face{static_cast<std::int32_t>(a), static_cast<std::int32_t>(b),
                      static_cast<std::int32_t>(c)};
        if (area_vector_doubled(mesh, face).dot(mesh.vertices[a]) < 0.0) std::swap(face[1], face[2]);
        mesh.triangles.push_back(face);
      }
    }
  }
  for (Vec3& vertex : mesh.vertices) vertex /= vertex.norm();
  return mesh;
}

}  // namespace

TriangleMesh make_ball(double radius, int triangles) {
  if (!std::isfinite(radius) || !(radius > 0.0))
    throw ParameterError("ball radius (m)", radius, "finite and > 0");
  if (triangles > static_cast<int>(kMaxBallTriangles)) {
    throw ParameterError("ball triangles", triangles, "at most 5242880");
  }
  TriangleMesh mesh = unit_icosahedron();
  while (static_cast<int>(mesh.triangles.size()) < triangles) {
    mesh = subdivide(mesh);
    for (Vec3& vertex : mesh.vertices) vertex /= vertex.norm();
  }
  for (Vec3& vertex : mesh.vertices) vertex *= radius;
  return mesh;
}

TriangleMesh make_box(const Vec3& size, double longest) {
  if (!(longest > 0.0)) throw ParameterError("box longest edge (m)", longest, "> 0");
  std::array<int, 3> cells{};
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(size[k]) || !(size[k] > 0.0))
      throw ParameterError("box size (m)", size[k], "finite and > 0");
    // Rounding must not add a cell to exact multiples.
    const double divisions = std::max(1.0, std::ceil(size[k] / longest - 1e-9));
    if (divisions > kMaxDivisions)
      throw ParameterError("box longest edge (m)", longest, "at least size / 2000");
    cells[static_cast<std::size_t>(k)] = static_cast<int>(divisions);
  }
  TriangleMesh mesh;
  std::map<std::tuple<int, int, int>, std::int32_t> index_of;
  const auto vertex_at = [&](const std::array<int, 3>& cell) {
    const auto [entry, is_new] =
        index_of.try_emplace({cell[0], cell[1], cell[2]}, static_cast<std::int32_t>(mesh.vertices.size()));
    if (is_new) {
      Vec3 point;
      for (int k = 0; k < 3; ++k) {
        const auto n = static_cast<std::size_t>(k);
        point[k] = size[k] * (static_cast<double>(cell[n]) / cells[n] - 0.5);
      }
      mesh.vertices.push_back(point);
    }
    return entry->second;
  };
  for (std::size_t k = 0; k < 3; ++k) {  // the two sides perpendicular to axis k; u, v, k right-handed
    const std::size_t u = (k + 1) % 3;
    const std::size_t v = (k + 2) % 3;
    for (const int side : {0, 1}) {
      for (int i = 0; i < cells[u]; ++i) {
        for (int j = 0; j < cells[v]; ++j) {
          const auto corner = [&](int du, int dv) {
            std::array<int, 3> cell{};
            cell[k] = side * cells[k];
            cell[u] = i + du;
            cell[v] = j + dv;
            return vertex_at(cell);
          };
          const std::int32_t a = corner(0, 0);
          const std::int32_t b = side == 1 ? corner(1, 0) : corner(0, 1);
          const std::int32_t c = corner(1, 1);
          const std::int32_t d = side == 1 ? corner(0, 1) : corner(1, 0);
          mesh.triangles.push_back({a, b, c});
          mesh.triangles.push_back({a, c, d});
        }
      }
    }
  }
  return mesh;
}

}  // namespace palpate::geometry
