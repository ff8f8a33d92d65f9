#include "core/deform/half_space.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace palpate::deform {
namespace {

constexpr double kPi = std::numbers::pi;
const Vec3 kInward = Vec3::UnitZ();

Vec3 displacement(double x, double y, double a, const Vec3& force) {
  const double r = std::hypot(x, y);
  const Vec3 e = r > 0.0 ? Vec3(x / r, y / r, 0.0) : Vec3::Zero();
  const double normal = force.dot(kInward);
  const Vec3 side = force - normal * kInward;
  return half_space_displacement(half_space_terms(r, a), e, kInward, normal, side) / kHalfSpaceModulus;
}

// Surface displacement of a point force at the origin (Boussinesq and Cerruti; Johnson 1985, 3.19 and 3.75).
Vec3 under_point(double x, double y, const Vec3& force) {
  const double r = std::hypot(x, y);
  const double q = (1.0 + kPoisson) / (2.0 * kPi);
  const double n = kPoisson;
  const Vec3 by_x(q * (2.0 * (1.0 - n) / r + 2.0 * n * x * x / (r * r * r)),
                  q * 2.0 * n * x * y / (r * r * r), q * (1.0 - 2.0 * n) * x / (r * r));
  const Vec3 by_y(q * 2.0 * n * x * y / (r * r * r),
                  q * (2.0 * (1.0 - n) / r + 2.0 * n * y * y / (r * r * r)),
                  q * (1.0 - 2.0 * n) * y / (r * r));
  const Vec3 by_z(-q * (1.0 - 2.0 * n) * x / (r * r), -q * (1.0 - 2.0 * n) * y / (r * r),
                  q * 2.0 * (1.0 - n) / r);
  return force.x() * by_x + force.y() * by_y + force.z() * by_z;
}

TEST(HalfSpace, UnderTheMiddleItIsHertzs) {
  // D = a^2/R and F = 4/3 a^3 E* / R: D/F = 3 (1 - nu^2) / (4 a).
  const double hertz = 3.0 * (1.0 - kPoisson * kPoisson) / 8.0;
  EXPECT_NEAR(displacement(0.0, 0.0, 2.0, kInward).z(), hertz, 1e-9);
  EXPECT_NEAR(half_space_depth(2.0), hertz, 1e-9);
}

TEST(HalfSpace, EqualsTheSumOfPointForcesOverThePressure) {
  constexpr double kRadius = 1.3;
  constexpr int kRings = 300;
  for (const Vec3& force : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0.3, -0.8, 0.5)}) {
    for (const Vec3& at : {Vec3(1.9, 0.6, 0), Vec3(-3.0, 2.0, 0), Vec3(0.2, 1.5, 0)}) {
      Vec3 sum = Vec3::Zero();
      double weights = 0.0;
      for (int i = 0; i < kRings; ++i) {
        for (int j = 0; j < kRings; ++j) {
          const double r = kRadius * (i + 0.5) / kRings;
          const double angle = 2.0 * kPi * (j + 0.5) / kRings;
          const double weight = r * std::sqrt(1.0 - r * r / (kRadius * kRadius));
          weights += weight;
          sum += weight * under_point(at.x() - r * std::cos(angle), at.y() - r * std::sin(angle), force);
        }
      }
      EXPECT_LT((displacement(at.x(), at.y(), kRadius, force) - sum / weights).norm(),
                2e-4 * sum.norm() / weights);
    }
  }
}

TEST(HalfSpace, FarAwayItIsAPointForces) {
  const Vec3 force(0.2, 0.5, 1.0);
  EXPECT_LT((displacement(300.0, 400.0, 1.0, force) - under_point(300.0, 400.0, force)).norm(),
            1e-5 * under_point(300.0, 400.0, force).norm());
}

TEST(HalfSpace, ABallTouchesOverSneddonsRadius) {
  for (const double depth : {0.01, 1.0, 5.0, 50.0}) {
    const double a = ball_contact_radius(5.0, depth);
    EXPECT_LE(a, 5.0);
    if (depth < 10.0) {
      EXPECT_NEAR(a * std::atanh(a / 5.0), depth, 1e-6);
    }
  }
  EXPECT_NEAR(ball_contact_radius(5.0, 0.01), std::sqrt(5.0 * 0.01), 1e-3 * std::sqrt(0.05));  // Hertz
  EXPECT_EQ(ball_contact_radius(5.0, 0.0), 0.0);
}

TEST(HalfSpace, PressureOfAUnitForceAddsUpToOneAndEndsAtTheContactsRim) {
  const double a = 0.003;
  double sum = 0.0;
  for (int ring = 0; ring < 10000; ++ring) {
    const double r = (ring + 0.5) * a / 10000.0;
    sum += contact_pressure(r, a) * 2.0 * kPi * r * a / 10000.0;
  }
  EXPECT_NEAR(sum, 1.0, 1e-5);
  EXPECT_EQ(contact_pressure(a, a), 0.0);
  EXPECT_EQ(contact_pressure(0.0, 0.0), 0.0);
}

}  // namespace
}  // namespace palpate::deform
