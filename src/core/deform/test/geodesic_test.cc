#include "core/deform/geodesic.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "palpate/mesh.h"

namespace palpate::deform {
namespace {

constexpr double kFar = 1e9;

// A flat square of side 2 about the origin, its vertices moved about so that many triangles are obtuse.
geometry::TriangleMesh rough_plane(int divisions, double shake) {
  geometry::TriangleMesh mesh;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> move(-shake, shake);
  const double step = 2.0 / divisions;
  for (int j = 0; j <= divisions; ++j) {
    for (int i = 0; i <= divisions; ++i)
      mesh.vertices.emplace_back(-1.0 + step * (i + move(random)), -1.0 + step * (j + move(random)), 0.0);
  }
  const int row = divisions + 1;
  for (int j = 0; j < divisions; ++j) {
    for (int i = 0; i < divisions; ++i) {
      const int a = j * row + i;
      mesh.triangles.push_back({a, a + 1, a + row + 1});
      mesh.triangles.push_back({a, a + row + 1, a + row});
    }
  }
  return mesh;
}

TEST(Geodesic, IsTheStraightDistanceOnAPlaneWithObtuseTriangles) {
  // No vertex leaves its cell, but the triangles have angles up to 170 degrees.
  GeodesicDistance geodesic(rough_plane(20, 0.32));
  const SurfacePoint source = geodesic.nearest(Vec3(0.13, -0.07, 0.2));
  geodesic.compute(source, 0.8);  // ways within 0.8 do not meet the ragged border
  EXPECT_GT(geodesic.reached().size(), 150U);
  for (const std::int32_t v : geodesic.reached()) {
    const double straight = (geodesic.mesh().vertices[static_cast<std::size_t>(v)] - source.point).norm();
    EXPECT_NEAR(geodesic.at(v), straight, 1e-9);
  }
}

TEST(Geodesic, ReachesEveryVertexNearerThanTheLimitAndNoOther) {
  GeodesicDistance geodesic(rough_plane(20, 0.2));
  const SurfacePoint source = geodesic.nearest(Vec3(0.1, 0.05, 0.0));
  geodesic.compute(source, 0.5);
  for (std::size_t v = 0; v < geodesic.mesh().vertices.size(); ++v) {
    const bool near = (geodesic.mesh().vertices[v] - source.point).norm() < 0.5;
    EXPECT_EQ(std::isfinite(geodesic.at(static_cast<std::int32_t>(v))), near) << v;
  }
}

TEST(Geodesic, IsTheArcOnASphere) {
  const double radius = 0.018;
  for (const auto& [triangles, error] : {std::pair{1280, 0.022}, std::pair{20480, 0.007}}) {
    GeodesicDistance geodesic(geometry::make_ball(radius, triangles));
    const Vec3 up = Vec3(0.2, -0.5, 0.9).normalized();
    geodesic.compute(geodesic.nearest(radius * up), kFar);
    double worst = 0.0;
    for (std::size_t v = 0; v < geodesic.mesh().vertices.size(); ++v) {
      const double arc = radius * std::acos(geodesic.mesh().vertices[v].normalized().dot(up));
      worst = std::max(worst, std::abs(geodesic.at(static_cast<std::int32_t>(v)) - arc));
    }
    // Half the circumference is pi R; edges alone would be wrong by 10 % of it however fine the mesh.
    EXPECT_LT(worst, error * 3.14159 * radius) << triangles;
  }
}

TEST(Geodesic, GoesRoundTheEdgeOfABoxAndNotThroughIt) {
  GeodesicDistance geodesic(geometry::make_box(Vec3(0.06, 0.06, 0.01), 0.002));
  geodesic.compute(geodesic.nearest(Vec3(0.02, 0.0, 0.005)), kFar);
  const SurfacePoint below = geodesic.nearest(Vec3(0.02, 0.0, -0.005));
  // Unfolded over the side x = 30 mm: 10 mm across the top, 10 mm down, 10 mm back.
  for (const std::int32_t v : geodesic.mesh().triangles[static_cast<std::size_t>(below.triangle)]) {
    const Vec3& p = geodesic.mesh().vertices[static_cast<std::size_t>(v)];
    const double unfolded = std::hypot(0.01 + 0.01 + (0.03 - p.x()), p.y());
    EXPECT_NEAR(geodesic.at(v), unfolded, 1e-9);
  }
}

TEST(Geodesic, StartsExactlyAtAVertex) {
  const geometry::TriangleMesh plane = rough_plane(10, 0.3);
  GeodesicDistance geodesic(plane);
  geodesic.compute(geodesic.nearest(plane.vertices[60]), 0.6);
  EXPECT_NEAR(geodesic.at(60), 0.0, 1e-12);
  for (const std::int32_t v : geodesic.reached())
    EXPECT_NEAR(geodesic.at(v), (plane.vertices[static_cast<std::size_t>(v)] - plane.vertices[60]).norm(),
                1e-9);
}

TEST(Geodesic, NearestPointCarriesTheInterpolatedNormal) {
  const GeodesicDistance geodesic(geometry::make_ball(1.0, 5120));
  const Vec3 up = Vec3(0.3, 0.4, 0.5).normalized();
  const SurfacePoint near = geodesic.nearest(2.0 * up);
  EXPECT_NEAR(near.point.norm(), 1.0, 2e-3);
  EXPECT_GT(near.normal.dot(up), 0.9995);
}

TEST(Geodesic, AnEmptyMeshHasNoNearestPointAndReachesNothing) {
  GeodesicDistance geodesic(geometry::TriangleMesh{});
  const SurfacePoint none = geodesic.nearest(Vec3::Zero());
  EXPECT_EQ(none.triangle, -1);
  geodesic.compute(none, 1.0);
  EXPECT_TRUE(geodesic.reached().empty());
}

}  // namespace
}  // namespace palpate::deform
