// The tree excludes no triangle that counts.
#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/geometry/disc_search.h"
#include "core/geometry/signed_distance.h"
#include "palpate/builtin.h"
#include "palpate/mesh.h"

namespace palpate::geometry {
namespace {

std::vector<TriangleMesh> meshes() {
  TriangleMesh far_away = make_ball(5e-3, 320);
  transform(far_away, Pose{Quat::Identity(), Vec3(0.5, -2.0, 1.0)});
  TriangleMesh needles = make_box(Vec3(60e-3, 40e-3, 1e-3), 0.1);  // two long triangles per side
  for (Vec3& vertex : needles.vertices) vertex.y() *= 1e-3;
  return {make_organ("gallbladder"), make_ball(20e-3, 20), far_away, needles,
          make_box(Vec3(1e-2, 1e-2, 1e-2), 3e-3)};
}

double squared_distance(const TriangleMesh& mesh, std::size_t t, const Vec3& p) {
  const auto corner = [&](std::size_t k) {
    return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])];
  };
  return (p - nearest_on_triangle(p, corner(0), corner(1), corner(2))).squaredNorm();
}

Vec3 near_to(const TriangleMesh& mesh, std::mt19937& random, double reach) {
  std::uniform_int_distribution<std::size_t> vertex(0, mesh.vertices.size() - 1);
  std::normal_distribution<double> normal;
  return mesh.vertices[vertex(random)] + reach * Vec3(normal(random), normal(random), normal(random));
}

TEST(DiscBvh, VisitsEveryTriangleWithinReach) {
  std::mt19937 random(3);
  for (const TriangleMesh& mesh : meshes()) {
    const DiscBvh tree(mesh);
    for (int i = 0; i < 150; ++i) {
      const Vec3 p = near_to(mesh, random, i % 2 == 0 ? 1e-3 : 20e-3);
      const double reach = i % 3 == 0 ? 1e-3 : 15e-3;
      std::set<std::int32_t> visited;
      tree.each_within(
          p, [&](std::int32_t slot) { visited.insert(tree.triangle_of()[static_cast<std::size_t>(slot)]); },
          [&] { return reach * reach; });
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (squared_distance(mesh, t, p) <= reach * reach) {
          EXPECT_TRUE(visited.contains(static_cast<std::int32_t>(t)));
        }
      }
    }
  }
}

TEST(DiscBvh, LooksAtLittleMoreThanTheTrianglesUnderAPoint) {
  std::mt19937 random(4);
  const TriangleMesh mesh = subdivide(make_organ("gallbladder"));
  const DiscBvh tree(mesh);
  int visits = 0;
  constexpr int kQueries = 400;
  for (int i = 0; i < kQueries; ++i) {
    const Vec3 p = near_to(mesh, random, 5e-3);
    double best = 1.0;
    tree.each_within(
        p,
        [&](std::int32_t slot) {
          ++visits;
          const auto t = static_cast<std::size_t>(tree.triangle_of()[static_cast<std::size_t>(slot)]);
          best = std::min(best, squared_distance(mesh, t, p));
        },
        [&] { return best; });
  }
  EXPECT_LT(visits, 8 * kQueries);  // of 8,440 triangles
}

TEST(DiscBvh, VisitsEveryTriangleAlongASegment) {
  std::mt19937 random(5);
  for (const TriangleMesh& mesh : meshes()) {
    const DiscBvh tree(mesh);
    for (int i = 0; i < 40; ++i) {
      const Vec3 a = near_to(mesh, random, 2e-3);
      const Vec3 b = near_to(mesh, random, 2e-3);
      std::set<std::int32_t> visited;
      tree.each_along(a, b, 1e-9, [&](std::int32_t slot) {
        visited.insert(tree.triangle_of()[static_cast<std::size_t>(slot)]);
      });
      for (int k = 0; k <= 100; ++k) {
        const Vec3 p = a + (k / 100.0) * (b - a);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
          if (squared_distance(mesh, t, p) > 1e-18) continue;
          EXPECT_TRUE(visited.contains(static_cast<std::int32_t>(t)));
        }
      }
    }
  }
}

TEST(DiscBvh, HoldsEveryTriangleOnce) {
  for (const TriangleMesh& mesh : meshes()) {
    const DiscBvh tree(mesh);
    const std::set<std::int32_t> all(tree.triangle_of().begin(), tree.triangle_of().end());
    EXPECT_EQ(all.size(), mesh.triangles.size());
    EXPECT_EQ(tree.triangle_of().size(), mesh.triangles.size());
  }
}

}  // namespace
}  // namespace palpate::geometry
