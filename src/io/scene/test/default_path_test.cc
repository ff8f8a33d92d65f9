#include "io/scene/default_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "core/contact/contact.h"
#include "io/scene/make_world.h"
#include "io/system/test/own_cache.h"
#include "palpate/error.h"
#include "palpate/organ_cache.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

namespace palpate::scene {
namespace {

/// The tool and the organ at one row: heights in the world, by brute force over all vertices.
struct Hanging {
  double lowest = std::numeric_limits<double>::infinity();
  Vec3 tip = Vec3::Zero();
};

Hanging hang(const Scene& scene, std::size_t hand, const PathRow& row, double gripper) {
  const DeviceSetup& device = scene.devices[hand];
  const Pose handle = device.base * Pose{row.orientation, device.workspace_scale * row.position};
  Hanging result;
  for (const geometry::ToolPart& part : scene.tools[hand].parts) {
    for (const Vec3& v : part.mesh.vertices) {
      const Vec3 p = handle * (geometry::part_pose(part, gripper) * v);
      if (p.z() >= result.lowest) continue;
      result.lowest = p.z();
      result.tip = p;
    }
  }
  return result;
}

/// Height of the organ's surface at (x, y), by brute force over all triangles.
double surface_height(const Scene& scene, double x, double y) {
  geometry::TriangleMesh organ = scene.organ;
  geometry::transform(organ, scene.organ_pose);
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

Vec3 middle_of(const Scene& scene) {
  geometry::TriangleMesh organ = scene.organ;
  geometry::transform(organ, scene.organ_pose);
  return geometry::bounds(organ).middle();
}

double lowest_over_time(const Scene& scene, const ToolPath& path) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const PathRow& row : path.rows()) lowest = std::min(lowest, hang(scene, 0, row, 0.0).lowest);
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
  for (const std::string organ : {"gallbladder", "liver", "kidney", "ball", "box"}) {
    Overrides request;
    request.organ = organ;
    const scene::Scene scene = load(request);
    const ToolPath path = default_path(scene, 0);
    const Vec3 middle = middle_of(scene);
    const double surface = surface_height(scene, middle.x(), middle.y());
    EXPECT_NEAR(hang(scene, 0, path.rows().front(), 0.0).lowest, surface + 10e-3, 1e-7) << organ;
    EXPECT_NEAR(lowest_over_time(scene, path), surface - 12e-3, 1e-7) << organ;
    EXPECT_NEAR(hang(scene, 0, path.rows().back(), 0.0).lowest, surface + 10e-3, 1e-7) << organ;
    const double bottom = path.at(path.end_time() / 2.0).position.z();
    EXPECT_NEAR(path.at(path.end_time() / 2.0 - 0.49).position.z(), bottom, 1e-9);
    EXPECT_NEAR(path.at(path.end_time() / 2.0 + 0.49).position.z(), bottom, 1e-9);
    for (const PathRow& row : path.rows()) EXPECT_EQ(row.gripper, 0.0);
    expect_calm(path);
  }
}

TEST(DefaultPath, TheTipComesDownOnTheOrgansMiddleWithItsZAxisDown) {
  Overrides request;
  request.tools = {"sphere:3"};
  const scene::Scene scene = load(request);
  const ToolPath path = default_path(scene, 0);
  const PathRow& first = path.rows().front();
  const Vec3 middle = middle_of(scene);
  EXPECT_NEAR(first.position.x(), middle.x(), 0.3e-3);  // the lowest vertices of a ball are around its pole
  EXPECT_NEAR(first.position.y(), middle.y(), 0.3e-3);
  EXPECT_NEAR((first.orientation * Vec3(0.0, 0.0, 1.0) - Vec3(0.0, 0.0, -1.0)).norm(), 0.0, 1e-15);
}

TEST(DefaultPath, PullClosesAtTouchLifts12MmHoldsAndLetsGo) {
  Overrides request;
  request.task = "pull";
  const scene::Scene scene = load(request);
  const ToolPath path = default_path(scene, 0);
  const Vec3 middle = middle_of(scene);
  const double surface = surface_height(scene, middle.x(), middle.y());
  EXPECT_TRUE(path.has_gripper());
  EXPECT_EQ(path.rows().front().gripper, 1.0);
  EXPECT_EQ(path.rows().back().gripper, 1.0);
  EXPECT_NEAR(hang(scene, 0, path.rows().front(), 0.0).lowest, surface + 10e-3, 1e-7);
  EXPECT_NEAR(lowest_over_time(scene, path), surface - 0.2e-3, 1e-7);
  double closing = -1.0;
  double closed_height = 0.0;
  double held_top = -1.0;
  double time_at_top = 0.0;
  double last_time = 0.0;
  for (const PathRow& row : path.rows()) {
    const double height = hang(scene, 0, row, 0.0).lowest - surface;
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
  scene::Scene plain = load({});
  scene::Scene mapped = plain;
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
  scene::Scene scene = load({});
  scene.organ_pose = {rotation_from_degrees({90.0, 0.0, 0.0}), {0.5, 0.0, -0.1}};
  const ToolPath path = default_path(scene, 0);
  const Vec3 middle = middle_of(scene);
  const double surface = surface_height(scene, middle.x(), middle.y());
  EXPECT_NEAR(hang(scene, 0, path.rows().front(), 0.0).lowest, surface + 10e-3, 1e-7);
}

TEST(DefaultPath, TwoHandsComeDownSideBySide) {
  scene::Scene scene = load({});
  scene.tools.push_back(scene.tools[0]);
  scene.devices.push_back(scene.devices[0]);
  const Vec3 left = default_path(scene, 0).rows().front().position;
  const Vec3 right = default_path(scene, 1).rows().front().position;
  const Vec3 apart = right - left;
  EXPECT_GT(std::hypot(apart.x(), apart.y()), 15e-3);
  EXPECT_LE(std::hypot(apart.x(), apart.y()), 30e-3 + 1e-12);
}

TEST(DefaultPath, RefusesAnOpenOrgan) {
  scene::Scene scene = load({});
  scene.organ.triangles.pop_back();
  EXPECT_THROW((void)default_path(scene, 0), InputError);
}

constexpr int kAround = 48;
constexpr int kAcross = 24;

/// The surface of a ring: section(v) = {radial, axial} [m], revolved about z, counter-clockwise in v.
geometry::TriangleMesh ring(const std::function<std::array<double, 2>(double)>& section) {
  geometry::TriangleMesh mesh;
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const double u = 2.0 * portable::kPi * i / kAround;
      const auto [out, up] = section(2.0 * portable::kPi * j / kAcross);
      mesh.vertices.emplace_back(out * std::cos(u), out * std::sin(u), up);
      const auto at = [&](int a, int b) { return (a % kAround) * kAcross + b % kAcross; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

geometry::TriangleMesh torus(double radius, double thickness) {
  return ring([=](double v) {
    return std::array{radius + 0.5 * thickness * std::cos(v), 0.5 * thickness * std::sin(v)};
  });
}

/// An ellipsoid whose long axis follows a circle of radius `bend` [m].
geometry::TriangleMesh banana(double half_length, double half_width, double bend) {
  geometry::TriangleMesh mesh = geometry::make_ball(1.0, 1280);
  for (Vec3& v : mesh.vertices) {
    const double angle = half_length * v.x() / bend;
    const double out = bend + half_width * v.z();
    v = Vec3(out * std::sin(angle), half_width * v.y(), out * std::cos(angle) - bend);
  }
  return mesh;
}

scene::Scene press_of(const geometry::TriangleMesh& organ, const Vec3& turned_deg = Vec3::Zero(),
                      const std::string& tool = "curved-forceps") {
  Overrides request;
  request.tools = {tool};
  scene::Scene scene = load(request);
  scene.organ = organ;
  scene.organ_pose.rotation = rotation_from_degrees(turned_deg);
  return scene;
}

/// The tool at the deepest point of its path, computed by contact itself.
struct Pressed {
  std::uint32_t status_at_start = 0;
  double depth = 0.0;     // m
  double angle = 0.0;     // degrees, between the motion and the normal
  double inserted = 0.0;  // m, of a needle's shaft
};

Pressed pressed(const scene::Scene& scene, const ToolPath& path) {
  contact::Preparation how;  // several tools press each shape, which is prepared once
  use_organ_cache(how);
  const haptics::SimulationWorld world = make_world(scene, how);
  contact::State state(world.contact);
  contact::ToolResult result;
  Pressed pressed;
  for (int tick = 0; tick * 1e-3 < 0.5 * path.end_time(); ++tick) {
    const PathRow row = path.at(tick * 1e-3);
    const contact::ToolInput input{{row.orientation, row.position}, row.gripper};
    contact::advance(world.contact, scene.organ_pose, {&input, 1}, state, {&result, 1});
    if (tick == 0) pressed.status_at_start = result.status;
  }
  const Vec3 way = path.rows().front().orientation * Vec3::UnitZ();
  pressed.depth = result.depth;
  pressed.inserted = result.needle.length;
  pressed.angle = std::acos(std::min(1.0, -way.dot(result.normal_W))) * 180.0 / portable::kPi;
  return pressed;
}

/// Winding number of the surface around `p`, from the solid angles of all triangles: 1 inside, 0 outside [van
/// Oosterom and Strackee 1983].
double turns_around(const geometry::TriangleMesh& mesh, const Vec3& p) {
  double sum = 0.0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) {
      return Vec3(mesh.vertices[static_cast<std::size_t>(t[i])] - p);
    };
    const Vec3 a = corner(0);
    const Vec3 b = corner(1);
    const Vec3 c = corner(2);
    const double below =
        a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() + b.dot(c) * a.norm() + c.dot(a) * b.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)), below);
  }
  return sum / (4.0 * portable::kPi);
}

int points_inside(const scene::Scene& scene, const PathRow& row) {
  geometry::TriangleMesh organ = scene.organ;
  geometry::transform(organ, scene.organ_pose);
  const Pose handle{row.orientation, row.position};
  int inside = 0;
  for (const geometry::ToolPart& part : scene.tools[0].parts) {
    for (const Vec3& v : geometry::refine(part.mesh, 10e-3).vertices)
      inside += turns_around(organ, handle * v) > 0.5 ? 1 : 0;
  }
  return inside;
}

struct Shape {
  const char* name;
  geometry::TriangleMesh mesh;
  Vec3 turned_deg;
};

std::vector<Shape> shapes() {
  const geometry::TriangleMesh tube = ring([](double v) {
    return std::array{24e-3 + 2.5e-3 * std::cos(v), 60e-3 * std::sin(v)};
  });
  return {{"sphere", geometry::make_ball(30e-3, 1280), Vec3::Zero()},
          {"thin plate on its edge", geometry::make_box({120e-3, 120e-3, 6e-3}, 10e-3), {80.0, 0.0, 0.0}},
          {"thin plate", geometry::make_box({100e-3, 100e-3, 10e-3}, 10e-3), Vec3::Zero()},
          {"slope", geometry::make_box({120e-3, 120e-3, 30e-3}, 10e-3), {45.0, 20.0, 0.0}},
          {"torus", torus(45e-3, 32e-3), {60.0, 0.0, 0.0}},
          {"lying torus", torus(45e-3, 32e-3), Vec3::Zero()},
          {"standing thin tube", tube, Vec3::Zero()},
          {"leaning thin tube", tube, {0.0, 50.0, 0.0}},
          {"banana", banana(90e-3, 20e-3, 60e-3), {90.0, 0.0, 40.0}},
          {"hanging banana", banana(90e-3, 20e-3, 60e-3), {0.0, 90.0, 0.0}}};
}

TEST(DefaultPath, OnAnyShapeToolAndShaftStartOutsideAndAPressReachesItsDepthSquarely) {
  for (const std::string tool : {"curved-forceps", "straight-forceps"}) {
    for (const Shape& shape : shapes()) {
      SCOPED_TRACE(tool + std::string(" on a ") + shape.name);
      const scene::Scene scene = press_of(shape.mesh, shape.turned_deg, tool);
      const ToolPath path = default_path(scene, 0);
      EXPECT_EQ(points_inside(scene, path.rows().front()), 0);
      const Pressed press = pressed(scene, path);
      EXPECT_EQ(press.status_at_start & contact::kStartedInside, 0U);
      EXPECT_NEAR(press.depth, 12e-3, 0.05 * 12e-3);
      EXPECT_LT(press.angle, 20.0);
    }
  }
}

TEST(DefaultPath, ANeedleEntersAnyShapeOrTheRemarkSaysThatItIsTooThin) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    Overrides request;
    request.task = "insert";
    request.tissue = "liver-capsule";
    Scene scene = load(request);
    scene.organ = shape.mesh;
    scene.organ_pose.rotation = rotation_from_degrees(shape.turned_deg);
    if (std::string_view(shape.name).find("thin") == std::string_view::npos) {
      EXPECT_THAT(default_path_remarks(scene), testing::IsEmpty());
      EXPECT_GT(pressed(scene, default_path(scene, 0)).inserted, 3e-3);
    } else {
      EXPECT_THAT(default_path_remarks(scene), testing::ElementsAre(testing::HasSubstr("so thin")));
    }
  }
}

/// A tube that is flat only in its bore, where no instrument can press along the normal; its outside is
/// ridged.
geometry::TriangleMesh ridged_tube() {
  return ring([](double v) {
    const auto j = static_cast<int>(std::lround(v * kAcross / (2.0 * portable::kPi)));
    const double up = -60e-3 + 120e-3 * (j % (kAcross / 2)) / (kAcross / 2 - 1);
    return j < kAcross / 2 ? std::array{40e-3 + (j % 2 == 0 ? 8e-3 : -8e-3), up} : std::array{15e-3, -up};
  });
}

TEST(DefaultPath, NoToolStartsInsideAnOrganThatIsFlatOnlyWhereItCannotGetTo) {
  const scene::Scene scene = press_of(ridged_tube(), {90.0, 0.0, 0.0});
  const ToolPath path = default_path(scene, 0);
  EXPECT_EQ(points_inside(scene, path.rows().front()), 0);
}

TEST(DefaultPath, AnOrganTooCurvedForItsDepthIsPressedLessDeepAndThatIsReported) {
  const scene::Scene scene = press_of(torus(40e-3, 12e-3));
  const ToolPath path = default_path(scene, 0);
  const double way = (path.at(0.5 * path.end_time()).position - path.rows().front().position).norm();
  const double depth = way - 10e-3;
  EXPECT_GE(depth, 3e-3);
  EXPECT_LT(depth, 6.5e-3);  // half of its section: deeper inside, another side is nearer
  const Pressed press = pressed(scene, path);
  EXPECT_NEAR(press.depth, depth, 0.05 * depth);
  EXPECT_LT(press.angle, 20.0);
  EXPECT_THAT(
      default_path_remarks(scene),
      testing::ElementsAre(testing::HasSubstr("the path presses " + brief(depth * 1e3, 3) + " mm deep")));
}

TEST(DefaultPath, AnOrganThatIsPressedLessDeepIsPressedFromAboveItsMiddleWhereThatIsGood) {
  const scene::Scene scene = press_of(geometry::make_ball(12e-3, 5120));
  const ToolPath path = default_path(scene, 0);
  EXPECT_THAT(default_path_remarks(scene), testing::ElementsAre(testing::HasSubstr("mm deep")));
  for (const PathRow& row : {path.rows().front(), path.at(0.5 * path.end_time())})
    EXPECT_LT((row.orientation * Vec3::UnitZ() + Vec3::UnitZ()).norm(), 1e-9);
}

/// Adds six triangles without area around each triangle.
geometry::TriangleMesh with_flat_triangles(const geometry::TriangleMesh& mesh) {
  geometry::TriangleMesh result{mesh.vertices, {}};
  for (const geometry::Triangle& t : mesh.triangles) {
    const auto inner = static_cast<std::int32_t>(result.vertices.size());
    for (const std::int32_t v : t) result.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
    result.triangles.push_back({inner, inner + 1, inner + 2});
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const std::int32_t a = t[static_cast<std::size_t>(k)];
      const std::int32_t b = t[static_cast<std::size_t>(next)];
      result.triangles.push_back({a, b, inner + next});
      result.triangles.push_back({a, inner + next, inner + k});
    }
  }
  return result;
}

TEST(DefaultPath, TrianglesWithoutAreaHideNothingOfTheSurfaceBeyondThem) {
  const geometry::TriangleMesh ball = geometry::make_ball(12e-3, 1280);
  const std::vector<std::string> plain = default_path_remarks(press_of(ball));
  ASSERT_EQ(plain.size(), 1U);
  EXPECT_EQ(default_path_remarks(press_of(with_flat_triangles(ball))), plain);
}

/// Two plates, one above the other with a gap of 20 mm: a needle stays in the upper one.
TEST(DefaultPath, ANeedleStaysInTheFirstTissueBelowAndAShallowPathIsReported) {
  for (const double thick : {40e-3, 10e-3}) {
    Overrides request;
    request.task = "insert";
    Scene scene = load(request);
    scene.organ = geometry::make_box({100e-3, 100e-3, thick}, 50e-3);
    geometry::TriangleMesh lower = scene.organ;
    const auto count = static_cast<std::int32_t>(scene.organ.vertices.size());
    for (const Vec3& vertex : lower.vertices) {
      scene.organ.vertices.emplace_back(vertex - (thick + 20e-3) * Vec3::UnitZ());
    }
    for (const geometry::Triangle& t : lower.triangles) {
      scene.organ.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
    }
    const ToolPath path = default_path(scene, 0);
    double lowest = std::numeric_limits<double>::infinity();
    for (const PathRow& row : path.rows()) lowest = std::min(lowest, hang(scene, 0, row, 0.0).lowest);
    EXPECT_NEAR(0.5 * thick - lowest, 0.7 * thick, 1e-3);
    const std::vector<std::string> remarks = default_path_remarks(scene);
    if (thick < 20e-3) {
      EXPECT_THAT(remarks, testing::ElementsAre(testing::HasSubstr("the needle goes only 7 mm deep")));
    } else {
      EXPECT_THAT(remarks, testing::IsEmpty());
    }
  }
}

TEST(DefaultPath, AShortNeedleKeepsItsHubOutAndThatIsReported) {
  for (const std::string scene_text : {"", "[target]\nlayer = \"muscle\"\n"}) {
    Overrides request;
    request.scene_text = {"[scene]\ntask = \"insert\"\n[organ]\nmesh = \"box\"\n" + scene_text +
                              "[tool]\nmesh = \"needle:18G,10,bevel\"\n",
                          {}};
    const Scene scene = load(request);
    EXPECT_THAT(default_path_remarks(scene), testing::ElementsAre(testing::HasSubstr("needle is so short")));
    const Pressed press = pressed(scene, default_path(scene, 0));
    EXPECT_GT(press.inserted, 7e-3);
    EXPECT_LT(press.inserted, 10e-3);
  }
}

TEST(DefaultPath, HowThinAnOrganIsUnderThePressIsReported) {
  const scene::Scene scene = press_of(geometry::make_box({120e-3, 120e-3, 6e-3}, 10e-3));
  EXPECT_THAT(default_path_remarks(scene),
              testing::ElementsAre(testing::HasSubstr(
                  "the organ is 6 mm thick where the default path presses it 12 mm deep")));
}

TEST(DefaultPath, NothingIsReportedForAThickOrganOrOfAPathFromAFile) {
  EXPECT_THAT(default_path_remarks(load({})), testing::IsEmpty());
  scene::Scene scene = press_of(torus(40e-3, 12e-3));
  scene.devices[0].path = "press.csv";
  EXPECT_THAT(default_path_remarks(scene), testing::IsEmpty());
}

}  // namespace
}  // namespace palpate::scene
