// The prepared organ surface and the sampled tool points.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/contact/contact_patch.h"
#include "core/contact/organ_surface.h"
#include "core/contact/test/rig.h"
#include "palpate/error.h"

namespace palpate::contact {
namespace {

constexpr double kSurfaceReference = 10e-3;

SurfacePoint nearest(const OrganSurface& surface, const Vec3& p) {
  const geometry::NearestPoint found = surface.nearest(p, -1);
  return {found.point, found.triangle};
}

TEST(OrganSurface, NormalsOfABallDoNotShowItsMesh) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const int triangles : {320, 1280, 5120}) {
    const OrganSurface surface(geometry::make_ball(20e-3, triangles), kSurfaceReference);
    for (int i = 0; i < 500; ++i) {
      const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
      const Vec3 found = surface.normal_at(nearest(surface, 20e-3 * direction));
      EXPECT_NEAR(found.norm(), 1.0, 1e-12);
      EXPECT_GT(found.dot(direction), std::cos(0.02)) << triangles;
    }
  }
}

TEST(OrganSurface, AFlatFaceHasItsOwnNormalUpToTheBlend) {
  const OrganSurface surface(test::block(Vec3(60e-3, 60e-3, 20e-3), 0.1), kSurfaceReference);
  EXPECT_LT((surface.normal_at(nearest(surface, Vec3(28.9e-3, 0, 0))) - Vec3::UnitZ()).norm(), 1e-9);
  EXPECT_LT((surface.normal_at(nearest(surface, Vec3(0, 0, 1e-3))) - Vec3::UnitZ()).norm(), 1e-9);
}

TEST(OrganSurface, AcrossAnEdgeTheTwoSidesBlendByTheSquareOfTheDistance) {
  const OrganSurface surface(test::block(Vec3(60e-3, 60e-3, 20e-3), 0.1), kSurfaceReference);
  for (const double distance : {0.0, 0.25e-3, 0.5e-3, 0.75e-3}) {
    const double share = (1.0 - distance / 1e-3) * (1.0 - distance / 1e-3);
    const Vec3 expected = Vec3(share, 0.0, 1.0).normalized();
    const Vec3 found = surface.normal_at(nearest(surface, Vec3(30e-3 - distance, 3e-3, 0.0)));
    EXPECT_LT((found - expected).norm(), 1e-6) << distance;
  }
}

TEST(OrganSurface, AThinPlatesOtherSideHasNoSayInTheNormal) {
  const OrganSurface surface(test::block(Vec3(60e-3, 60e-3, 1.5e-3), 0.1), kSurfaceReference);
  EXPECT_LT((surface.normal_at(nearest(surface, Vec3(3e-3, 2e-3, 0))) - Vec3::UnitZ()).norm(), 1e-9);
}

TEST(OrganSurface, AWalkOnABallGoesItsLengthAndStaysOnTheSurface) {
  const OrganSurface surface(geometry::make_ball(20e-3, 5120), kSurfaceReference);
  SurfacePoint here = nearest(surface, Vec3(0, 0, 20e-3));
  const Vec3 start = here.point;
  for (int i = 0; i < 200; ++i) {  // 10 mm towards +x
    const Vec3 normal = surface.normal_at(here);
    Vec3 along = Vec3::UnitX() - normal.x() * normal;
    here = surface.walk(here, 0.05e-3 * along.normalized(), normal);
    EXPECT_NEAR(surface.nearest(here.point, here.triangle).distance, 0.0, 1e-9);
  }
  const double angle = std::acos(here.point.normalized().dot(start.normalized()));
  EXPECT_NEAR(angle * 20e-3, 10e-3, 0.1e-3);
  EXPECT_NEAR(here.point.y(), 0.0, 0.2e-3);
}

TEST(OrganSurface, AWalkOverAnEdgeGoesDownTheOtherSide) {
  const OrganSurface surface(test::block(Vec3(60e-3, 60e-3, 20e-3), 0.1), kSurfaceReference);
  const SurfacePoint start = nearest(surface, Vec3(29e-3, 0.3e-3, 0));
  const SurfacePoint end = surface.walk(start, Vec3(3e-3, 0, 0), Vec3::UnitZ());
  EXPECT_LT((end.point - Vec3(30e-3, 0.3e-3, -2e-3)).norm(), 1e-9);
}

TEST(ToolPoints, AreNeverFartherApartThanTwoMillimetresAndKeepTheMeshsVertices) {
  geometry::ToolPart part;
  part.mesh = geometry::make_box(Vec3(4e-3, 4e-3, 100e-3), 1.0);  // long triangles, like those of a shaft
  const PartPoints points = sample_part(part, 0.0);
  double area = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) area += points.area[i];
  EXPECT_NEAR(area, 2.0 * 4e-3 * 4e-3 + 4.0 * 4e-3 * 100e-3, 1e-9);
  const auto nearest_to = [&](const Vec3& p) {
    double best = 1.0;
    for (std::size_t i = 0; i < points.size(); ++i) best = std::min(best, (points.point(i) - p).norm());
    return best;
  };
  for (const Vec3& vertex : part.mesh.vertices) EXPECT_EQ(nearest_to(vertex), 0.0);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> along(-50e-3, 50e-3);
  for (int i = 0; i < 200; ++i) EXPECT_LT(nearest_to(Vec3(2e-3, 1e-3, along(random))), 2e-3);
}

TEST(ToolPoints, KnowTheRadiusOfABallAndTheWidthOfABar) {
  geometry::ToolPart ball;
  ball.mesh = geometry::make_ball(3e-3, 1280);
  const PartPoints of_ball = sample_part(ball, 0.0);
  for (std::size_t i = 0; i < of_ball.size(); ++i) {
    EXPECT_NEAR(of_ball.tip_radius[i], 3e-3, 0.6e-3);
    EXPECT_NEAR(of_ball.half_width[i], 3e-3, 0.3e-3);
  }
  geometry::ToolPart bar;
  bar.mesh = geometry::make_box(Vec3(4e-3, 40e-3, 4e-3), 1e-3);
  const PartPoints of_bar = sample_part(bar, 0.0);
  for (std::size_t i = 0; i < of_bar.size(); ++i) {
    if ((of_bar.point(i) - Vec3(0, 0, 2e-3)).norm() < 0.1e-3) {
      EXPECT_NEAR(of_bar.half_width[i], 2e-3, 0.2e-3);
    }
  }
  EXPECT_EQ(sample_part(ball, 1e-3).tip_radius.front(), 1e-3);  // given by the user
}

TEST(ToolPoints, WithoutTrianglesAreRefused) { EXPECT_THROW((void)sample_part({}, 0.0), InputError); }

TEST(ContactPatch, IsTheDeepestPointAndTheWeightedMeanOfTheBand) {
  geometry::ToolPart part;
  part.mesh = geometry::make_ball(3e-3, 5120);
  const PartPoints points = sample_part(part, 0.0);
  const ContactPatch patch =
      contact_patch_of(points, Vec3(0.5e-3, 0, -2e-3), Vec3::UnitZ(), kSurfaceReference);
  double deepest = 0.0;  // of the points, which are fewer than the ball's vertices
  for (std::size_t i = 0; i < points.size(); ++i) deepest = std::max(deepest, -2e-3 - points.z[i]);
  EXPECT_NEAR(patch.depth, deepest, 1e-12);
  EXPECT_NEAR(deepest, 1e-3, 0.02e-3);
  EXPECT_LT((patch.centroid - Vec3(0, 0, -3e-3)).norm(), 0.15e-3);
}

TEST(ContactPatch, LeavesOutWhatIsFartherThanTheReferenceRadiusFromTheAxis) {
  geometry::ToolPart part;
  part.mesh = geometry::make_box(Vec3(40e-3, 4e-3, 4e-3), 1e-3);
  geometry::transform(part.mesh,
                      Pose{rotation_from_degrees(Vec3(0, 30, 0)), Vec3::Zero()});  // one end is lower
  const PartPoints points = sample_part(part, 0.0);
  double brute = 0.0;
  const Vec3 at(0, 0, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double rho = std::hypot(points.x[i], points.y[i]);
    const double t = std::clamp((rho - 5e-3) / 5e-3, 0.0, 1.0);
    brute = std::max(brute, -points.z[i] * (1.0 - t * t * (3.0 - 2.0 * t)));
  }
  EXPECT_NEAR(contact_patch_of(points, at, Vec3::UnitZ(), kSurfaceReference).depth, brute, 1e-12);
  EXPECT_LT(brute, 6e-3);
}

TEST(ContactPatch, OfNothingBehindThePlaneIsZero) {
  geometry::ToolPart part;
  part.mesh = geometry::make_ball(3e-3, 320);
  const PartPoints points = sample_part(part, 0.0);
  EXPECT_EQ(contact_patch_of(points, Vec3(0, 0, -3.1e-3), Vec3::UnitZ(), kSurfaceReference).depth, 0.0);
}

}  // namespace
}  // namespace palpate::contact
