#include "bench/measure/bench_scene.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "palpate/mesh.h"

#include "bench/measure/test/sample_scene.h"

namespace palpate::bench {
namespace {

using geometry::TriangleMesh;

/// Whether every edge has two triangles.
bool closed(const TriangleMesh& mesh) {
  for (const auto& neighbours : geometry::edge_neighbours(mesh)) {
    if (std::find(neighbours.begin(), neighbours.end(), -1) != neighbours.end()) return false;
  }
  return true;
}

TEST(Subjects, EveryTriangleBecomesPartsSquaredAndClosedStaysClosed) {
  const TriangleMesh ball = geometry::make_ball(0.03, 80);
  for (const int parts : {1, 2, 3, 7}) {
    for (const Shape shape : {Shape::kFlat, Shape::kCurved}) {
      const TriangleMesh fine = tessellate(ball, parts, shape);
      const auto square = static_cast<std::size_t>(parts) * static_cast<std::size_t>(parts);
      EXPECT_EQ(fine.triangles.size(), 80 * square);
      EXPECT_EQ(fine.vertices.size(), fine.triangles.size() / 2 + 2);  // Euler's formula
      EXPECT_TRUE(closed(fine));
    }
  }
}

TEST(Subjects, FlatStaysOnTheSurface) {
  const TriangleMesh box = geometry::make_box(Vec3(0.02, 0.04, 0.06), 0.02);
  const TriangleMesh fine = tessellate(box, 5, Shape::kFlat);
  EXPECT_NEAR(geometry::signed_volume(fine), 0.02 * 0.04 * 0.06, 1e-15);
}

TEST(Subjects, CurvedIsRounderThanFlat) {
  const TriangleMesh ball = geometry::make_ball(0.03, 80);
  const double round = 4.0 / 3.0 * 3.14159265358979 * 0.03 * 0.03 * 0.03;
  const double flat = round - geometry::signed_volume(tessellate(ball, 4, Shape::kFlat));
  const double curved = round - geometry::signed_volume(tessellate(ball, 4, Shape::kCurved));
  EXPECT_GT(flat, 0.0);
  EXPECT_LT(std::abs(curved), 0.5 * flat);
}

TEST(Subjects, NoPartsThrow) {
  const TriangleMesh ball = geometry::make_ball(0.03, 20);
  EXPECT_THROW(static_cast<void>(tessellate(ball, 0, Shape::kFlat)), std::invalid_argument);
}

TEST(Subjects, PartsComeNearestToTheWantedCount) {
  EXPECT_EQ(parts_for(2110, 100'000), 7);     // 103,390
  EXPECT_EQ(parts_for(2110, 1'000'000), 22);  // 1,021,240
  EXPECT_EQ(parts_for(6412, 6412), 1);
  EXPECT_EQ(parts_for(6412, 100), 1);
  EXPECT_EQ(parts_for(0, 100), 1);
}

TEST(Subjects, TheWayEndsAsItBeginsAndPassesTheScenesOwn) {
  const scene::Scene scene = sample_scene();
  const scene::ToolPath own = scene::default_path(scene, 0);
  const scene::ToolPath way = hand_path(scene);
  const scene::PathRow& first = way.rows().front();
  const scene::PathRow& last = way.rows().back();
  EXPECT_LT((first.position - last.position).norm(), 1e-9);
  EXPECT_LT(first.orientation.angularDistance(last.orientation), 1e-6);
  EXPECT_NEAR((first.position - own.rows().front().position).z(), 10e-3, 1e-9);
  double lowest = 1.0;
  double own_lowest = 1.0;
  for (const scene::PathRow& row : way.rows()) lowest = std::min(lowest, row.position.z());
  for (const scene::PathRow& row : own.rows()) own_lowest = std::min(own_lowest, row.position.z());
  EXPECT_EQ(lowest, own_lowest);
}

TEST(Subjects, TheWayIsNeverStill) {
  const scene::ToolPath way = hand_path(sample_scene());
  for (std::size_t i = 1; i < way.rows().size(); ++i)
    ASSERT_GT((way.rows()[i].position - way.rows()[i - 1].position).norm(), 1e-9) << i;
}

TEST(Subjects, AFinerToolKeepsItsShape) {
  const scene::Scene coarse = bench_scene("press", 0, 0);
  const scene::Scene fine = bench_scene("press", 0, 10'000);
  EXPECT_GT(triangle_count(fine.tools[0]), 5'000U);
  EXPECT_EQ(fine.organ.triangles.size(), coarse.organ.triangles.size());
  ASSERT_EQ(fine.tools[0].parts.size(), coarse.tools[0].parts.size());
  for (std::size_t part = 0; part < fine.tools[0].parts.size(); ++part) {
    const double volume = geometry::signed_volume(coarse.tools[0].parts[part].mesh);
    EXPECT_NEAR(geometry::signed_volume(fine.tools[0].parts[part].mesh), volume, 1e-9 * volume);
  }
}

}  // namespace
}  // namespace palpate::bench
