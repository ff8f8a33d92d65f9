#include "core/geometry/signed_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::geometry {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Vec3& corner(const TriangleMesh& mesh, std::size_t t, std::size_t k) {
  return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])];
}

/// Nearest point of a triangle by Voronoi regions, independent of the library.
Vec3 oracle_nearest(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  using Long = Eigen::Matrix<long double, 3, 1>;
  const auto on_segment = [&](const Vec3& from, const Vec3& to) -> Long {
    Long f = from.cast<long double>();
    const Long d = to.cast<long double>() - f;
    const long double length = d.squaredNorm();
    if (length == 0.0L) return f;
    const long double u = std::clamp((p.cast<long double>() - f).dot(d) / length, 0.0L, 1.0L);
    return f + u * d;
  };
  Long best = on_segment(a, b);
  const Long q = p.cast<long double>();
  for (const Long& other : {on_segment(b, c), on_segment(c, a)}) {
    if ((q - other).squaredNorm() < (q - best).squaredNorm()) best = other;
  }
  const Long u = (b - a).cast<long double>();
  const Long v = (c - a).cast<long double>();
  const Long n = u.cross(v);
  if (n.squaredNorm() > 0.0L) {
    const Long w = q - a.cast<long double>();
    const long double beta = w.cross(v).dot(n) / n.squaredNorm();
    const long double gamma = u.cross(w).dot(n) / n.squaredNorm();
    if (beta >= 0.0L && gamma >= 0.0L && beta + gamma <= 1.0L) {
      const Long foot = a.cast<long double>() + beta * u + gamma * v;
      if ((q - foot).squaredNorm() < (q - best).squaredNorm()) best = foot;
    }
  }
  return best.cast<double>();
}

double oracle_distance(const TriangleMesh& mesh, const Vec3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    best = std::min(
        best, (p - oracle_nearest(p, corner(mesh, t, 0), corner(mesh, t, 1), corner(mesh, t, 2))).norm());
  }
  return best;
}

/// Winding number from solid angles [van Oosterom and Strackee 1983]: 1 inside, 0 outside.
double winding(const TriangleMesh& mesh, const Vec3& p) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 a = corner(mesh, t, 0) - p;
    const Vec3 b = corner(mesh, t, 1) - p;
    const Vec3 c = corner(mesh, t, 2) - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4.0 * std::acos(-1.0));
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 point(double reach) { return {in(-reach, reach), in(-reach, reach), in(-reach, reach)}; }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(engine_); }

 private:
  std::mt19937 engine_;
};

/// A closed ball with hollows and spikes: convex and concave edges and corners of all kinds.
TriangleMesh burr(unsigned seed, int triangles = 320) {
  TriangleMesh mesh = make_ball(0.03, triangles);
  Random random(seed);
  for (Vec3& vertex : mesh.vertices) vertex *= random.in(0.4, 1.6);
  return mesh;
}

/// 10 um thick, so that both sides are near everywhere.
TriangleMesh thin_plate() { return make_box({0.04, 0.03, 1e-5}, 0.01); }

/// A closed wedge of needles: 40 mm long, 1 um across.
TriangleMesh needle() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1e-6, 0, 0}, {0, 1e-6, 0}, {3e-7, 3e-7, 0.04}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

std::vector<TriangleMesh> shapes() {
  return {
      make_ball(0.03, 1280), make_box({0.06, 0.05, 0.04}, 0.02), burr(1), burr(2), thin_plate(), needle()};
}

TEST(NearestOnTriangle, AgreesWithTheOracleForEveryOrderOfItsCorners) {
  Random random(3);
  for (int n = 0; n < 3000; ++n) {
    std::array<Vec3, 3> v{random.point(1.0), random.point(1.0), random.point(1.0)};
    if (n % 3 == 1) v[2] = 0.3 * v[0] + 0.7 * v[1] + random.point(1e-6);  // sliver with an obtuse corner
    if (n % 3 == 2) v[1] = v[0] + random.point(1e-6);                     // needle
    const Vec3 p = random.point(2.0);
    const double want = (p - oracle_nearest(p, v[0], v[1], v[2])).norm();
    for (const auto& [i, j, k] : {std::array{0U, 1U, 2U}, std::array{1U, 2U, 0U}, std::array{2U, 0U, 1U},
                                  std::array{0U, 2U, 1U}, std::array{2U, 1U, 0U}, std::array{1U, 0U, 2U}}) {
      EXPECT_NEAR((p - nearest_on_triangle(p, v[i], v[j], v[k])).norm(), want, 1e-9) << n;
    }
  }
}

TEST(NearestOnTriangle, TakesTrianglesThatAreASegmentOrAPoint) {
  EXPECT_EQ(nearest_on_triangle({1, 5, 0}, {0, 0, 0}, {2, 0, 0}, {1, 0, 0}), Vec3(1, 0, 0));
  EXPECT_EQ(nearest_on_triangle({1, 5, 0}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}), Vec3(1, 1, 1));
}

TEST(SignedDistance, AgreesWithTheOracleInDistanceAndSign) {
  Random random(4);
  for (const TriangleMesh& mesh : shapes()) {
    const SignedDistance surface(mesh);
    for (int n = 0; n < 2000; ++n) {
      // Random points, some close to a vertex or an edge.
      Vec3 p = random.point(0.06);
      const std::size_t t = random.below(mesh.triangles.size());
      if (n % 3 == 1) p = corner(mesh, t, 0) + random.point(1e-4);
      if (n % 3 == 2) {
        const double u = random.in(0.0, 1.0);
        p = u * corner(mesh, t, 0) + (1.0 - u) * corner(mesh, t, 1) + random.point(1e-5);
      }
      const NearestPoint found = surface.nearest(p);
      const double want = oracle_distance(mesh, p);
      ASSERT_NEAR(std::abs(found.distance), want, 1e-12);
      EXPECT_NEAR((p - found.point).norm(), want, 1e-12);
      if (want > 1e-10) {
        EXPECT_EQ(found.distance<0.0, winding(mesh, p)> 0.5) << n;
      }
      EXPECT_NEAR(found.normal.norm(), 1.0, 1e-12);
    }
  }
}

TEST(SignedDistance, KnowsInsideFromOutsideAlongTheBisectorsOfABoxCorner) {
  const SignedDistance surface(make_box({2.0, 2.0, 2.0}, 2.0));
  EXPECT_NEAR(surface.nearest({1.3, 1.4, 1.0 + 1.2}).distance, 1.3, 1e-15);  // 0.3, 0.4, 1.2 from the corner
  EXPECT_NEAR(surface.nearest({1.3, 1.4, 0.2}).distance, 0.5, 1e-15);        // nearest to an edge
  EXPECT_NEAR(surface.nearest({0.9, 0.9, 0.9}).distance, -0.1, 1e-15);
  EXPECT_LT((surface.nearest({1.1, 1.1, 1.1}).normal - Vec3(1, 1, 1) / std::sqrt(3.0)).norm(), 1e-12);
  EXPECT_LT((surface.nearest({1.1, 0.2, 1.1}).normal - Vec3(1, 0, 1) / std::sqrt(2.0)).norm(), 1e-12);
}

TEST(SignedDistance, CornerNormalWeighsAnglesNotTriangles) {
  // At some corners two of the three faces are divided by a diagonal: a normal weighted by triangle count
  // would tilt.
  const SignedDistance surface(make_box({2.0, 2.0, 2.0}, 2.0));
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        const NearestPoint found = surface.nearest(1.5 * Vec3(x, y, z));
        EXPECT_LT((found.normal - Vec3(x, y, z) / std::sqrt(3.0)).norm(), 1e-12);
      }
    }
  }
}

TEST(SignedDistance, IsTinyOnTheSurface) {
  Random random(5);
  for (const TriangleMesh& mesh : shapes()) {
    const SignedDistance surface(mesh);
    for (const Vec3& vertex : mesh.vertices) EXPECT_LT(std::abs(surface.nearest(vertex).distance), 1e-17);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const double u = random.in(0.0, 1.0);
      const double v = random.in(0.0, 1.0 - u);
      const Vec3 p = u * corner(mesh, t, 0) + v * corner(mesh, t, 1) + (1.0 - u - v) * corner(mesh, t, 2);
      EXPECT_LT(std::abs(surface.nearest(p).distance), 1e-16);
    }
  }
}

TEST(SignedDistance, ThinPlateHasTheRightSignOnEitherSide) {
  const SignedDistance surface(thin_plate());
  EXPECT_NEAR(surface.nearest({0.001, 0.002, 4e-6}).distance, -1e-6, 1e-18);
  EXPECT_NEAR(surface.nearest({0.001, 0.002, 6e-6}).distance, 1e-6, 1e-18);
  EXPECT_NEAR(surface.nearest({0.001, 0.002, -6e-6}).distance, 1e-6, 1e-18);
  EXPECT_NEAR(surface.nearest({0.001, 0.002, 0.0}).distance, -5e-6, 1e-18);
}

TEST(SignedDistance, OfEquallyNearTrianglesTheSmallestIndexWins) {
  const TriangleMesh mesh = make_box({2.0, 2.0, 2.0}, 2.0);
  const SignedDistance surface(mesh);
  const Vec3 middle = Vec3::Zero();  // equally far from all six sides
  EXPECT_EQ(surface.nearest(middle).triangle, 0);
  for (std::int32_t guess = 0; guess < 12; ++guess) EXPECT_EQ(surface.nearest(middle, guess).triangle, 0);
}

TEST(SignedDistance, GuessChangesNothing) {
  Random random(6);
  for (const TriangleMesh& mesh : shapes()) {
    const SignedDistance surface(mesh);
    for (int n = 0; n < 1000; ++n) {
      // Also near vertices and edges, where several triangles are equally near.
      const std::size_t t = random.below(mesh.triangles.size());
      const Vec3 p = n % 2 == 0 ? random.point(0.05) : Vec3(1.2 * corner(mesh, t, 0));
      const NearestPoint plain = surface.nearest(p);
      const auto guess = static_cast<std::int32_t>(random.below(mesh.triangles.size()));
      const NearestPoint guessed = surface.nearest(p, guess);
      EXPECT_EQ(guessed.triangle, plain.triangle);
      EXPECT_EQ(guessed.distance, plain.distance);
      EXPECT_EQ(guessed.point, plain.point);
      EXPECT_EQ(guessed.normal, plain.normal);
    }
  }
}

TEST(SignedDistance, ClearanceIsNoMoreThanTheDistanceAndNoLessThanItsShare) {
  Random random(12);
  for (const TriangleMesh& mesh : shapes()) {
    const SignedDistance surface(mesh);
    for (int n = 0; n < 300; ++n) {
      const Vec3 p = random.point(0.05);
      const auto guess = static_cast<std::int32_t>(random.below(mesh.triangles.size()));
      const Clearance clearance = surface.clearance(p, n % 2 == 0 ? guess : -1);
      const double distance = oracle_distance(mesh, p);
      ASSERT_LE(clearance.least, distance);
      ASSERT_GE(clearance.least, kClearanceShare * distance * (1.0 - 1e-9));
      ASSERT_GE(clearance.triangle, 0);
    }
  }
}

TEST(SignedDistance, ClearanceOfAPointThatIsNotFiniteIsNothing) {
  const SignedDistance surface(make_ball(0.03, 80));
  const Clearance clearance = surface.clearance({0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}, 3);
  EXPECT_EQ(clearance.least, 0.0);
  EXPECT_EQ(clearance.triangle, -1);
}

TEST(SignedDistance, GuessOutOfRangeIsIgnored) {
  const SignedDistance surface(make_ball(0.03, 80));
  const Vec3 p(0.04, 0.01, 0.0);
  EXPECT_EQ(surface.nearest(p, 80).triangle, surface.nearest(p).triangle);
  EXPECT_EQ(surface.nearest(p, -7).triangle, surface.nearest(p).triangle);
}

TEST(SignedDistance, APointThatIsNotFiniteHasNoTriangle) {
  const SignedDistance surface(make_ball(0.03, 80));
  const NearestPoint found = surface.nearest({std::nan(""), 0.0, 0.0});
  EXPECT_EQ(found.triangle, -1);
  EXPECT_TRUE(std::isnan(found.distance));
}

TEST(SignedDistance, HoldsFarFromTheMeshAndFarFromTheOrigin) {
  TriangleMesh mesh = make_ball(0.03, 320);
  transform(mesh, {Quat::Identity(), Vec3(100.0, -50.0, 20.0)});
  const SignedDistance surface(mesh);
  Random random(7);
  for (int n = 0; n < 300; ++n) {
    const Vec3 p = Vec3(100.0, -50.0, 20.0) + random.point(n % 2 == 0 ? 0.05 : 1000.0);
    EXPECT_NEAR(std::abs(surface.nearest(p).distance), oracle_distance(mesh, p), 1e-11);
  }
}

TEST(SignedDistance, TakesManyTrianglesAtOnePlace) {
  // Concentric shells: all bounding volumes overlap and their centres coincide.
  TriangleMesh mesh;
  for (int shell = 0; shell < 200; ++shell) {
    const TriangleMesh ball = make_ball(0.01 + 1e-9 * shell, 20);
    const auto offset = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), ball.vertices.begin(), ball.vertices.end());
    for (const auto& [a, b, c] : ball.triangles)
      mesh.triangles.push_back({a + offset, b + offset, c + offset});
  }
  const SignedDistance surface(mesh);
  Random random(8);
  for (int n = 0; n < 50; ++n) {
    const Vec3 p = random.point(0.03);
    EXPECT_NEAR(std::abs(surface.nearest(p).distance), oracle_distance(mesh, p), 1e-13);
  }
}

TEST(SignedDistance, RefusesAnEmptyMesh) {
  EXPECT_THAT([] { SignedDistance{TriangleMesh{}}; }, ThrowsMessage<InputError>(HasSubstr("no triangles")));
}

TEST(SignedDistance, RefusesAnOpenMesh) {
  TriangleMesh mesh = make_ball(0.03, 80);
  mesh.triangles.pop_back();
  EXPECT_THAT([&] { SignedDistance{mesh}; }, ThrowsMessage<InputError>(HasSubstr("3 boundary edges")));
}

TEST(SignedDistance, RefusesATriangleTurnedOver) {
  TriangleMesh mesh = make_ball(0.03, 80);
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  EXPECT_THAT([&] { SignedDistance{mesh}; }, ThrowsMessage<InputError>(HasSubstr("inverted")));
}

TEST(FirstEntry, NeverMissesFromOutsideToInside) {
  Random random(9);
  for (const TriangleMesh& mesh :
       {make_ball(0.03, 1280), make_box({0.06, 0.05, 0.04}, 0.02), burr(1), burr(2)}) {
    const SignedDistance surface(mesh);
    int tried = 0;
    while (tried < 3000) {
      const Vec3 a = random.point(0.08);
      const Vec3 b = random.point(0.03);
      if (surface.nearest(a).distance < 1e-9 || surface.nearest(b).distance > -1e-9) continue;
      ++tried;
      const auto entry = surface.first_entry(a, b);
      ASSERT_TRUE(entry.has_value());
      EXPECT_LT(std::abs(surface.nearest(entry->point).distance), 1e-15);
    }
  }
}

TEST(FirstEntry, NeverMissesAimedExactlyAtVerticesAndEdges) {
  Random random(10);
  for (const TriangleMesh& mesh :
       {make_ball(0.03, 1280), make_box({0.06, 0.05, 0.04}, 0.02), burr(3), burr(4)}) {
    const SignedDistance surface(mesh);
    int tried = 0;
    for (int n = 0; n < 20000; ++n) {
      const std::size_t t = random.below(mesh.triangles.size());
      const double u = n % 2 == 0 ? 0.0 : (n % 4 == 1 ? 0.5 : random.in(0.0, 1.0));
      const Vec3 target = corner(mesh, t, 0) + u * (corner(mesh, t, 1) - corner(mesh, t, 0));
      const Vec3 step = random.point(0.05);
      const Vec3 a = target - step;
      const Vec3 b = target + (n % 3 == 0 ? 1.0 : 0.05) * step;
      if (surface.nearest(a).distance < 1e-9 || surface.nearest(b).distance > -1e-9) continue;
      ++tried;
      ASSERT_TRUE(surface.first_entry(a, b).has_value()) << n;
    }
    EXPECT_GT(tried, 1000);
  }
}

TEST(FirstEntry, NeverMissesAlongTheAxesThroughTheGridOfABox) {
  const SignedDistance surface(make_box({0.04, 0.04, 0.04}, 0.01));
  for (int k = 0; k < 3; ++k) {
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        Vec3 b;
        b[k] = 0.0;
        b[(k + 1) % 3] = 0.01 * i;
        b[(k + 2) % 3] = 0.01 * j;
        for (const double side : {-0.05, 0.05}) {
          Vec3 a = b;
          a[k] = side;
          const auto entry = surface.first_entry(a, b);
          ASSERT_TRUE(entry.has_value());
          EXPECT_NEAR(entry->fraction, 0.6, 1e-14);
        }
      }
    }
  }
}

TEST(FirstEntry, TakesTheFirstOfSeveral) {
  TriangleMesh two = make_box({0.02, 0.02, 0.02}, 0.02);
  TriangleMesh other = two;
  transform(other, {Quat::Identity(), Vec3(0.05, 0, 0)});
  for (const Vec3& vertex : other.vertices) two.vertices.push_back(vertex);
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + 8, b + 8, c + 8});
  const SignedDistance surface(two);
  const auto entry = surface.first_entry({-0.05, 0.001, 0.002}, {0.15, 0.001, 0.002});
  ASSERT_TRUE(entry.has_value());
  EXPECT_NEAR(entry->fraction, 0.2, 1e-15);
  EXPECT_NEAR(entry->point.x(), -0.01, 1e-15);
  const auto back = surface.first_entry({0.15, 0.001, 0.002}, {-0.05, 0.001, 0.002});
  ASSERT_TRUE(back.has_value());
  EXPECT_NEAR(back->point.x(), 0.06, 1e-15);
}

TEST(FirstEntry, LeavingIsNoEntry) {
  const SignedDistance surface(make_box({0.02, 0.02, 0.02}, 0.02));
  EXPECT_FALSE(surface.first_entry({0.001, 0.002, 0.0}, {0.05, 0.002, 0.0}).has_value());
}

TEST(FirstEntry, ASegmentThatEndsShortOrPassesByDoesNotEnter) {
  const SignedDistance surface(make_box({0.02, 0.02, 0.02}, 0.02));
  EXPECT_FALSE(surface.first_entry({0.05, 0.0, 0.0}, {0.0101, 0.0, 0.0}).has_value());
  EXPECT_FALSE(surface.first_entry({0.05, 0.0, 0.0}, {0.05, 0.1, 0.0}).has_value());
  EXPECT_FALSE(surface.first_entry({0.05, 0.0101, 0.0}, {-0.05, 0.0101, 0.0}).has_value());
}

TEST(FirstEntry, AStartOnTheSurfaceGoingInEnters) {
  const SignedDistance surface(make_box({0.02, 0.02, 0.02}, 0.02));
  const auto entry = surface.first_entry({0.003, 0.002, 0.01}, {0.003, 0.002, 0.0});
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->fraction, 0.0);
}

TEST(FirstEntry, APointIsNoSegment) {
  const SignedDistance surface(make_box({0.02, 0.02, 0.02}, 0.02));
  EXPECT_FALSE(surface.first_entry(Vec3::Zero(), Vec3::Zero()).has_value());
  EXPECT_FALSE(surface.first_entry(Vec3::Constant(std::nan("")), Vec3::Zero()).has_value());
}

TEST(FirstEntry, TinyStepsAcrossAThinPlateAreSeen) {
  const SignedDistance surface(thin_plate());
  const auto entry = surface.first_entry({0.001, 0.002, 5.001e-6}, {0.001, 0.002, 4.999e-6});
  ASSERT_TRUE(entry.has_value());
  EXPECT_NEAR(entry->fraction, 0.5, 1e-6);
  // Through the organ in one tick, in both directions.
  EXPECT_TRUE(surface.first_entry({0.001, 0.002, 1.0}, {0.001, 0.002, -1.0}).has_value());
  EXPECT_TRUE(surface.first_entry({0.001, 0.002, -1.0}, {0.001, 0.002, 1.0}).has_value());
}

}  // namespace
}  // namespace palpate::geometry
