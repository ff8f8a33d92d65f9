#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "palpate/validate.h"

namespace palpate::validate {
namespace {

constexpr model::FalloffRatios kReach{1.1, 0.43, 1.8, 0.58};

TEST(BallSurface, IsTheModelsProfileWithItsBound) {
  const BallSurface surface(kReach, 8e-3, 5e-3, {});
  const deform::DisplacementProfile profile(kReach, 8e-3, 5e-3, 5e-3);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(surface.at(i * 0.5e-3), profile.at(i * 0.5e-3));
}

// 3 mm from its axis the surface of a 5 mm ball is 5 - 4 = 1 mm above its lowest point: 8 - 1 mm deep. A
// profile with the small R_1 of 0.2 sqrt(5 x 8) = 1.3 mm would lie far above the ball.
TEST(BallSurface, AsDrawnIsNowhereAboveTheBall) {
  const BallSurface surface({0.2, 0.43, 1.8, 0.58}, 8e-3, 5e-3, {true, 0.0});
  EXPECT_NEAR(surface.at(3e-3), 7e-3, 1e-12);
  EXPECT_DOUBLE_EQ(surface.at(0.0), 8e-3);
}

// A rest surface of radius 10 mm is 10 - sqrt(91) mm lower 3 mm from the axis; the arc length there is 10
// asin(0.3) mm.
TEST(BallSurface, AsDrawnKnowsHowASurfaceBulges) {
  const BallSurface surface({0.2, 0.43, 1.8, 0.58}, 8e-3, 5e-3, {true, 10e-3});
  EXPECT_NEAR(surface.at(10e-3 * std::asin(0.3)), 7e-3 - (10e-3 - std::sqrt(91.0) * 1e-3), 1e-9);
}

// A rest surface of radius 3 mm faces away from the ball beyond 3 pi/2 = 4.71 mm. At 30 degrees it is 1.5 mm
// from the axis and 3 - sqrt(6.75) mm lower, and the ball is 5 - sqrt(22.75) mm above its lowest point.
TEST(BallSurface, AsDrawnOnASurfaceThatBulgesMoreThanTheBallEndsWhereThatFacesAway) {
  const model::FalloffRatios reach{0.2, 0.43, 1.8, 0.58};
  const BallSurface surface(reach, 10e-3, 5e-3, {true, 3e-3});
  const deform::DisplacementProfile profile(reach, 10e-3, 5e-3);
  const double behind = 5.0 - std::sqrt(22.75) + 3.0 - std::sqrt(6.75);
  EXPECT_NEAR(surface.at(3e-3 * std::numbers::pi / 6.0), (10.0 - behind) * 1e-3, 1e-12);
  for (int i = 48; i < 600; ++i) EXPECT_EQ(surface.at(i * 0.1e-3), profile.at(i * 0.1e-3)) << i;
  EXPECT_LT(surface.at(58e-3), 1e-6);
}

TEST(BallSurface, AsDrawnBeyondTheBallsEdgeIsTheProfile) {
  const model::FalloffRatios reach{0.2, 0.43, 1.8, 0.58};
  const BallSurface surface(reach, 8e-3, 5e-3, {true, 10e-3});
  const deform::DisplacementProfile profile(reach, 8e-3, 5e-3);
  // The ball's edge, 5 mm from the axis, is 10 asin(0.5) = 5.24 mm along the surface.
  EXPECT_GT(surface.at(5.2e-3), profile.at(5.2e-3));
  for (int i = 53; i < 300; ++i) EXPECT_EQ(surface.at(i * 0.1e-3), profile.at(i * 0.1e-3)) << i;
}

TEST(BallSurface, AsDrawnIsTheUnboundedProfileBesideTheBall) {
  const BallSurface surface(kReach, 8e-3, 5e-3, {true, 0.0});
  const deform::DisplacementProfile profile(kReach, 8e-3, 5e-3);
  for (int i = 10; i < 60; ++i) EXPECT_EQ(surface.at(i * 0.5e-3), profile.at(i * 0.5e-3));
}

}  // namespace
}  // namespace palpate::validate
