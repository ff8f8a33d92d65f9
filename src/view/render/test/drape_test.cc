// The drape under an organ and its soft shadow.
#include "view/render/drape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/index.h"
#include "palpate/offscreen.h"

namespace palpate::render {
namespace {

/// A plate of 80 x 60 mm at 20 mm, and a needle from it down to 0 at one corner.
geometry::TriangleMesh plate_on_a_needle() {
  geometry::TriangleMesh mesh;
  const auto add = [&mesh](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  const Vec3 low(-40e-3, -30e-3, 20e-3);
  const Vec3 high(40e-3, 30e-3, 20e-3);
  add(low, {low.x(), high.y(), 20e-3}, high);
  add(low, high, {high.x(), low.y(), 20e-3});
  add({-40e-3, -30e-3, 0.0}, {-40e-3, -29.9e-3, 20e-3}, {-39.9e-3, -30e-3, 20e-3});
  return mesh;
}

/// Share of the sky that a rectangle covers, seen from under its corner [Howell, configuration factor B-3].
double under_corner(double width, double length, double height) {
  const double x = width / height;
  const double y = length / height;
  const double root_x = std::sqrt(1.0 + x * x);
  const double root_y = std::sqrt(1.0 + y * y);
  return (x / root_x * std::atan(y / root_x) + y / root_y * std::atan(x / root_y)) / (2.0 * std::numbers::pi);
}

double light_near(const Drape& drape, const Vec3& point) {
  const auto nearest =
      std::min_element(drape.vertices.begin(), drape.vertices.end(), [&](const auto& a, const auto& b) {
        return (a.position.template cast<double>() - point).norm() <
               (b.position.template cast<double>() - point).norm();
      });
  return nearest->moved;
}

TEST(Drape, LosesTheShareOfTheSkyThatARectangleAboveItCovers) {
  const Drape drape = drape_below(plate_on_a_needle(), Pose{});
  EXPECT_NEAR(light_near(drape, Vec3::Zero()), 1.0 - 4.0 * under_corner(40e-3, 30e-3, 20e-3), 0.02);
  EXPECT_NEAR(light_near(drape, Vec3(40e-3, 30e-3, 0.0)), 1.0 - under_corner(80e-3, 60e-3, 20e-3), 0.03);
  EXPECT_GT(light_near(drape, Vec3(drape.radius, 0.0, 0.0)), 0.97) << "far away nothing is dark";
}

TEST(Drape, TouchesTheLowestPointOfTheOrganInItsPose) {
  const Pose turned{Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX())), Vec3(0.1, 0.2, 0.3)};
  const Drape drape = drape_below(plate_on_a_needle(), turned);  // y becomes z
  EXPECT_NEAR(drape.middle.z(), 0.3 - 30e-3, 1e-9);
  EXPECT_NEAR(drape.middle.x(), 0.1, 1e-9);
  for (const deform::SurfaceVertex& vertex : drape.vertices)
    EXPECT_FLOAT_EQ(vertex.position.z(), static_cast<float>(drape.middle.z()));
}

TEST(Drape, IsFinelyDividedAndSeenFromAbove) {
  const Drape drape = drape_below(plate_on_a_needle(), Pose{});
  for (std::size_t i = 0; i < drape.corners.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return drape.vertices.at(drape.corners[i + k]).position; };
    EXPECT_GT((corner(1) - corner(0)).cross(corner(2) - corner(0)).z(), 0.0F);
  }
}

}  // namespace
}  // namespace palpate::render
