#include "view/render/depth_map.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace palpate::render {
namespace {

using Eigen::Vector3f;

constexpr int kSide = DepthMap::kSide;

TEST(DepthMap, ATriangleCoversTheCellsInsideItAtItsDepthAndNoOthers) {
  DepthMap map;
  // Rows and columns 10 to 30 with i + j <= 40; the depth increases by 1 mm per row.
  map.add_triangle(Vector3f(10, 10, 0.010F), Vector3f(30, 10, 0.030F), Vector3f(10, 30, 0.010F), 1.0F);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const bool inside = i >= 10 && j >= 10 && i + j <= 40;
      const float expected = inside ? 0.001F * static_cast<float>(i) : DepthMap::kNothing;
      ASSERT_NEAR(map.at(i, j), expected, 1e-5) << i << " " << j;
    }
}

TEST(DepthMap, KeepsTheDeepestButNoneDeeperThanAllowed) {
  DepthMap map;
  const auto add = [&map](float depth, float most) {
    map.add_triangle(Vector3f(0, 0, depth), Vector3f(60, 0, depth), Vector3f(0, 60, depth), most);
  };
  add(0.004F, 1.0F);
  add(0.002F, 1.0F);
  EXPECT_FLOAT_EQ(map.at(5, 5), 0.004F);
  add(0.020F, 0.012F);
  EXPECT_FLOAT_EQ(map.at(5, 5), 0.012F);
}

TEST(DepthMap, TrianglesThatShareAnEdgeLeaveNoCellOutWhicheverWayTheyTurn) {
  DepthMap map;
  map.add_triangle(Vector3f(-20, -13, 0), Vector3f(117, -9, 0), Vector3f(95, 130, 0), 1.0F);
  map.add_triangle(Vector3f(-20, -13, 0), Vector3f(-31, 120, 0), Vector3f(95, 130, 0), 1.0F);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) ASSERT_EQ(map.at(i, j), 0.0F) << i << " " << j;
}

TEST(DepthMap, WhatLiesBesideTheMapOrIsSeenOnEdgeAddsNothing) {
  DepthMap map;
  map.add_triangle(Vector3f(-9, -9, 0), Vector3f(-1, -9, 0), Vector3f(-9, 80, 0), 1.0F);
  map.add_triangle(Vector3f(95, 0, 0), Vector3f(99, 0, 0), Vector3f(95, 80, 0), 1.0F);
  map.add_triangle(Vector3f(0, 0, 0), Vector3f(40, 40, 0), Vector3f(20, 20, 0.01F), 1.0F);
  map.add_slopes(0.001F);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) ASSERT_EQ(map.at(i, j), DepthMap::kNothing) << i << " " << j;
}

TEST(DepthMap, SlopesFallWithTheDistanceToThreePercent) {
  DepthMap map;
  const auto dot = [&map](float i, float j, float depth) {
    map.add_triangle(Vector3f(i - 0.3F, j - 0.3F, depth), Vector3f(i + 0.6F, j - 0.3F, depth),
                     Vector3f(i - 0.3F, j + 0.6F, depth), 1.0F);
  };
  dot(20.0F, 71.0F, 0.010F);
  dot(64.0F, 12.0F, 0.030F);
  map.add_slopes(0.001F);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const double first = std::hypot(i - 20, j - 71);
      const double second = std::hypot(i - 64, j - 12);
      const double expected = std::max(0.010 - 0.001 * first, 0.030 - 0.001 * second);
      ASSERT_LT(map.at(i, j), expected + 1e-6) << i << " " << j;
      ASSERT_GT(map.at(i, j), expected - 3e-5 * std::max(first, second) - 1e-6) << i << " " << j;
    }
}

TEST(DepthMap, EveningOutKeepsAPlaneAndSpreadsACellOverItsNeighbours) {
  DepthMap map;
  map.add_triangle(Vector3f(-50, -50, 0.001F), Vector3f(250, -50, 0.001F), Vector3f(-50, 250, 0.001F), 1.0F);
  map.add_triangle(Vector3f(39.7F, 39.7F, 0.010F), Vector3f(40.6F, 39.7F, 0.010F),
                   Vector3f(39.7F, 40.6F, 0.010F), 1.0F);
  map.smooth(1);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const bool near = std::abs(i - 40) <= 1 && std::abs(j - 40) <= 1;
      ASSERT_NEAR(map.at(i, j), near ? 0.002F : 0.001F, 1e-6) << i << " " << j;
    }
}

}  // namespace
}  // namespace palpate::render
