#include "core/contact/point_sums.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::contact {
namespace {

constexpr std::size_t kPoints = 200;

/// A part of points strewn within 2 mm, some of them in one another's place.
PartPoints strewn(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(-2e-3, 2e-3);
  std::uniform_real_distribution<double> some(0.1, 1.0);
  PartPoints part;
  for (std::size_t i = 0; i < kPoints; ++i) {
    PartPoints::Weighed point{place(random), place(random),       place(random),      1e-3 * some(random),
                              1.0,           1e-3 * some(random), 1e-6 * some(random)};
    if (i % 7 == 6) point.x = part.weighed.back().x;
    part.weighed.push_back(point);
  }
  return part;
}

/// `count` of the part's points, in their order.
std::vector<std::uint16_t> some_of(std::mt19937_64& random, std::size_t count) {
  std::vector<std::uint16_t> all(kPoints);
  std::iota(all.begin(), all.end(), std::uint16_t{0});
  std::shuffle(all.begin(), all.end(), random);
  all.resize(count);
  std::sort(all.begin(), all.end());
  return all;
}

Vec3 direction(std::mt19937_64& random) {
  std::normal_distribution<double> number;
  return Vec3(number(random), number(random), number(random)).normalized();
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// On a processor without AVX2 these are one and the same.
TEST(PointSums, FourPointsAtATimeAreTheBitsOfTwoAtATime) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> height(-2.5e-3, 2.5e-3);  // from none behind the plane to all
  for (int trial = 0; trial < 2000; ++trial) {
    const PartPoints part = strewn(random);
    const std::vector<std::uint16_t> points = some_of(random, static_cast<std::size_t>(trial) % 97);
    const Vec3 normal = direction(random);
    const Vec3 point = height(random) * normal;
    std::vector<double> two(points.size() + kDepthsBehind), four(points.size() + kDepthsBehind);
    const double depth = by_two::full_depths(part, point, normal, points, two.data());
    ASSERT_TRUE(same_bits(full_depths(part, point, normal, points, four.data()), depth));
    for (std::size_t i = 0; i < points.size(); ++i) ASSERT_TRUE(same_bits(four[i], two[i]));
    const Support a = by_two::sum_up(part, points, two.data(), depth);
    const Support b = sum_up(part, points, four.data(), depth);
    ASSERT_TRUE(same_bits(a.depth, b.depth) && same_bits(a.tip_radius, b.tip_radius) &&
                same_bits(a.half_width, b.half_width));
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(same_bits(a.mean[i], b.mean[i])) << points.size() << " points";
  }
}

TEST(PointSums, AreTheDepthsBehindThePlaneAndTheMeanOfThoseInTheBand) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const PartPoints part = strewn(random);
    const std::vector<std::uint16_t> points = some_of(random, 1 + static_cast<std::size_t>(trial) % 97);
    const Vec3 normal = direction(random);
    const Vec3 point = 2.5e-3 * normal;  // most are behind
    std::vector<double> depths(points.size() + kDepthsBehind);
    const double depth = full_depths(part, point, normal, points, depths.data());
    double deepest = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const PartPoints::Weighed& p = part.weighed[points[i]];
      EXPECT_NEAR(depths[i], (point - Vec3(p.x, p.y, p.z)).dot(normal), 1e-17);
      deepest = std::max(deepest, depths[i]);
    }
    ASSERT_EQ(depth, deepest);
    if (depth <= 0.0) continue;
    const Support support = sum_up(part, points, depths.data(), depth);
    Vec3 mean = Vec3::Zero();
    double total = 0.0, radius = 0.0, width = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const PartPoints::Weighed& p = part.weighed[points[i]];
      const double weight = p.area * std::max(0.0, 1.0 - (depth - depths[i]) / std::min(0.2e-3, depth));
      mean += weight * Vec3(p.x, p.y, p.z);
      total += weight;
      radius += weight * p.tip_radius;
      width += weight * p.half_width;
    }
    EXPECT_EQ(support.depth, depth);
    EXPECT_NEAR((support.mean - mean / total).norm(), 0.0, 1e-15);
    EXPECT_NEAR(support.tip_radius, radius / total, 1e-15);
    EXPECT_NEAR(support.half_width, width / total, 1e-15);
  }
}

TEST(PointSums, OfNoPointsAndOfPointsBeforeThePlaneAreNothing) {
  std::mt19937_64 random(3);
  const PartPoints part = strewn(random);
  std::vector<double> depths(kPoints + kDepthsBehind);
  EXPECT_EQ(full_depths(part, Vec3::Zero(), Vec3::UnitZ(), {}, depths.data()), 0.0);
  EXPECT_EQ(sum_up(part, {}, depths.data(), 0.0).depth, 0.0);
  const std::vector<std::uint16_t> all = some_of(random, kPoints);
  EXPECT_EQ(full_depths(part, Vec3(0, 0, -3e-3), Vec3::UnitZ(), all, depths.data()), 0.0);
}

}  // namespace
}  // namespace palpate::contact
