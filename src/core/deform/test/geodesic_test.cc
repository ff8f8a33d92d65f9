#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/deform/geodesic_front.h"
#include "core/deform/test/plain_surface.h"
#include "core/deform/triangle_search.h"
#include "palpate/builtin.h"
#include "palpate/mesh.h"

namespace palpate::deform {
namespace {

constexpr float kFar = 1e9F;
constexpr int kAll = std::numeric_limits<int>::max();

// A flat square of side 2 about the origin, with randomly moved vertices, so that many triangles are obtuse.
geometry::TriangleMesh rough_plane(int divisions, double shake) {
  geometry::TriangleMesh mesh;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> move(-shake, shake);
  const double step = 2.0 / divisions;
  for (int j = 0; j <= divisions; ++j) {
    for (int i = 0; i <= divisions; ++i) {
      // separate statements, because the order of evaluation of arguments is unspecified
      const double x = -1.0 + step * (i + move(random));
      mesh.vertices.emplace_back(x, -1.0 + step * (j + move(random)), 0.0);
    }
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

// A front from the surface point nearest to p, up to `limit` [m].
class Front {
 public:
  Front(const geometry::TriangleMesh& mesh, const Vec3& p, float limit)
      : mesh_(mesh), surface_(mesh), front_(surface_), source_(TriangleSearch(mesh).nearest(p)) {
    front_.begin(mesh.triangles[static_cast<std::size_t>(source_.triangle)], source_.point.cast<float>());
    front_.advance(limit, kAll);
  }
  [[nodiscard]] const GeodesicFront& operator*() const { return front_; }
  [[nodiscard]] double straight(std::int32_t v) const { return (vertex(v) - source_.point).norm(); }
  [[nodiscard]] const Vec3& vertex(std::int32_t v) const {
    return mesh_.vertices[static_cast<std::size_t>(v)];
  }
  [[nodiscard]] double at(std::int32_t v) const { return static_cast<double>(front_.distance_of(v)); }

 private:
  geometry::TriangleMesh mesh_;
  FrontSurface surface_;
  GeodesicFront front_;
  contact::SurfacePoint source_;
};

TEST(Geodesic, IsTheStraightDistanceOnAPlaneWithObtuseTriangles) {
  // No vertex leaves its grid cell, but angles reach 170 degrees.
  const Front front(rough_plane(20, 0.32), Vec3(0.13, -0.07, 0.2), kFar);
  std::size_t within = 0;
  for (const std::int32_t v : (*front).settled()) {
    if (front.straight(v) > 0.8) continue;  // paths to nearer vertices do not meet the ragged border
    EXPECT_NEAR(front.at(v), front.straight(v), 1e-5);
    ++within;
  }
  EXPECT_GT(within, 150U);
}

TEST(Geodesic, SettlesEveryVertexNearerThanTheLimit) {
  const geometry::TriangleMesh plane = rough_plane(20, 0.2);
  const Front front(plane, Vec3(0.1, 0.05, 0.0), 0.5F);
  std::vector<bool> is_settled(plane.vertices.size());
  for (const std::int32_t v : (*front).settled()) is_settled[static_cast<std::size_t>(v)] = true;
  for (std::size_t v = 0; v < plane.vertices.size(); ++v) {
    const bool near = front.straight(static_cast<std::int32_t>(v)) < 0.5;
    EXPECT_EQ(is_settled[v], near) << v;
  }
}

TEST(Geodesic, IsTheArcOnASphere) {
  const double radius = 0.018;
  for (const auto& [triangles, error] : {std::pair{1280, 0.022}, std::pair{20480, 0.007}}) {
    const geometry::TriangleMesh ball = geometry::make_ball(radius, triangles);
    const Vec3 up = Vec3(0.2, -0.5, 0.9).normalized();
    const Front front(ball, radius * up, kFar);
    double worst = 0.0;
    for (std::size_t v = 0; v < ball.vertices.size(); ++v) {
      const double arc = radius * std::acos(ball.vertices[v].normalized().dot(up));
      worst = std::max(worst, std::abs(front.at(static_cast<std::int32_t>(v)) - arc));
    }
    // Half the circumference is pi R. Distances along edges only would be 10 % too long on any mesh.
    EXPECT_LT(worst, error * 3.14159 * radius) << triangles;
  }
}

TEST(Geodesic, GoesRoundTheEdgeOfABoxAndNotThroughIt) {
  const geometry::TriangleMesh box = geometry::make_box(Vec3(0.06, 0.06, 0.01), 0.002);
  const Front front(box, Vec3(0.02, 0.0, 0.005), kFar);
  const std::int32_t below = TriangleSearch(box).nearest(Vec3(0.02, 0.0, -0.005)).triangle;
  // Unfolded over the side x = 30 mm: 10 mm across the top, 10 mm down, 10 mm back.
  for (const std::int32_t v : box.triangles[static_cast<std::size_t>(below)]) {
    const Vec3& p = front.vertex(v);
    EXPECT_NEAR(front.at(v), std::hypot(0.01 + 0.01 + (0.03 - p.x()), p.y()), 1e-6);
  }
}

TEST(Geodesic, StartsAtAVertex) {
  const geometry::TriangleMesh plane = rough_plane(10, 0.3);
  // with a limit, distances just below it may be too long
  const Front front(plane, plane.vertices[60], kFar);
  EXPECT_NEAR(front.at(60), 0.0, 1e-6);
  for (const std::int32_t v : (*front).settled()) {
    const double straight = (front.vertex(v) - plane.vertices[60]).norm();
    if (straight > 0.6) continue;  // paths to nearer vertices do not meet the ragged border
    EXPECT_NEAR(front.at(v), straight, 1e-5);
  }
}

TEST(Geodesic, IsThePlainRulesToSinglePrecision) {
  for (const char* const name : {"heart", "liver"}) {
    const geometry::TriangleMesh organ = geometry::make_organ(name);
    const Front front(organ, organ.vertices[10], kFar);
    test::PlainGeodesic plain(organ);
    plain.compute(plain.nearest(organ.vertices[10]), 1e9);
    for (std::size_t v = 0; v < organ.vertices.size(); ++v) {
      const auto vertex = static_cast<std::int32_t>(v);
      ASSERT_NEAR(front.at(vertex), plain.at(vertex), 5e-6) << name << ", vertex " << v;
    }
  }
}

}  // namespace
}  // namespace palpate::deform
