#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

namespace palpate::scene {
namespace {

/// The tool hung over the organ at one row: heights in the world by brute force over all vertices.
struct Hanging {
  double lowest = std::numeric_limits<double>::infinity();
  Vec3 tip = Vec3::Zero();
};

Hanging hang(const Setup& setup, std::size_t hand, const PathRow& row, double gripper) {
  const DeviceSetup& device = setup.devices[hand];
  const Pose handle = device.base * Pose{row.orientation, device.workspace_scale * row.position};
  Hanging result;
  for (const geometry::ToolPart& part : setup.tools[hand].parts) {
    for (const Vec3& v : part.mesh.vertices) {
      const Vec3 p = handle * (geometry::part_pose(part, gripper) * v);
      if (p.z() >= result.lowest) continue;
      result.lowest = p.z();
      result.tip = p;
    }
  }
  return result;
}

/// Height of the organ's surface over (x, y), by all triangles.
double surface_height(const Setup& setup, double x, double y) {
  geometry::TriangleMesh organ = setup.organ;
  geometry::transform(organ, setup.organ_pose);
  double height = -std::numeric_limits<double>::infinity();
  for (const geometry::Triangle& t : organ.triangles) {
    const auto corner = [&](std::size_t i) { return organ.vertices[static_cast<std::size_t>(t[i])]; };
    const Vec3 a = corner(0);
    const Vec3 u = corner(1) - a;
    const Vec3 v = corner(2) - a;
    const double area = u.x() * v.y() - u.y() * v.x();
    if (area == 0.0) continue;
    const double s = ((x - a.x()) * v.y() - (y - a.y()) * v.x()) / area;
    const double r = (u.x() * (y - a.y()) - u.y() * (x - a.x())) / area;
    if (s < -1e-9 || r < -1e-9 || s + r > 1.0 + 1e-9) continue;
    height = std::max(height, a.z() + s * u.z() + r * v.z());
  }
  return height;
}

Vec3 middle_of(const Setup& setup) {
  geometry::TriangleMesh organ = setup.organ;
  geometry::transform(organ, setup.organ_pose);
  return geometry::bounds(organ).middle();
}

double lowest_over_time(const Setup& setup, const ToolPath& path) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const PathRow& row : path.rows()) lowest = std::min(lowest, hang(setup, 0, row, 0.0).lowest);
  return lowest;
}

void expect_calm(const ToolPath& path) {
  Vec3 last = Vec3::Zero();
  for (std::size_t i = 1; i < path.rows().size(); ++i) {
    const PathRow& a = path.rows()[i - 1];
    const PathRow& b = path.rows()[i];
    const Vec3 velocity = (b.position - a.position) / (b.time - a.time);
    EXPECT_LT(velocity.norm(), 15.1e-3);
    EXPECT_LT((velocity - last).norm(), 0.5e-3) << "a jerk at " << a.time;
    last = velocity;
  }
}

TEST(DefaultPath, PressStarts10MmClearReaches12MmHoldsASecondAndComesBack) {
  for (const std::string organ : {"gallbladder", "heart", "liver", "kidney", "ball", "box"}) {
    Request request;
    request.organ = organ;
    const scene::Setup setup = load(request);
    const ToolPath path = default_path(setup, 0);
    const Vec3 middle = middle_of(setup);
    const double surface = surface_height(setup, middle.x(), middle.y());
    EXPECT_NEAR(hang(setup, 0, path.rows().front(), 0.0).lowest, surface + 10e-3, 1e-7) << organ;
    EXPECT_NEAR(lowest_over_time(setup, path), surface - 12e-3, 1e-7) << organ;
    EXPECT_NEAR(hang(setup, 0, path.rows().back(), 0.0).lowest, surface + 10e-3, 1e-7) << organ;
    const double bottom = path.at(path.end_time() / 2.0).position.z();
    EXPECT_NEAR(path.at(path.end_time() / 2.0 - 0.49).position.z(), bottom, 1e-9);
    EXPECT_NEAR(path.at(path.end_time() / 2.0 + 0.49).position.z(), bottom, 1e-9);
    for (const PathRow& row : path.rows()) EXPECT_EQ(row.gripper, 0.0);
    expect_calm(path);
  }
}

TEST(DefaultPath, TheTipComesDownOnTheOrgansMiddleWithItsZAxisDown) {
  Request request;
  request.tools = {"sphere:3"};
  const scene::Setup setup = load(request);
  const ToolPath path = default_path(setup, 0);
  const PathRow& first = path.rows().front();
  const Vec3 middle = middle_of(setup);
  EXPECT_NEAR(first.position.x(), middle.x(), 0.3e-3);  // the lowest vertices of a ball lie about its pole
  EXPECT_NEAR(first.position.y(), middle.y(), 0.3e-3);
  EXPECT_NEAR((first.orientation * Vec3(0.0, 0.0, 1.0) - Vec3(0.0, 0.0, -1.0)).norm(), 0.0, 1e-15);
}

TEST(DefaultPath, PullClosesAtTouchLifts12MmHoldsAndLetsGo) {
  Request request;
  request.task = "pull";
  const scene::Setup setup = load(request);
  const ToolPath path = default_path(setup, 0);
  const Vec3 middle = middle_of(setup);
  const double surface = surface_height(setup, middle.x(), middle.y());
  EXPECT_TRUE(path.has_gripper());
  EXPECT_EQ(path.rows().front().gripper, 1.0);
  EXPECT_EQ(path.rows().back().gripper, 1.0);
  EXPECT_NEAR(hang(setup, 0, path.rows().front(), 0.0).lowest, surface + 10e-3, 1e-7);
  EXPECT_NEAR(lowest_over_time(setup, path), surface - 0.2e-3, 1e-7);
  double closing = -1.0;
  double closed_height = 0.0;
  double held_top = -1.0;
  double time_at_top = 0.0;
  double last_time = 0.0;
  for (const PathRow& row : path.rows()) {
    const double height = hang(setup, 0, row, 0.0).lowest - surface;
    if (closing < 0.0 && row.gripper < 0.3) {
      closing = row.time;
      closed_height = height;
    }
    if (row.gripper < 0.3) held_top = std::max(held_top, height);
    if (height > 11.8e-3 - 1e-7 && row.gripper == 0.0) time_at_top += row.time - last_time;
    last_time = row.time;
  }
  EXPECT_NEAR(closed_height, -0.2e-3, 1e-7);
  EXPECT_NEAR(held_top - closed_height, 12e-3, 1e-7);
  EXPECT_GT(time_at_top, 0.99);
  expect_calm(path);
}

TEST(DefaultPath, IsGivenInTheDevicesFrame) {
  scene::Setup plain = load({});
  scene::Setup mapped = plain;
  mapped.devices[0].workspace_scale = 2.0;
  mapped.devices[0].base = {rotation_from_degrees({10.0, 20.0, 30.0}), {0.1, -0.2, 0.3}};
  const ToolPath a = default_path(plain, 0);
  const ToolPath b = default_path(mapped, 0);
  ASSERT_EQ(a.rows().size(), b.rows().size());
  for (std::size_t i = 0; i < a.rows().size(); i += 50) {
    const DeviceSetup& device = mapped.devices[0];
    EXPECT_NEAR((device.base * Vec3(2.0 * b.rows()[i].position) - a.rows()[i].position).norm(), 0.0, 1e-12);
    const Quat turned = device.base.rotation * b.rows()[i].orientation;
    EXPECT_NEAR(std::abs(turned.dot(a.rows()[i].orientation)), 1.0, 1e-12);
  }
}

TEST(DefaultPath, FollowsTheOrgansPose) {
  scene::Setup setup = load({});
  setup.organ_pose = {rotation_from_degrees({90.0, 0.0, 0.0}), {0.5, 0.0, -0.1}};
  const ToolPath path = default_path(setup, 0);
  const Vec3 middle = middle_of(setup);
  const double surface = surface_height(setup, middle.x(), middle.y());
  EXPECT_NEAR(hang(setup, 0, path.rows().front(), 0.0).lowest, surface + 10e-3, 1e-7);
}

TEST(DefaultPath, TwoHandsComeDownSideBySide) {
  scene::Setup setup = load({});
  setup.tools.push_back(setup.tools[0]);
  setup.devices.push_back(setup.devices[0]);
  const Vec3 left = default_path(setup, 0).rows().front().position;
  const Vec3 right = default_path(setup, 1).rows().front().position;
  const Vec3 apart = right - left;
  EXPECT_GT(std::hypot(apart.x(), apart.y()), 15e-3);
  EXPECT_LE(std::hypot(apart.x(), apart.y()), 30e-3 + 1e-12);
}

TEST(DefaultPath, RefusesAnOpenOrgan) {
  scene::Setup setup = load({});
  setup.organ.triangles.pop_back();
  EXPECT_THROW((void)default_path(setup, 0), InputError);
}

}  // namespace
}  // namespace palpate::scene
