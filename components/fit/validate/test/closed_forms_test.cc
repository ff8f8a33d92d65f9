#include "fit/validate/test/closed_forms.h"

#include <gtest/gtest.h>

#include "fit/validate/baselines.h"

namespace palpate::validate {
namespace {

// By hand: E* = 12 kPa, R = 4 mm, depth 1 mm: sqrt(R) = 0.063245553, depth^1.5 = 3.1622777e-5; 16000 x
// 0.063245553 x 3.1622777e-5 = 0.032 N; contact radius sqrt(4e-6) = 2 mm.
TEST(ClosedForms, HertzGivesTheForceAndTheContactComputedByHand) {
  EXPECT_NEAR(hertz_force(12e3, 4e-3, 1e-3), 0.032, 1e-12);
  EXPECT_NEAR(hertz_contact_radius(4e-3, 1e-3), 2e-3, 1e-15);
}

// At the rim half the depth, from both sides; at r = 2 a: (1/pi) (sqrt(3) - 2 pi/6) = 0.2179955.
TEST(ClosedForms, HertzSurfaceIsTheBallInsideAndFallsOutside) {
  EXPECT_DOUBLE_EQ(hertz_displacement(1e-3, 2e-3, 0.0), 1e-3);
  EXPECT_NEAR(hertz_displacement(1e-3, 2e-3, 1e-3), 0.875e-3, 1e-15);
  EXPECT_NEAR(hertz_displacement(1e-3, 2e-3, 2e-3), 0.5e-3, 1e-15);
  EXPECT_NEAR(hertz_displacement(1e-3, 2e-3, 2e-3 * (1.0 + 1e-9)), 0.5e-3, 1e-9);
  EXPECT_NEAR(hertz_displacement(1e-3, 2e-3, 4e-3), 0.2179955e-3, 1e-10);
}

// By hand: 0.1 N, E* = 10 kPa, 20 mm: 0.1/(pi x 200) = 0.15915494 mm.
TEST(ClosedForms, BoussinesqGivesTheDisplacementComputedByHand) {
  EXPECT_NEAR(boussinesq_displacement(10e3, 0.1, 20e-3), 0.15915494e-3, 1e-11);
}

TEST(ClosedForms, FarFromABallOnlyItsForceCounts) {
  const double force = hertz_force(10e3, 5e-3, 1e-3);
  const double a = hertz_contact_radius(5e-3, 1e-3);
  const double far = 40.0 * a;
  EXPECT_NEAR(hertz_displacement(1e-3, a, far) / boussinesq_displacement(10e3, force, far), 1.0, 1e-3);
}

}  // namespace
}  // namespace palpate::validate
