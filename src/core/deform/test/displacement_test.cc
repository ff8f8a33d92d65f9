#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/deform/test/plain_surface.h"
#include "palpate/mesh.h"
#include "palpate/surface.h"

namespace palpate::deform {
namespace {

const model::FalloffRatios kReach{1.1, 0.43, 1.8, 0.58};
constexpr double kSingle = 5e-8;  // m; rounding of the displaced surface to single precision

// The profile of docs/model.md, section 3, as an independent sum with explicit powers.
double by_formula(const model::FalloffRatios& p, double depth, double first, double r) {
  double sum = 0.0;
  double weights = 0.0;
  for (int i = 1; i <= 6; ++i) {
    const double radius =
        first * (1.0 + p.first_bar_ratio * (std::pow(p.bar_ratio, i - 1) - 1.0) / (p.bar_ratio - 1.0));
    const double weight = std::pow(p.weight_ratio, i - 1);
    weights += weight;
    sum += weight * std::max(0.0, 1.0 - (r / radius) * (r / radius));
  }
  return depth * sum / weights;
}

TEST(Profile, AtTheContactIsTheDepthExactly) {
  for (const double depth : {1e-4, 0.003, 0.0123, 0.015})
    EXPECT_EQ(DisplacementProfile(kReach, depth, 0.003).at(0.0), depth);
}

TEST(Profile, FollowsHandComputedValues) {
  // R = 4 mm, D = 9 mm: sqrt(R D) = 6 mm, R_1 = 6.6 mm; R_2 = 1.43 R_1 = 9.438 mm; R_3 = 6.6 (1 + 0.43 x 2.8)
  // = 14.5464 mm; (s^3 - 1)/(s - 1) = 6.04: R_4 = 23.74152; 11.872: R_5 = 40.292736; 22.3696: R_6
  // = 70.0849248. Weights 1, 0.58, 0.3364, 0.195112, 0.11316496, 0.0656356768: sum 2.2903126368.
  const DisplacementProfile profile(kReach, 0.009, 0.004);
  EXPECT_NEAR(profile.outer_radius(), 0.0700849248, 1e-12);
  // r = 20 mm: terms 4, 5, 6 remain: 0.195112 x 0.2903521 + 0.11316496 x 0.7536194 + 0.0656356768 x 0.9185650
  // = 0.0566512 + 0.0852833 + 0.0602906 = 0.2022251; x 9 mm / 2.2903126 = 0.7946627 mm.
  EXPECT_NEAR(profile.at(0.020), 0.7946627e-3, 1e-9);
  // r = 50 mm: term 6 only: 1 - 2500/4911.89668 = 0.4910316; x 0.0656356768 x 9 / 2.2903126 = 0.1266479 mm.
  EXPECT_NEAR(profile.at(0.050), 0.1266479e-3, 1e-9);
}

TEST(Profile, EqualsTheFormulaForManyParameters) {
  for (const double c : {0.7, 1.1, 2.0}) {
    for (const double s : {1.2, 1.8, 3.0}) {
      for (const double g : {0.2, 0.58, 0.9}) {
        const model::FalloffRatios reach{c, 0.5, s, g};
        const DisplacementProfile profile(reach, 0.01, 0.003);
        for (int i = 0; i < 59; ++i) {
          const double r = 0.0017 * i;
          EXPECT_NEAR(profile.at(r), by_formula(reach, 0.01, c * std::sqrt(0.003 * 0.01), r), 1e-15);
        }
      }
    }
  }
}

// R_6 with an explicit square root, in the profile's order of operations.
TEST(Profile, AnExponentOfOneHalfIsTheSquareRootToTheBit) {
  EXPECT_EQ(kReach.depth_exponent, 0.5);
  double bars = 0.0;
  double bar = 1.0;
  for (int i = 0; i < 5; ++i) {
    bars += bar;
    bar *= 1.8;
  }
  for (int i = 1; i < 1000; ++i) {
    const double depth = 1.37e-5 * i;
    const double radius = 2.9e-6 * (1000 - i);
    EXPECT_EQ(DisplacementProfile(kReach, depth, radius).outer_radius(),
              1.1 * std::sqrt(radius * depth) * (1.0 + 0.43 * bars));
  }
}

TEST(Profile, FollowsHandComputedValuesAtOtherExponents) {
  // R = 4 mm, D = 0.5 mm, p = 1/3: (1/8)^(1/3) = 1/2, R_1 = 1.1 x 4 mm / 2 = 2.2 mm; R_6 = 10.618928 R_1.
  const model::FalloffRatios third{1.1, 0.43, 1.8, 0.58, 1.0 / 3.0};
  const DisplacementProfile shallow(third, 0.5e-3, 4e-3);
  EXPECT_NEAR(shallow.outer_radius(), 23.3616416e-3, 1e-12);
  for (const double r : {0.5e-3, 2e-3, 5e-3, 20e-3})
    EXPECT_NEAR(shallow.at(r), by_formula(third, 0.5e-3, 2.2e-3, r), 1e-15);
  // p = 1: R_1 = c D for any tool: 1.1 x 9 mm.
  const model::FalloffRatios one{1.1, 0.43, 1.8, 0.58, 1.0};
  EXPECT_NEAR(DisplacementProfile(one, 9e-3, 4e-3).outer_radius(), 10.618928 * 9.9e-3, 1e-12);
  EXPECT_NEAR(DisplacementProfile(one, 9e-3, 1e-3).outer_radius(), 10.618928 * 9.9e-3, 1e-12);
  // At D = R all exponents agree.
  EXPECT_NEAR(DisplacementProfile(third, 3e-3, 3e-3).outer_radius(),
              DisplacementProfile(kReach, 3e-3, 3e-3).outer_radius(), 1e-15);
}

TEST(Profile, GoesContinuouslyThroughTheExponentOfOneHalf) {
  model::FalloffRatios near = kReach;
  for (const double off : {-1e-9, 1e-9}) {
    near.depth_exponent = 0.5 + off;
    const double ratio = DisplacementProfile(near, 1e-3, 5e-3).outer_radius() /
                         DisplacementProfile(kReach, 1e-3, 5e-3).outer_radius();
    EXPECT_NEAR(ratio, 1.0 + off * std::log(0.2), 1e-14);
  }
}

TEST(Profile, GrowsWithTheDepthAtEveryDistanceWhateverTheExponent) {
  for (const double exponent : {0.02, 0.3, 0.5, 0.8, 1.0}) {
    const model::FalloffRatios reach{1.1, 0.43, 1.8, 0.58, exponent};
    for (const double half_width : {0.0, 3e-3}) {
      for (int i = 1; i < 150; ++i) {
        const DisplacementProfile shallow(reach, 1e-4 * i, 5e-3, half_width);
        const DisplacementProfile deep(reach, 1e-4 * (i + 1), 5e-3, half_width);
        EXPECT_GE(deep.outer_radius(), shallow.outer_radius());
        for (int k = 0; 0.9e-3 * k < shallow.outer_radius(); ++k)
          EXPECT_GT(deep.at(0.9e-3 * k), shallow.at(0.9e-3 * k));
      }
    }
  }
}

TEST(Profile, FallsAllTheWayAndIsZeroFromTheReachOn) {
  const DisplacementProfile profile(kReach, 0.012, 0.003);
  double last = profile.at(0.0);
  for (int i = 1; 1e-4 * i < profile.outer_radius(); ++i) {
    const double r = 1e-4 * i;
    EXPECT_LT(profile.at(r), last);
    last = profile.at(r);
  }
  EXPECT_EQ(profile.at(profile.outer_radius()), 0.0);
  EXPECT_EQ(profile.at(2.0 * profile.outer_radius()), 0.0);
}

TEST(Profile, FirstRadiusIsNeverMoreThanTheToolsHalfWidth) {
  const DisplacementProfile narrow(kReach, 0.01, 0.05, 0.002);
  for (const double r : {0.0005, 0.0015, 0.003, 0.01})
    EXPECT_NEAR(narrow.at(r), by_formula(kReach, 0.01, 0.002, r), 1e-15);
  const DisplacementProfile wide(kReach, 0.01, 0.003, 0.05);
  EXPECT_EQ(wide.outer_radius(), DisplacementProfile(kReach, 0.01, 0.003).outer_radius());
  const model::FalloffRatios steep{1.1, 0.43, 1.8, 0.58, 0.9};
  EXPECT_EQ(DisplacementProfile(steep, 0.01, 0.005, 0.002).outer_radius(),
            DisplacementProfile(kReach, 0.01, 0.005, 0.002).outer_radius());
}

TEST(Profile, WithoutDepthNothingMoves) {
  for (const double depth : {0.0, -0.001, std::nan("")}) {
    const DisplacementProfile profile(kReach, depth, 0.003);
    EXPECT_EQ(profile.at(0.0), 0.0);
    EXPECT_EQ(profile.at(0.001), 0.0);
    EXPECT_EQ(profile.outer_radius(), 0.0);
    EXPECT_EQ(profile.rounded_at(0.001, 0.2), 0.0);
  }
}

TEST(Profile, AnIdealPointStillMovesByTheDepth) {
  for (const double exponent : {0.3, 0.5, 1.0}) {
    const DisplacementProfile point({1.1, 0.43, 1.8, 0.58, exponent}, 0.01, 0.0);
    EXPECT_EQ(point.at(0.0), 0.01);
    EXPECT_TRUE(std::isfinite(point.at(1e-7)));
    EXPECT_TRUE(std::isfinite(point.steepest()));
  }
}

TEST(Profile, SteepestIsTheLargestSlope) {
  const DisplacementProfile profile(kReach, 0.012, 0.003);
  double largest = 0.0;
  const double h = 1e-6;
  for (int i = 0; h * i < profile.outer_radius(); ++i) {
    const double r = h * i;
    largest = std::max(largest, (profile.at(r) - profile.at(r + h)) / h);
  }
  EXPECT_NEAR(profile.steepest(), largest, 1e-3 * largest);
}

TEST(Profile, RoundedIsTheMeanOverItsShareOfTheDistance) {
  const DisplacementProfile profile(kReach, 0.012, 0.003);
  for (const double r : {0.0004, 0.0066, 0.012, 0.03, 0.058, 0.065}) {
    double mean = 0.0;
    const int n = 20000;
    for (int i = 0; i < n; ++i) mean += profile.at(r * (0.8 + 0.4 * (i + 0.5) / n)) / n;
    EXPECT_NEAR(profile.rounded_at(r, 0.2), mean, 1e-9);
    EXPECT_NEAR(profile.rounded_at(r, 0.2), profile.at(r), 0.04 * 0.012);
  }
  EXPECT_EQ(profile.rounded_at(0.0, 0.2), 0.012);
  EXPECT_EQ(profile.rounded_at(0.005, 0.0), profile.at(0.005));
}

struct DeformedMesh {
  geometry::TriangleMesh rest;
  std::vector<Vec3> moved;
};

DeformedMesh deformed_mesh(const geometry::TriangleMesh& rest, const std::vector<Indentation>& indentations) {
  SurfaceDeformer deformer(rest);
  DeformedMesh mesh{rest, {}};
  deformer.deform(kReach, indentations, mesh.moved);
  return mesh;
}

double largest_move(const DeformedMesh& mesh) {
  double largest = 0.0;
  for (std::size_t v = 0; v < mesh.moved.size(); ++v)
    largest = std::max(largest, (mesh.moved[v] - mesh.rest.vertices[v]).norm());
  return largest;
}

TEST(Deformer, MovesAFlatFaceByTheProfileAlongTheDirection) {
  const DeformedMesh mesh = deformed_mesh(geometry::make_box(Vec3(0.2, 0.2, 0.1), 0.004),
                                          {{Vec3(0, 0, 0.05), -Vec3::UnitZ(), 0.005, 0.003}});
  const double first = 1.1 * std::sqrt(0.003 * 0.005);
  for (std::size_t v = 0; v < mesh.moved.size(); ++v) {
    const Vec3& p = mesh.rest.vertices[v];
    if (p.z() < 0.05 - 1e-12) continue;
    const double u = by_formula(kReach, 0.005, first, std::hypot(p.x(), p.y()));
    EXPECT_LT((mesh.moved[v] - p - Vec3(0, 0, -u)).norm(), 1e-6);
  }
}

TEST(Deformer, TheContactPointMovesByTheDepth) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.018, 1280);
  for (const double depth : {0.001, 0.006, 0.012}) {
    const Vec3 top = ball.vertices[40];
    const DeformedMesh mesh = deformed_mesh(ball, {{top, -top.normalized(), depth, 0.003}});
    EXPECT_NEAR((mesh.moved[40] - top).norm(), depth, kSingle);
  }
}

TEST(Deformer, LeavesAllBeyondTheReachBitForBit) {
  const geometry::TriangleMesh box = geometry::make_box(Vec3(0.1, 0.1, 0.04), 0.003);
  const DeformedMesh mesh = deformed_mesh(box, {{Vec3(0, 0, 0.02), -Vec3::UnitZ(), 0.002, 0.001}});
  const double reach = DisplacementProfile(kReach, 0.002, 0.001).outer_radius();
  std::size_t still = 0;
  for (std::size_t v = 0; v < box.vertices.size(); ++v) {
    if ((box.vertices[v] - Vec3(0, 0, 0.02)).norm() < reach) continue;
    EXPECT_EQ(mesh.moved[v], box.vertices[v]);
    ++still;
  }
  EXPECT_GT(still, 1000U);
}

TEST(Deformer, TheFarSideOfAThinPlateStaysStill) {
  const geometry::TriangleMesh plate = geometry::make_box(Vec3(0.1, 0.1, 0.006), 0.003);
  const DeformedMesh mesh = deformed_mesh(plate, {{Vec3(0, 0, 0.003), -Vec3::UnitZ(), 0.004, 0.002}});
  for (std::size_t v = 0; v < plate.vertices.size(); ++v) {
    if (plate.vertices[v].z() > -0.0029) continue;
    EXPECT_EQ(mesh.moved[v], plate.vertices[v]);
  }
}

TEST(Deformer, AnEntrySideNeverComesOutOfTheFarSide) {
  const geometry::TriangleMesh plate = geometry::make_box(Vec3(0.1, 0.1, 0.01), 0.002);
  double last = 0.0;
  for (int mm = 1; mm < 30; ++mm) {
    const double depth = 0.001 * mm;
    const DeformedMesh mesh = deformed_mesh(plate, {{Vec3(0, 0, 0.005), -Vec3::UnitZ(), depth, 0.003}});
    const double drawn = largest_move(mesh);
    EXPECT_LT(drawn, 0.009);
    EXPECT_GT(drawn, last);
    if (depth <= 0.007) {
      EXPECT_NEAR(drawn, depth, kSingle);
    }
    last = drawn;
  }
}

TEST(Deformer, CoincidentContactsActAsOne) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.03, 1280);
  const Indentation one{ball.vertices[12], -ball.vertices[12].normalized(), 0.008, 0.003};
  const DeformedMesh single = deformed_mesh(ball, {one});
  const DeformedMesh triple = deformed_mesh(ball, {one, one, one});
  for (std::size_t v = 0; v < ball.vertices.size(); ++v)
    EXPECT_LT((single.moved[v] - triple.moved[v]).norm(), kSingle);
}

TEST(Deformer, OverlappingContactsNeverMoveMoreThanTheDeepest) {
  const geometry::TriangleMesh box = geometry::make_box(Vec3(0.1, 0.1, 0.08), 0.002);
  for (const double apart : {0.0, 0.001, 0.003, 0.006, 0.012, 0.03}) {
    const DeformedMesh mesh = deformed_mesh(box, {{Vec3(0, 0, 0.04), -Vec3::UnitZ(), 0.010, 0.003},
                                                  {Vec3(apart, 0, 0.04), -Vec3::UnitZ(), 0.007, 0.003}});
    EXPECT_LE(largest_move(mesh), 0.010 + kSingle);
    EXPECT_GT(largest_move(mesh), 0.0097);
  }
}

TEST(Deformer, AWeakContactBesideAStrongOneHardlyLowersIt) {
  const geometry::TriangleMesh box = geometry::make_box(Vec3(0.1, 0.1, 0.08), 0.002);
  const DeformedMesh mesh = deformed_mesh(box, {{Vec3(0, 0, 0.04), -Vec3::UnitZ(), 0.010, 0.003},
                                                {Vec3(0.002, 0, 0.04), -Vec3::UnitZ(), 0.002, 0.003}});
  EXPECT_GT(largest_move(mesh), 0.010 * 0.99);
}

TEST(Deformer, MovesAsThePlainRulesSayToATwoHundredthOfTheDepth) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.03, 20480);
  const auto out = [](double x, double y) { return Vec3(x, y, 1.0).normalized(); };
  const Indentation top{0.03 * out(0, 0), -out(0, 0), 0.006, 0.003};
  const Indentation beside{0.03 * out(0.3, 0.1), -out(0.3, 0.1), 0.008, 0.003};
  const Indentation pull{0.03 * out(0, 0), Vec3(0.5, 0.0, 0.8).normalized(), 0.008, 0.003};
  for (const std::vector<Indentation>& contacts : {std::vector{top}, {pull}, {top, beside}}) {
    const std::vector<Vec3> plain = test::PlainDeformer(ball).deformed(kReach, contacts);
    const DeformedMesh mesh = deformed_mesh(ball, contacts);
    for (std::size_t v = 0; v < plain.size(); ++v)
      ASSERT_LT((mesh.moved[v] - plain[v]).norm(), 0.005 * contacts.back().depth) << v;
  }
}

// Unit normal of the indented sphere of radius R at polar angle a, in the (sine, cosine) axes of its
// meridian: the curve is (R sin a, R cos a - u(R a)).
Vec3 analytic_normal(double radius, const DisplacementProfile& profile, const Vec3& p) {
  const double angle = std::acos(p.normalized().z());
  const double h = 1e-7;
  const double slope = (profile.at(radius * angle + h) - profile.at(radius * angle)) / h;
  const double dx = radius * std::cos(angle);
  const double dz = -radius * std::sin(angle) - radius * slope;
  const double flat = std::hypot(p.x(), p.y());
  return Vec3(-dz * p.x() / flat, -dz * p.y() / flat, dx).normalized();
}

TEST(Deformer, NoTriangleTurnsAwayFromTheSmoothDent) {
  struct Case {
    double radius;
    int triangles;
    double depth;
  };
  for (const Case& c : {Case{0.018, 5120, 0.012}, Case{0.018, 20480, 0.015}, Case{0.055, 20480, 0.012},
                        Case{0.055, 81920, 0.015}}) {
    const geometry::TriangleMesh ball = geometry::make_ball(c.radius, c.triangles);
    const DeformedMesh mesh = deformed_mesh(ball, {{Vec3(0, 0, c.radius), -Vec3::UnitZ(), c.depth, 0.003}});
    const DisplacementProfile profile(kReach, c.depth, 0.003);
    const geometry::TriangleMesh moved{mesh.moved, ball.triangles};
    for (const geometry::Triangle& t : ball.triangles) {
      Vec3 middle = Vec3::Zero();
      for (const std::int32_t v : t) middle += ball.vertices[static_cast<std::size_t>(v)] / 3.0;
      const Vec3 normal = geometry::area_vector_doubled(moved, t);
      EXPECT_GT(normal.norm(), 0.0);
      if (std::hypot(middle.x(), middle.y()) < 0.002) continue;  // the bottom is one smooth bowl
      EXPECT_GT(normal.normalized().dot(analytic_normal(c.radius, profile, middle)), 0.0) << c.depth;
    }
  }
}

TEST(Deformer, APullToTheSideFoldsNothing) {
  const geometry::TriangleMesh box = geometry::make_box(Vec3(0.1, 0.1, 0.08), 0.001);
  for (const double lean_deg : {30.0, 60.0, 85.0, 90.0}) {
    const double lean = lean_deg * 3.14159265358979 / 180.0;
    const DeformedMesh mesh =
        deformed_mesh(box, {{Vec3(0, 0, 0.04), Vec3(std::sin(lean), 0, std::cos(lean)), 0.010, 0.0015}});
    EXPECT_NEAR(largest_move(mesh), 0.010, kSingle);
    const geometry::TriangleMesh moved{mesh.moved, box.triangles};
    for (const geometry::Triangle& t : box.triangles) {
      if (geometry::area_vector_doubled(box, t).normalized().z() < 0.99) continue;
      EXPECT_GT(geometry::area_vector_doubled(moved, t).z(), 0.0) << lean_deg;
    }
  }
}

TEST(Deformer, WithoutIndentationsItIsTheRest) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.018, 320);
  EXPECT_EQ(deformed_mesh(ball, {}).moved, ball.vertices);
  EXPECT_EQ(deformed_mesh(ball, {{ball.vertices[0], Vec3::UnitZ(), 0.0, 0.003}}).moved, ball.vertices);
}

TEST(Deformer, ForgetsThePictureBefore) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.018, 320);
  SurfaceDeformer deformer(ball);
  std::vector<Vec3> vertices;
  const Indentation dent{ball.vertices[0], -ball.vertices[0].normalized(), 0.004, 0.003};
  deformer.deform(kReach, std::vector{dent}, vertices);
  const std::vector<Vec3> first = vertices;
  deformer.deform(kReach, {}, vertices);
  EXPECT_EQ(vertices, ball.vertices);
  deformer.deform(kReach, std::vector{dent}, vertices);
  EXPECT_EQ(vertices, first);
}

TEST(Deformer, TakesTheReachOfTheMoment) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.018, 1280);
  const model::FalloffRatios other{0.8, 0.5, 1.5, 0.4};
  const std::vector dent{Indentation{ball.vertices[0], -ball.vertices[0].normalized(), 0.004, 0.003}};
  SurfaceDeformer fresh(ball);
  std::vector<Vec3> expected;
  fresh.deform(other, dent, expected);
  SurfaceDeformer deformer(ball);
  std::vector<Vec3> vertices;
  deformer.deform(kReach, dent, vertices);
  EXPECT_NE(vertices, expected);
  deformer.deform(other, dent, vertices);
  EXPECT_EQ(vertices, expected);
}

TEST(SharesOfRoom, TwoPressesFromOppositeSidesShareWhatLiesBetweenThem) {
  // The contacts are 10 mm apart and together 12 mm deep: unlimited up to 7 mm, then towards 9 mm: 7 + 2 x 5
  // / (5 + 2).
  const std::vector<Indentation> both = {{Vec3(0, 0, 0.010), -Vec3::UnitZ(), 0.006, 0.003, 0.0},
                                         {Vec3::Zero(), Vec3::UnitZ(), 0.006, 0.003, 0.0}};
  for (const double share : opposition_factors(both)) EXPECT_NEAR(share, (7.0 + 10.0 / 7.0) / 12.0, 1e-12);
}

TEST(SharesOfRoom, IsWholeWherePressesAreShallowOrGoTheSameWayOrPart) {
  const Indentation down{Vec3(0, 0, 0.010), -Vec3::UnitZ(), 0.006, 0.003, 0.0};
  const Indentation shallow{Vec3::Zero(), Vec3::UnitZ(), 0.0009, 0.003, 0.0};
  const Indentation beside{Vec3(0.002, 0, 0.010), Vec3(-0.9, 0, -0.3).normalized(), 0.012, 0.003, 0.0};
  const Indentation away{Vec3::Zero(), -Vec3::UnitZ(), 0.012, 0.003, 0.0};
  const Indentation apart{Vec3(0, 0, 0.020), Vec3::UnitZ(), 0.020, 0.003, 0.0};
  for (const Indentation& other : {shallow, beside, away, apart})
    EXPECT_EQ(opposition_factors(std::vector{down, other}), (std::vector{1.0, 1.0}));
  EXPECT_TRUE(opposition_factors({}).empty());
}

TEST(MeanDirection, IsMadeAUnitVectorUnlessDirectionsOppose) {
  EXPECT_DOUBLE_EQ(mean_direction_gain(1.0), 1.0);
  EXPECT_DOUBLE_EQ(mean_direction_gain(0.81), 1.0 / 0.9);
  EXPECT_NEAR(mean_direction_gain(kAlike - 1e-9), mean_direction_gain(kAlike), 1e-8);
  EXPECT_DOUBLE_EQ(mean_direction_gain(0.0), 1.5 / 0.8);
}

}  // namespace
}  // namespace palpate::deform
