#include "core/deform/deformed_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "core/deform/test/plain_surface.h"
#include "core/deform/test/reordered.h"
#include "core/deform/triangle_search.h"
#include "io/mesh_io/repair/crossings.h"
#include "palpate/mesh.h"
#include "palpate/surface.h"

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

constexpr double kBall = 0.03;  // m
constexpr double kRounding = 0.2;

Indentation press_at(const Vec3& direction_out, double depth) {
  return {kBall * direction_out, -direction_out, depth, 0.003, 0.0};
}

Indentation top_press(double depth) { return press_at(Vec3::UnitZ(), depth); }

// The reference result.
std::vector<Vec3> plain(const geometry::TriangleMesh& mesh, std::span<const Indentation> indentations) {
  return test::PlainDeformer(mesh).deformed({}, indentations, kRounding);
}

double largest_difference(const DeformedSurface& surface, const std::vector<Vec3>& expected) {
  double largest = 0.0;
  for (std::size_t v = 0; v < expected.size(); ++v)
    largest = std::max(largest, (surface.vertices()[v].position.cast<double>() - expected[v]).norm());
  return largest;
}

Vec3 area(const DeformedSurface& surface, const geometry::Triangle& t) {
  const auto at = [&](int k) {
    return Vec3(
        surface.vertices()[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])].position.cast<double>());
  };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

// Number of triangles that face away from their vertices' normals, as in folds narrower than a triangle. In
// larger folds the normals turn over too; crossings() counts those.
int turned_over(const DeformedSurface& surface) {
  int count = 0;
  for (const geometry::Triangle& t : surface.rest().triangles) {
    Vec3 normal = Vec3::Zero();
    for (const std::int32_t v : t)
      normal += surface.vertices()[static_cast<std::size_t>(v)].normal.cast<double>();
    count += area(surface, t).dot(normal) > 0.0 ? 0 : 1;
  }
  return count;
}

// Number of pairs of triangles that intersect.
std::size_t crossings(const DeformedSurface& surface) {
  geometry::TriangleMesh moved = surface.rest();
  for (std::size_t v = 0; v < moved.vertices.size(); ++v)
    moved.vertices[v] = surface.vertices()[v].position.cast<double>();
  return mesh_io::find_crossings(moved).pairs.size();
}

TEST(DeformedSurface, MovesAsThePlainFormDoesToTwoPercentOfTheDepth) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 20480);
  DeformedSurface surface(ball, {}, kRounding);
  std::vector<Indentation> pull = {top_press(0.008)};
  pull[0].direction = Vec3(0.5, 0.0, 0.8).normalized();
  for (const std::vector<Indentation>& contacts :
       {std::vector{top_press(0.008)}, pull,
        std::vector{top_press(0.006), press_at(Vec3(0.3, 0.1, 1.0).normalized(), 0.008)}}) {
    surface.update(contacts, DeformedSurface::kSettle);
    EXPECT_LT(largest_difference(surface, plain(ball, contacts)), 0.02 * 0.008);
  }
}

TEST(DeformedSurface, IsAtItsDepthUnderTheContact) {
  DeformedSurface surface(geometry::make_ball(kBall, 20480), {}, kRounding);
  surface.update(std::vector{top_press(0.010)}, DeformedSurface::kSettle);
  float lowest = 1.0F;
  for (const SurfaceVertex& v : surface.vertices())
    if (std::hypot(v.position.x(), v.position.y()) < 1e-4F && v.position.z() > 0.0F)
      lowest = std::min(lowest, v.position.z());
  EXPECT_NEAR(lowest, 0.020, 0.0001);
}

TEST(DeformedSurface, ComesToTheSameWithinSomePicturesAsAtOnce) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 20480);
  DeformedSurface surface(ball, {}, kRounding);
  const std::vector contacts = {top_press(0.008)};
  surface.update(contacts, 200);
  EXPECT_TRUE(surface.growing());
  int pictures = 1;
  for (; surface.growing() && pictures < 200; ++pictures) surface.update(contacts, 200);
  EXPECT_GT(pictures, 3);
  EXPECT_LT(largest_difference(surface, plain(ball, contacts)), 0.02 * 0.008);
}

// The mesh with its vertices ordered by cubes of 4 mm, similar to the order in pictures.
geometry::TriangleMesh ordered_by_place(const geometry::TriangleMesh& mesh) {
  const auto cube = [&mesh](std::size_t v) {
    const Vec3 p = mesh.vertices[v] / 0.004;
    return std::array{std::floor(p.z()), std::floor(p.y()), std::floor(p.x())};
  };
  std::vector<std::size_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&cube](std::size_t a, std::size_t b) { return cube(a) < cube(b); });
  return reordered(mesh, order);
}

TEST(DeformedSurface, WhileItMovesLittleNoVertexIsOffByATwentiethOfAMillimetre) {
  const geometry::TriangleMesh ball = ordered_by_place(geometry::make_ball(kBall, 20480));
  DeformedSurface moving(ball, {}, kRounding);
  DeformedSurface settled(ball, {}, kRounding);
  std::size_t changed = 0;
  for (int i = 1; i <= 60; ++i) {
    // Two contacts that indent and withdraw by 0.1 mm per frame, the second one later.
    const double depth = 0.0001 * std::min(i, 80 - i);
    const std::vector contacts = {top_press(depth),
                                  press_at(Vec3(0.5, 0.2, 1.0).normalized(), depth - 0.001)};
    moving.update(contacts, 1'000'000);
    settled.update(contacts, DeformedSurface::kSettle);
    for (const DeformedSurface::Range& range : moving.take_changes()) changed += i > 30 ? range.count : 0;
    for (std::size_t v = 0; v < ball.vertices.size(); ++v) {
      const SurfaceVertex& a = moving.vertices()[v];
      const SurfaceVertex& b = settled.vertices()[v];
      ASSERT_LT((a.position - b.position).norm(), 0.00005F) << i << " " << v;
      ASSERT_GT(a.normal.dot(b.normal), 0.9998F) << i << " " << v;  // 1.1 degrees
    }
  }
  EXPECT_LT(changed, 30 * ball.vertices.size() / 3);
}

TEST(DeformedSurface, FollowsAContactThatSlidesWithoutWaitingForItsFront) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 20480);
  DeformedSurface surface(ball, {}, kRounding);
  surface.update(std::vector{top_press(0.006)}, DeformedSurface::kSettle);
  std::vector<Indentation> slid;
  for (int i = 1; i <= 12; ++i) {
    const double a = 0.02 * i;  // 0.6 mm per frame
    slid = {press_at(Vec3(std::sin(a), 0.0, std::cos(a)), 0.006)};
    surface.update(slid, 100);
  }
  EXPECT_LT(largest_difference(surface, plain(ball, slid)), 0.0002);
}

TEST(DeformedSurface, TurnsNoTriangleOverAndCrossesItselfNowhere) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 20480);
  DeformedSurface surface(ball, {}, kRounding);
  Indentation sideways = top_press(0.010);
  sideways.direction = Vec3(0.9, 0.0, -0.3).normalized();
  Indentation pull = press_at(Vec3::UnitX(), 0.010);
  pull.direction = Vec3::UnitX();
  Indentation beside = press_at(Vec3(0.15, 0.0, 1.0).normalized(), 0.008);  // the second jaw
  beside.direction = -Vec3::UnitZ();
  for (const std::vector<Indentation>& contacts :
       {std::vector{top_press(0.012)}, std::vector{sideways}, std::vector{pull},
        std::vector{top_press(0.010), beside}}) {
    surface.update(contacts, DeformedSurface::kSettle);
    EXPECT_EQ(turned_over(surface), 0);
    EXPECT_EQ(crossings(surface), 0U) << contacts[0].direction.transpose();
  }
}

TEST(DeformedSurface, TheCrestBetweenTwoDeepPressesThatConvergeDoesNotFold) {
  DeformedSurface surface(geometry::make_ball(kBall, 20480), {}, kRounding);
  for (const double apart : {0.2, 0.3, 0.4, 0.5, 0.6}) {  // rad: 6 to 18 mm
    for (const auto& [a, b] : {std::pair{0.010, 0.010}, {0.012, 0.007}, {0.008, 0.008}}) {
      surface.update(std::vector{press_at(Vec3(std::sin(apart), 0.1, std::cos(apart)).normalized(), a),
                                 press_at(Vec3(0.0, 0.1, 1.0).normalized(), b)},
                     DeformedSurface::kSettle);
      EXPECT_EQ(turned_over(surface), 0) << apart << " rad, " << a << " and " << b << " m";
      EXPECT_EQ(crossings(surface), 0U) << apart << " rad, " << a << " and " << b << " m";
    }
  }
}

TEST(DeformedSurface, TwoPressesFromBothSidesOfASlabDoNotMeet) {
  // 8 mm thick, 6 mm from each side: alone each is limited to 5.8 mm only.
  DeformedSurface surface(geometry::make_box(Vec3(0.06, 0.06, 0.008), 0.001), {}, kRounding);
  const Indentation above{Vec3(0, 0, 0.004), -Vec3::UnitZ(), 0.006, 0.003, 0.0};
  // Slightly inclined: otherwise edges of upright columns of vertices touch exactly, which is no
  // intersection.
  const Indentation below{Vec3(0, 0, -0.004), Vec3(0.05, 0.03, 1.0).normalized(), 0.006, 0.003, 0.0};
  surface.update(std::vector{above, below}, DeformedSurface::kSettle);
  float top = 1.0F;
  float bottom = -1.0F;
  for (std::size_t v = 0; v < surface.vertices().size(); ++v) {
    const float z = surface.vertices()[v].position.z();
    if (surface.rest_vertices()[v].z() > 0.0039F) top = std::min(top, z);
    if (surface.rest_vertices()[v].z() < -0.0039F) bottom = std::max(bottom, z);
  }
  EXPECT_GT(top, bottom + 0.0007F);
  EXPECT_EQ(turned_over(surface), 0);
  EXPECT_EQ(crossings(surface), 0U);
}

TEST(DeformedSurface, ItsNormalsAreThoseOfItsTriangles) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 81920);
  DeformedSurface surface(ball, {}, kRounding);
  for (const std::vector<Indentation>& contacts :
       {std::vector{top_press(0.010)},
        std::vector{top_press(0.006), press_at(Vec3(0.3, 0.0, 1.0).normalized(), 0.008)}}) {
    surface.update(contacts, DeformedSurface::kSettle);
    std::vector<Vec3> sums(ball.vertices.size(), Vec3::Zero());
    for (const geometry::Triangle& t : ball.triangles)
      for (const std::int32_t v : t) sums[static_cast<std::size_t>(v)] += area(surface, t);
    double mean = 0.0;
    for (const std::int32_t v : surface.moved()) {
      const auto i = static_cast<std::size_t>(v);
      mean += std::acos(std::min(1.0, sums[i].normalized().dot(surface.vertices()[i].normal.cast<double>())));
    }
    ASSERT_GT(surface.moved().size(), 1000U);
    EXPECT_LT(mean / static_cast<double>(surface.moved().size()), 0.02);  // rad
  }
}

TEST(DeformedSurface, TouchesOnlyWhatIsInReachAndPutsItBack) {
  DeformedSurface surface(geometry::make_ball(kBall, 20480), {}, kRounding);
  (void)surface.take_changes();
  surface.update(std::vector{top_press(0.0005)}, DeformedSurface::kSettle);
  std::size_t changed = 0;
  for (const DeformedSurface::Range& range : surface.take_changes()) changed += range.count;
  EXPECT_GT(changed, 0U);
  EXPECT_LT(surface.moved().size(), surface.vertices().size() / 4);
  for (const std::int32_t v : surface.moved())
    EXPECT_GT(surface.vertices()[static_cast<std::size_t>(v)].position.z(), 0.0F);
  surface.update({}, DeformedSurface::kSettle);
  EXPECT_TRUE(surface.moved().empty());
  EXPECT_EQ(largest_difference(surface, plain(surface.rest(), {})),
            largest_difference(DeformedSurface(surface.rest(), {}, kRounding), plain(surface.rest(), {})));
  EXPECT_FALSE(surface.take_changes().empty());
  surface.update({}, DeformedSurface::kSettle);
  EXPECT_TRUE(surface.take_changes().empty());
}

TEST(DeformedSurface, TheChangesCoverEveryVertexThatMoved) {
  DeformedSurface surface(geometry::make_ball(kBall, 5120), {}, kRounding);
  (void)surface.take_changes();
  std::vector<SurfaceVertex> shown(surface.vertices().begin(), surface.vertices().end());
  for (int i = 0; i < 6; ++i) {
    const double a = 0.3 * i;
    surface.update(std::vector{press_at(Vec3(std::sin(a), 0.0, std::cos(a)), 0.004)}, 150);
    for (const DeformedSurface::Range& range : surface.take_changes())
      for (std::size_t v = range.first; v < range.first + range.count; ++v) shown[v] = surface.vertices()[v];
    for (std::size_t v = 0; v < shown.size(); ++v)
      ASSERT_EQ(shown[v].position, surface.vertices()[v].position) << i << " " << v;
  }
}

TEST(DeformedSurface, LeavesTheFarSideOfAThinOrganStill) {
  DeformedSurface surface(geometry::make_box(Vec3(0.06, 0.06, 0.006), 0.001), {}, kRounding);
  surface.update(std::vector{Indentation{Vec3(0, 0, 0.003), -Vec3::UnitZ(), 0.003, 0.003, 0.0}},
                 DeformedSurface::kSettle);
  for (const std::int32_t v : surface.moved())
    EXPECT_GT(surface.vertices()[static_cast<std::size_t>(v)].position.z(), -0.0029F);
}

// A front that went farther has found shorter paths to near vertices behind obtuse triangles.
TEST(DeformedSurface, SettlesAfterADeeperPressToWhatAShallowOneComesToAlone) {
  geometry::TriangleMesh mesh = geometry::make_box(Vec3(0.12, 0.12, 0.03), 0.004);
  for (Vec3& vertex : mesh.vertices) vertex.x() += 3.0 * vertex.y();  // sheared: all obtuse
  const auto press = [](double depth) {
    return std::vector{Indentation{Vec3(0.001, 0.0005, 0.015), -Vec3::UnitZ(), depth, 0.003, 0.0}};
  };
  DeformedSurface alone(mesh, {}, kRounding);
  alone.update(press(0.002), DeformedSurface::kSettle);
  DeformedSurface after(mesh, {}, kRounding);
  after.update(press(0.009), DeformedSurface::kSettle);
  after.update(press(0.002), DeformedSurface::kSettle);
  ASSERT_GT(alone.moved().size(), 50U);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    ASSERT_EQ(after.vertices()[v].position, alone.vertices()[v].position) << v;
}

TEST(DeformedSurface, AMeshWithoutTrianglesStaysAsItIs) {
  DeformedSurface surface(geometry::TriangleMesh{}, {}, kRounding);
  surface.update(std::vector{top_press(0.01)}, DeformedSurface::kSettle);
  EXPECT_TRUE(surface.moved().empty());
  EXPECT_TRUE(surface.near(0, 1.0).empty());
  EXPECT_TRUE(surface.near(7, 1.0).empty());
}

TEST(TriangleSearch, FindsWhatASearchOfAllTrianglesFinds) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 1280);
  const TriangleSearch grid(ball);
  const test::PlainGeodesic all(ball);
  for (int i = 0; i < 200; ++i) {
    const double a = 0.7 * i;
    const Vec3 p = (0.01 + 0.0005 * i) * Vec3(std::cos(a), std::sin(a), std::cos(2.3 * a));
    EXPECT_NEAR((grid.nearest(p).point - p).norm(), (all.nearest(p).point - p).norm(), 1e-12) << i;
  }
}

TEST(TriangleSearch, FindsTheFarSideWithinTheLimitOnly) {
  const geometry::TriangleMesh box = geometry::make_box(Vec3(0.04, 0.04, 0.02), 0.002);
  const TriangleSearch grid(box);
  const Vec3 top(0.0003, 0.0007, 0.01);
  EXPECT_NEAR(grid.far_side(top, -Vec3::UnitZ(), 0.05), 0.02, 1e-9);
  EXPECT_TRUE(std::isinf(grid.far_side(top, -Vec3::UnitZ(), 0.019)));
  EXPECT_TRUE(std::isinf(grid.far_side(top, Vec3::UnitZ(), 0.05)));
}

std::shared_ptr<const OrganResponse> ball_on_bed() {
  geometry::Support support;
  support.bed = geometry::Bed{-Vec3::UnitZ(), 0.3};
  return prepare_response(geometry::make_ball(kBall, 5000), support);
}

TEST(WholeOrgan, MovesAlikeInStepsAndAtOnce) {
  const auto response = ball_on_bed();
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 20000);
  DeformedSurface live(ball, {}, kRounding);
  live.set_response(response);
  DeformedSurface still(ball, {}, kRounding);
  still.set_response(response);
  for (int frame = 0; frame < 40; ++frame) {
    const double turn = frame < 20 ? 0.0 : 0.01 * (frame - 20);
    const Indentation press = press_at(Vec3(std::sin(turn), 0.0, std::cos(turn)), 1e-4 * (frame + 1));
    live.update({&press, 1}, 2000);
    still.update({&press, 1}, DeformedSurface::kSettle);
    float apart = 0.0F;
    for (std::size_t v = 0; v < ball.vertices.size(); ++v)
      apart = std::max(apart, (live.vertices()[v].position - still.vertices()[v].position).norm());
    ASSERT_LT(apart, 0.05e-3F) << frame;
  }
}

TEST(WholeOrgan, ComesBackToRestBitForBit) {
  DeformedSurface surface(geometry::make_ball(kBall, 5000), {}, kRounding);
  surface.set_response(ball_on_bed());
  const Indentation press = top_press(4e-3);
  surface.update({&press, 1}, 2000);
  EXPECT_GT(surface.moved().size(), surface.vertices().size() / 2);
  surface.update({}, 2000);
  EXPECT_TRUE(surface.moved().empty());
}

TEST(WholeOrgan, ItsNormalsAreThoseOfTheDisplacedTriangles) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 20000);
  DeformedSurface surface(ball, {}, kRounding);
  surface.set_response(ball_on_bed());
  const Indentation press = top_press(4e-3);
  surface.update({&press, 1}, DeformedSurface::kSettle);
  std::vector<double> degrees;
  for (const geometry::Triangle& t : surface.rest().triangles) {
    Vec3 normal = Vec3::Zero();
    for (const std::int32_t v : t)
      normal += surface.vertices()[static_cast<std::size_t>(v)].normal.cast<double>();
    degrees.push_back(std::acos(std::min(1.0, normal.normalized().dot(area(surface, t).normalized()))) *
                      57.3);
  }
  std::sort(degrees.begin(), degrees.end());
  EXPECT_LT(degrees[degrees.size() * 99 / 100], 3.0);
  EXPECT_LT(degrees.back(), 20.0);  // at the rim of the dent, across a triangle
}

TEST(WholeOrgan, ADeepPressWithAThinToolMakesAFunnelAndNotAShaft) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 20000);
  DeformedSurface surface(ball, {}, kRounding);
  surface.set_response(ball_on_bed());
  Indentation press = top_press(12e-3);
  press.tip_radius = 1.5e-3;
  surface.update({&press, 1}, DeformedSurface::kSettle);
  double steepest = 0.0;  // angle between a triangle and its rest [degrees]
  for (const geometry::Triangle& t : surface.rest().triangles) {
    const Vec3 rest = geometry::area_vector_doubled(surface.rest(), t).normalized();
    steepest =
        std::max(steepest, std::acos(std::clamp(rest.dot(area(surface, t).normalized()), -1.0, 1.0)) * 57.3);
  }
  EXPECT_LT(steepest, 68.0);
}

TEST(WholeOrgan, AResponseThatIsTakenAwayDuringAContactLeavesTheProfile) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 5000);
  const Indentation press = top_press(4e-3);
  DeformedSurface profile(ball, {}, kRounding);
  DeformedSurface surface(ball, {}, kRounding);
  surface.set_response(ball_on_bed());
  for (int frame = 0; frame < 3; ++frame) surface.update({&press, 1}, 4000);
  surface.set_response(nullptr);
  for (int frame = 0; frame < 3; ++frame) surface.update({&press, 1}, 4000);
  for (int frame = 0; frame < 6; ++frame) profile.update({&press, 1}, 4000);
  float apart = 0.0F;
  for (std::size_t v = 0; v < ball.vertices.size(); ++v)
    apart = std::max(apart, (surface.vertices()[v].position - profile.vertices()[v].position).norm());
  EXPECT_LT(apart, 0.1e-3F);
}

TEST(WholeOrgan, AResponseThatArrivesDuringAContactFadesIn) {
  const geometry::TriangleMesh ball = geometry::make_ball(kBall, 5000);
  DeformedSurface surface(ball, {}, kRounding);
  const Indentation press = top_press(4e-3);
  surface.update({&press, 1}, 4000);
  surface.set_response(ball_on_bed());
  std::vector<Vector3f> before;
  for (const SurfaceVertex& v : surface.vertices()) before.push_back(v.position);
  for (int frame = 0; frame <= DeformedSurface::kFadeUpdates; ++frame) {
    surface.update({&press, 1}, 4000);
    float step = 0.0F;
    for (std::size_t v = 0; v < before.size(); ++v) {
      step = std::max(step, (surface.vertices()[v].position - before[v]).norm());
      before[v] = surface.vertices()[v].position;
    }
    EXPECT_LT(step, 0.5e-3F) << frame;
  }
  EXPECT_FALSE(surface.growing());
}

}  // namespace
}  // namespace palpate::deform
