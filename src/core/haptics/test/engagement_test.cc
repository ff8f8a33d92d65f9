#include "core/haptics/engagement.h"

#include <gtest/gtest.h>

namespace palpate::haptics {
namespace {

constexpr double kEngagementPeriod = 1e-3;

/// Runs `ticks` of the same input. @return the last gain
double hold(Engagement& engagement, const HandSituation& hand, int ticks) {
  double share = engagement.share;
  for (int i = 0; i < ticks; ++i) share = advance_engagement(engagement, hand, kEngagementPeriod);
  return share;
}

TEST(Engagement, AHandStillOutsideForAQuarterSecondGetsTheForceByARampOfHalfASecond) {
  Engagement engagement;
  const HandSituation still;
  EXPECT_EQ(hold(engagement, still, 250), 0.0);
  EXPECT_NEAR(hold(engagement, still, 250), 0.5, 1e-12);
  EXPECT_NEAR(hold(engagement, still, 250), 1.0, 1e-12);
  EXPECT_EQ(hold(engagement, still, 1000), 1.0);
}

TEST(Engagement, TheShareNeverJumps) {
  Engagement engagement;
  double last = 0.0;
  for (int i = 0; i < 3000; ++i) {
    HandSituation hand;
    hand.clutched = i > 1500 && i < 1700;
    const double share = advance_engagement(engagement, hand, kEngagementPeriod);
    EXPECT_LE(share - last, kEngagementPeriod / kRampTime + 1e-12) << i;
    EXPECT_LE(last - share, kEngagementPeriod / kLetGoTime + 1e-12) << i;
    last = share;
  }
  EXPECT_EQ(last, 1.0);
}

TEST(Engagement, AHandThatMovesOrTouchesGetsNothing) {
  Engagement engagement;
  for (int i = 0; i < 5000; ++i) {
    HandSituation moving;
    moving.position_D.x() = 1e-5 * i;  // 10 mm/s
    ASSERT_EQ(advance_engagement(engagement, moving, kEngagementPeriod), 0.0);
  }
  HandSituation inside;
  inside.outside = false;
  EXPECT_EQ(hold(engagement, inside, 5000), 0.0);
}

TEST(Engagement, TremblingWithinAMillimetreIsStill) {
  Engagement engagement;
  for (int i = 0; i < 800; ++i) {
    HandSituation hand;
    hand.position_D.y() = i % 2 == 0 ? 4e-4 : -4e-4;
    (void)advance_engagement(engagement, hand, kEngagementPeriod);
  }
  EXPECT_EQ(engagement.share, 1.0);
}

TEST(Engagement, OnceEngagedTouchingAndMovingKeepTheShare) {
  Engagement engagement;
  (void)hold(engagement, {}, 1000);
  HandSituation touching;
  touching.outside = false;
  touching.position_D = Vec3(0.1, 0.0, 0.0);
  EXPECT_EQ(hold(engagement, touching, 1000), 1.0);
}

TEST(Engagement, TheClutchTakesTheShareWithinFiftyMillisecondsAndStillnessBringsItBack) {
  Engagement engagement;
  (void)hold(engagement, {}, 1000);
  HandSituation clutched;
  clutched.clutched = true;
  EXPECT_NEAR(hold(engagement, clutched, 25), 0.5, 1e-9);
  EXPECT_NEAR(hold(engagement, clutched, 25), 0.0, 1e-9);
  HandSituation inside;
  inside.outside = false;
  EXPECT_EQ(hold(engagement, inside, 2000), 0.0) << "let go of inside the tissue";
  EXPECT_EQ(hold(engagement, {}, 1000), 1.0);
}

TEST(Engagement, AFaultTakesTheShareAtOnceAndStillnessIsAskedForAgain) {
  Engagement engagement;
  (void)hold(engagement, {}, 1000);
  HandSituation faulty;
  faulty.usable = false;
  EXPECT_EQ(hold(engagement, faulty, 1), 0.0);
  EXPECT_EQ(hold(engagement, {}, 250), 0.0);
  EXPECT_GT(hold(engagement, {}, 1), 0.0);
}

}  // namespace
}  // namespace palpate::haptics
