#include "core/haptics/force_ramp.h"

#include <gtest/gtest.h>

namespace palpate::haptics {
namespace {

constexpr double kRampPeriod = 1e-3;

/// Runs `ticks` of the same input. @return the last gain
double hold(ForceRamp& ramp, const ForceRampInput& hand, int ticks) {
  double share = ramp.gain;
  for (int i = 0; i < ticks; ++i) share = advance_force_ramp(ramp, hand, kRampPeriod);
  return share;
}

TEST(ForceRamp, AHandStillOutsideForAQuarterSecondGetsTheForceByARampOfHalfASecond) {
  ForceRamp ramp;
  const ForceRampInput still;
  EXPECT_EQ(hold(ramp, still, 250), 0.0);
  EXPECT_NEAR(hold(ramp, still, 250), 0.5, 1e-12);
  EXPECT_NEAR(hold(ramp, still, 250), 1.0, 1e-12);
  EXPECT_EQ(hold(ramp, still, 1000), 1.0);
}

TEST(ForceRamp, TheShareNeverJumps) {
  ForceRamp ramp;
  double last = 0.0;
  for (int i = 0; i < 3000; ++i) {
    ForceRampInput hand;
    hand.clutched = i > 1500 && i < 1700;
    const double share = advance_force_ramp(ramp, hand, kRampPeriod);
    EXPECT_LE(share - last, kRampPeriod / kRampTime + 1e-12) << i;
    EXPECT_LE(last - share, kRampPeriod / kRampDownTime + 1e-12) << i;
    last = share;
  }
  EXPECT_EQ(last, 1.0);
}

TEST(ForceRamp, AHandThatMovesOrTouchesGetsNothing) {
  ForceRamp ramp;
  for (int i = 0; i < 5000; ++i) {
    ForceRampInput moving;
    moving.position_D.x() = 1e-5 * i;  // 10 mm/s
    ASSERT_EQ(advance_force_ramp(ramp, moving, kRampPeriod), 0.0);
  }
  ForceRampInput inside;
  inside.outside = false;
  EXPECT_EQ(hold(ramp, inside, 5000), 0.0);
}

TEST(ForceRamp, TremblingWithinAMillimetreIsStill) {
  ForceRamp ramp;
  for (int i = 0; i < 800; ++i) {
    ForceRampInput hand;
    hand.position_D.y() = i % 2 == 0 ? 4e-4 : -4e-4;
    (void)advance_force_ramp(ramp, hand, kRampPeriod);
  }
  EXPECT_EQ(ramp.gain, 1.0);
}

TEST(ForceRamp, OnceEngagedTouchingAndMovingKeepTheShare) {
  ForceRamp ramp;
  (void)hold(ramp, {}, 1000);
  ForceRampInput touching;
  touching.outside = false;
  touching.position_D = Vec3(0.1, 0.0, 0.0);
  EXPECT_EQ(hold(ramp, touching, 1000), 1.0);
}

TEST(ForceRamp, TheClutchTakesTheShareWithinFiftyMillisecondsAndStillnessBringsItBack) {
  ForceRamp ramp;
  (void)hold(ramp, {}, 1000);
  ForceRampInput clutched;
  clutched.clutched = true;
  EXPECT_NEAR(hold(ramp, clutched, 25), 0.5, 1e-9);
  EXPECT_NEAR(hold(ramp, clutched, 25), 0.0, 1e-9);
  ForceRampInput inside;
  inside.outside = false;
  EXPECT_EQ(hold(ramp, inside, 2000), 0.0) << "let go of inside the tissue";
  EXPECT_EQ(hold(ramp, {}, 1000), 1.0);
}

TEST(ForceRamp, AFaultTakesTheShareAtOnceAndStillnessIsAskedForAgain) {
  ForceRamp ramp;
  (void)hold(ramp, {}, 1000);
  ForceRampInput faulty;
  faulty.usable = false;
  EXPECT_EQ(hold(ramp, faulty, 1), 0.0);
  EXPECT_EQ(hold(ramp, {}, 250), 0.0);
  EXPECT_GT(hold(ramp, {}, 1), 0.0);
}

}  // namespace
}  // namespace palpate::haptics
