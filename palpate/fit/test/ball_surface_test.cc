#include "palpate/fit/ball_surface.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate::fit {
namespace {

constexpr model::ReachParameters kReach{1.1, 0.43, 1.8, 0.58};

TEST(BallSurface, IsTheModelsProfileWithItsBound) {
  const BallSurface surface(kReach, 8e-3, 5e-3, {});
  const deform::SurfaceProfile profile(kReach, 8e-3, 5e-3, 5e-3);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(surface.at(i * 0.5e-3), profile.at(i * 0.5e-3));
}

// At 3 mm from its axis a ball of 5 mm is 5 - 4 = 1 mm higher than at its lowest point: 8 - 1 mm deep. The
// profile with a short reach, 0.2 sqrt(5 x 8) = 1.3 mm, is far above.
TEST(BallSurface, AsDrawnIsNowhereAboveTheBall) {
  const BallSurface surface({0.2, 0.43, 1.8, 0.58}, 8e-3, 5e-3, {true, 0.0});
  EXPECT_NEAR(surface.at(3e-3), 7e-3, 1e-12);
  EXPECT_DOUBLE_EQ(surface.at(0.0), 8e-3);
}

// A surface of 10 mm radius is, 3 mm from the axis, 10 - sqrt(91) mm lower at rest; along it that is 10
// asin(0.3) mm.
TEST(BallSurface, AsDrawnKnowsHowASurfaceBulges) {
  const BallSurface surface({0.2, 0.43, 1.8, 0.58}, 8e-3, 5e-3, {true, 10e-3});
  EXPECT_NEAR(surface.at(10e-3 * std::asin(0.3)), 7e-3 - (10e-3 - std::sqrt(91.0) * 1e-3), 1e-9);
}

TEST(BallSurface, AsDrawnIsTheUnboundedProfileBesideTheBall) {
  const BallSurface surface(kReach, 8e-3, 5e-3, {true, 0.0});
  const deform::SurfaceProfile profile(kReach, 8e-3, 5e-3);
  for (int i = 10; i < 60; ++i) EXPECT_EQ(surface.at(i * 0.5e-3), profile.at(i * 0.5e-3));
}

}  // namespace
}  // namespace palpate::fit
