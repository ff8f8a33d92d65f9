#include "tools/make_shapes/remesh.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "io/shapes/test/shape_checks.h"
#include "palpate/error.h"

#include "tools/make_shapes/field_arithmetic.h"
#include "tools/make_shapes/forceps.h"
#include "tools/make_shapes/implicit.h"
#include "tools/make_shapes/tube.h"

namespace palpate::geometry {
namespace {

class Ball final : public ImplicitSolid {
 public:
  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept override {
    const double distance = p.norm();
    return {distance - 0.03, distance > 0.0 ? Vec3(p / distance) : Vec3::UnitX()};
  }
};
const Bounds kAroundBall{Vec3::Constant(-0.0401), Vec3::Constant(0.0399)};

/// Compares a field's gradient with central differences.
template <typename Field>
void expect_gradient_fits(const Field& field, const Vec3& p, double tolerance) {
  constexpr double kStep = 1e-5;
  const FieldValue here = field(p);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vec3 step = kStep * Vec3::Unit(k);
    const double slope = (field(p + step).value - field(p - step).value) / (2.0 * kStep);
    EXPECT_NEAR(here.gradient[k], slope, tolerance) << "axis " << k << " at " << p.transpose();
  }
}

TEST(Implicit, BlendsAreExactAwayFromTheSeamAndMeetInTheMiddle) {
  const FieldValue a{1.0, Vec3::UnitX()};
  const FieldValue b{2.0, Vec3::UnitY()};
  EXPECT_DOUBLE_EQ(unite(a, b, 0.5).value, 1.0);
  EXPECT_DOUBLE_EQ(unite(a, a, 0.8).value, 1.0 - 0.8 / 6.0);  // blend/6 lower on the seam
  EXPECT_DOUBLE_EQ(unite(a, b, 2.0).value, 1.0 - 2.0 * 0.125 / 6.0);
  EXPECT_DOUBLE_EQ(intersect(a, b, 0.5).value, 2.0);
  EXPECT_DOUBLE_EQ(subtract(a, b, 0.5).value, 1.0);
  EXPECT_DOUBLE_EQ(subtract(b, {-3.0, Vec3::UnitX()}, 0.5).value, 3.0);
}

TEST(Implicit, FurrowIsDeepestOnTheSeamAndGoneAtItsWidth) {
  const FieldValue a{1.0, Vec3::UnitX()};
  EXPECT_DOUBLE_EQ(unite_with_furrow(a, a, 2.0, 0.7).value, 1.0 - 1.0 / 6.0 + 0.7);
  EXPECT_DOUBLE_EQ(unite_with_furrow(a, {3.0, Vec3::UnitY()}, 2.0, 0.7).value, 1.0);
}

TEST(Implicit, GradientsAreThoseOfTheValues) {
  const Tube tube({{{0.0, 0.0, 0.0}, 2.0}, {{5.0, 1.0, 0.0}, 1.5}, {{9.0, 4.0, 2.0}, 1.0}}, 50.0);
  const Tube other({{{4.0, -4.0, 0.0}, 1.2}, {{4.5, 0.0, 0.5}, 1.4}, {{5.0, 6.0, 1.0}, 1.4}}, 50.0);
  for (const Vec3& p :
       {Vec3(2.1, 2.3, 0.4), Vec3(4.9, -1.2, 0.9), Vec3(6.2, 2.9, 1.9), Vec3(3.3, 1.4, 1.2)}) {
    expect_gradient_fits([&](const Vec3& q) { return tube.at(q); }, p, 1e-6);
    expect_gradient_fits([&](const Vec3& q) { return unite(tube.at(q), other.at(q), 2.0); }, p, 1e-5);
    expect_gradient_fits([&](const Vec3& q) { return unite_with_furrow(tube.at(q), other.at(q), 3.0, 0.4); },
                         p, 1e-5);
    expect_gradient_fits([&](const Vec3& q) { return subtract(tube.at(q), other.at(q), 2.0); }, p, 1e-5);
  }
}

TEST(Implicit, TubeGivesALowerBoundFarAway) {
  const std::vector<TubeKnot> knots{{{0.0, 0.0, 0.0}, 2.0}, {{5.0, 1.0, 0.0}, 1.5}, {{9.0, 4.0, 2.0}, 1.0}};
  const Tube exact(knots, 1e6);
  const Tube bounded(knots, 3.0);
  const Vec3 p(20.0, 3.0, -15.0);
  EXPECT_LE(bounded.at(p).value, exact.at(p).value);
  EXPECT_GE(bounded.at(p).value, 3.0);
}

TEST(Polygonise, BallIsClosedAndHasItsVolume) {
  const TriangleMesh mesh = polygonise(Ball(), kAroundBall, 0.003);
  EXPECT_TRUE(test::is_closed(mesh));
  EXPECT_EQ(test::shells(mesh), 1);
  EXPECT_EQ(test::euler(mesh), 2);
  EXPECT_NEAR(signed_volume(mesh), 4.0 / 3.0 * 3.14159265 * 0.03 * 0.03 * 0.03, 2e-6);
}

TEST(Remesh, BallGetsTheExactCountOnTheSurfaceWithGoodTriangles) {
  const TriangleMesh start = polygonise(Ball(), kAroundBall, 0.003);
  for (const int vertices : {301, 1000}) {  // by collapses and by splits
    const TriangleMesh mesh = remesh(Ball(), start, {.vertices = vertices});
    EXPECT_EQ(mesh.vertices.size(), static_cast<std::size_t>(vertices));
    EXPECT_EQ(mesh.triangles.size(), 2U * (static_cast<std::size_t>(vertices) - 2U));
    EXPECT_TRUE(test::is_closed(mesh));
    EXPECT_GT(test::smallest_angle(mesh), 30.0);
    for (const Vec3& v : mesh.vertices) EXPECT_NEAR(v.norm(), 0.03, 1e-9);
  }
}

TEST(Remesh, SubdivisionsMultiplyTheTrianglesByFourOnTheSurface) {
  const TriangleMesh start = polygonise(Ball(), kAroundBall, 0.003);
  const TriangleMesh mesh = remesh(Ball(), start, {.vertices = 301, .subdivisions = 2});
  EXPECT_EQ(mesh.triangles.size(), 16U * 598U);
  EXPECT_TRUE(test::is_closed(mesh));
  EXPECT_GT(test::smallest_angle(mesh), 30.0);
  for (const Vec3& v : mesh.vertices) EXPECT_NEAR(v.norm(), 0.03, 1e-9);
}

TEST(Implicit, BlendHasNoStepInCurvatureWhereItBegins) {
  // The gradient weight of the larger value starts as the square of the remaining gap.
  const FieldValue b{2.0, Vec3::UnitY()};
  const auto share = [&](double a) { return unite({a, Vec3::UnitX()}, b, 1.0).gradient.y(); };
  EXPECT_DOUBLE_EQ(share(1.0), 0.0);
  EXPECT_NEAR(share(1.01) / share(1.02), 0.25, 1e-9);
}

TEST(Implicit, TubeGoesThroughItsKnotsWithoutStepsInDirection) {
  const std::vector<TubeKnot> knots{
      {{0.0, 0.0, 0.0}, 2.0}, {{5.0, 1.0, 0.0}, 1.5}, {{9.0, 4.0, 2.0}, 1.0}, {{9.0, 9.0, 2.0}, 1.0}};
  const Tube tube(knots, 1e6);
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const TubeKnot at = tube.knot_at(static_cast<double>(k) / 3.0);
    EXPECT_LT((at.middle - knots[k].middle).norm(), 1e-12);
    EXPECT_NEAR(at.radius, knots[k].radius, 1e-12);
  }
  constexpr double kStep = 1e-6;
  for (const double knot : {1.0 / 3.0, 2.0 / 3.0}) {
    const Vec3 before = tube.knot_at(knot).middle - tube.knot_at(knot - kStep).middle;
    const Vec3 after = tube.knot_at(knot + kStep).middle - tube.knot_at(knot).middle;
    EXPECT_LT((after - before).norm(), 1e-4 * before.norm());
  }
}

TEST(Implicit, TubesValueIsTheLeastOverItsBalls) {
  const Tube tube({{{0.0, 0.0, 0.0}, 2.0}, {{5.0, 1.0, 0.0}, 1.5}, {{9.0, 4.0, 2.0}, 1.0}}, 1e6);
  for (const Vec3& p :
       {Vec3(2.1, 3.3, 0.4), Vec3(-3.0, 0.2, 0.9), Vec3(6.2, -1.0, 1.9), Vec3(12.0, 6.0, 2.0)}) {
    double least = 1e9;
    for (int i = 0; i <= 20000; ++i) {
      const TubeKnot ball = tube.knot_at(i / 20000.0);
      least = std::min(least, (p - ball.middle).norm() - ball.radius);
    }
    EXPECT_NEAR(tube.at(p).value, least, 1e-6);
  }
}

TEST(FieldArithmetic, GradientsAreThoseOfTheValues) {
  const auto field = [](const Vec3& p) {
    const FieldValue x = coordinate(p, Vec3::UnitX());
    const FieldValue y = coordinate(p, Vec3::UnitY());
    const FieldValue z = coordinate(p, Vec3(0.6, 0.0, 0.8));
    const FieldValue wave = rise(x, 0.0, 4.0) * sin_cos_of(1.3 * z).sine - sin_cos_of(y).cosine;
    return 2.0 * wave + magnitude(y - x) * length_of(x, z) + angle_of(z, x + 3.0) + 0.5;
  };
  for (const Vec3& p : {Vec3(1.1, 0.3, 0.4), Vec3(2.9, -1.2, 0.9), Vec3(3.3, 1.4, -2.2)}) {
    expect_gradient_fits(field, p, 1e-6);
  }
}

TEST(Remesh, CountThatNoClosedSurfaceHasIsRefused) {
  const TriangleMesh start = polygonise(Ball(), kAroundBall, 0.01);
  EXPECT_THROW((void)remesh(Ball(), start, {.vertices = 3}), InputError);
}

TEST(Loft, PrismHasItsVolumeAndIsOrientedOutwards) {
  std::vector<std::vector<Vec3>> rings;
  for (const double z : {0.0, 1.0, 3.0}) rings.push_back({{0, 0, z}, {2, 0, z}, {2, 1, z}, {0, 1, z}});
  const TriangleMesh mesh = loft(rings, {1.0, 0.5, 0.0}, {1.0, 0.5, 3.0});
  EXPECT_TRUE(test::is_closed(mesh));
  EXPECT_EQ(test::euler(mesh), 2);
  EXPECT_NEAR(signed_volume(mesh), 6.0, 1e-12);
}

}  // namespace
}  // namespace palpate::geometry
