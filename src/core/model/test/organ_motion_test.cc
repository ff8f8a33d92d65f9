#include "palpate/organ_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::model {
namespace {

using testing::HasSubstr;

constexpr OrganMotionKind kKinds[] = {OrganMotionKind::kBreathing, OrganMotionKind::kHeartbeat};
const double kPi = std::acos(-1.0);

OrganMotionParameters unit_motion(OrganMotionKind kind, double phase = 0.0) {
  OrganMotionParameters motion = organ_motion_preset(kind);
  motion.phase = phase;
  return motion;
}

std::string error_of(const std::vector<OrganMotionParameters>& motions) {
  try {
    validate(motions);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ShareOfWay, BreathingIsLujansCurveThatLingersAtTheEndOfBreathingOut) {
  const OrganMotionParameters breathing = unit_motion(OrganMotionKind::kBreathing);
  for (int i = 0; i <= 300; ++i) {
    const double u = i / 100.0;
    EXPECT_NEAR(share_of_way(breathing, u), std::pow(std::sin(kPi * u), 6), 1e-14) << u;
  }
  EXPECT_DOUBLE_EQ(share_of_way(breathing, 0.5), 1.0);
  int low = 0;
  for (int i = 0; i < 1000; ++i) low += share_of_way(breathing, i / 1000.0) < 0.5 ? 1 : 0;
  EXPECT_NEAR(low, 700, 10) << "sin^6 < 1/2 below 63 and above 117 of 180 degrees";
}

TEST(ShareOfWay, AHeartContractsForAThirdRelaxesForAThirdAndRestsForAThird) {
  const OrganMotionParameters heart = unit_motion(OrganMotionKind::kHeartbeat);
  EXPECT_NEAR(share_of_way(heart, 1.0 / 6.0), 0.5, 1e-12);
  EXPECT_NEAR(share_of_way(heart, 1.0 / 3.0), 1.0, 1e-12);
  EXPECT_NEAR(share_of_way(heart, 0.5), 0.5, 1e-12);
  // 10 u^3 - 15 u^4 + 6 u^5 at a quarter: 0.15625 - 0.05859375 + 0.005859375
  EXPECT_NEAR(share_of_way(heart, 7.0 + 1.0 / 12.0), 0.103515625, 1e-12);
  for (const double u : {0.67, 0.8, 0.999, 5.75}) EXPECT_EQ(share_of_way(heart, u), 0.0) << u;
}

TEST(ShareOfWay, StartsAtRestWithoutSpeedWhateverThePhaseAndStaysBetweenNothingAndOne) {
  for (const OrganMotionKind kind : kKinds) {
    for (const double phase : {0.0, 0.1, 0.25, 0.5, 0.99}) {
      const OrganMotionParameters motion = unit_motion(kind, phase);
      EXPECT_EQ(share_of_way(motion, 0.0), 0.0);
      EXPECT_LT(share_of_way(motion, 1e-3), 1e-6);
      for (int i = 0; i < 4000; ++i) {
        const double share = share_of_way(motion, i / 1000.0);
        ASSERT_GE(share, 0.0);
        ASSERT_LE(share, 1.0);
      }
    }
  }
}

TEST(ShareOfWay, IsPeriodicAfterTheFirstCycleAndFromTheStartWithoutAPhase) {
  for (const OrganMotionKind kind : kKinds) {
    for (int i = 0; i < 100; ++i) {
      const double u = i / 100.0;
      EXPECT_NEAR(share_of_way(unit_motion(kind), u), share_of_way(unit_motion(kind), u + 5.0), 1e-12);
      EXPECT_NEAR(share_of_way(unit_motion(kind, 0.3), u + 1.0), share_of_way(unit_motion(kind), u + 6.3),
                  1e-12);
    }
  }
}

TEST(ShareOfWay, IsTwiceContinuouslyDifferentiable) {
  constexpr double kStep = 1e-4;
  for (const OrganMotionKind kind : kKinds) {
    for (const double phase : {0.0, 0.4}) {
      const OrganMotionParameters motion = unit_motion(kind, phase);
      const auto curvature = [&](double u) {
        return (share_of_way(motion, u + kStep) - 2.0 * share_of_way(motion, u) +
                share_of_way(motion, u - kStep)) /
               (kStep * kStep);
      };
      double last = curvature(0.01);
      for (int i = 0; 0.01 + kStep * i < 2.2; ++i) {
        const double u = 0.01 + kStep * i;
        const double now = curvature(u);
        // A jump of the curvature would exceed this bound; the third derivative is below 60 / (1/3)^3 = 1620.
        ASSERT_NEAR(now, last, 2000.0 * kStep) << u;
        last = now;
      }
    }
  }
}

TEST(GreatestSpeed, IsThatOfTheSteepestPartOfTheCurve) {
  for (const OrganMotionKind kind : kKinds) {
    for (const double phase : {0.0, 0.35}) {
      OrganMotionParameters motion = unit_motion(kind, phase);
      motion.amplitude = 0.02;
      motion.rotation = -0.1;
      double steepest = 0.0;
      for (int i = 0; i < 30'000; ++i) {
        const double u = 1e-4 * i;
        steepest =
            std::max(steepest, std::abs(share_of_way(motion, u + 1e-4) - share_of_way(motion, u)) / 1e-4);
      }
      const OrganSpeed speed = greatest_speed(motion);
      const double found = steepest * 0.02 / motion.period;
      EXPECT_GE(speed.translation, found * (1.0 - 1e-6));
      if (phase == 0.0) {
        EXPECT_NEAR(speed.translation, found, 1e-4 * found);
      }
      EXPECT_NEAR(speed.turning, speed.translation * 5.0, 1e-12);
    }
  }
}

TEST(OrganMotion, AStillOrganKeepsItsPoseToTheBit) {
  const Pose rest{Quat(0.5, -0.5, 0.5, 0.5000000000000001), Vec3(0.1, -0.2, 1e-300)};
  const OrganMotion still;
  EXPECT_FALSE(still.moves());
  const Pose pose = still.pose_at(rest, 12345, 1000.0);
  EXPECT_EQ(pose.position, rest.position);
  EXPECT_EQ(pose.rotation.coeffs(), rest.rotation.coeffs());
}

TEST(OrganMotion, TranslatesAlongItsDirectionInTheWorldHoweverTheOrganLies) {
  OrganMotionParameters breathing = unit_motion(OrganMotionKind::kBreathing);
  breathing.amplitude = 0.008;
  breathing.direction_W = Vec3(0, 0.6, 0.8);
  const OrganMotion motion({breathing}, Vec3(0.01, 0.02, 0.03));
  const Pose rest{rotation_from_degrees(Vec3(90, 0, 0)), Vec3(0.1, 0, 0)};
  EXPECT_EQ(motion.pose_at(rest, 0, 1000.0).position, rest.position);
  const Pose top = motion.pose_at(rest, 2000, 1000.0);  // half of 4 s
  EXPECT_NEAR((top.position - Vec3(0.1, 0.0048, 0.0064)).norm(), 0.0, 1e-15);
  EXPECT_EQ(top.rotation.coeffs(), rest.rotation.coeffs());
  EXPECT_NEAR((motion.pose_at(rest, 4000, 1000.0).position - rest.position).norm(), 0.0, 1e-15);
}

TEST(OrganMotion, TurnsAboutTheOrgansMiddleWhichStaysWhereItIs) {
  OrganMotionParameters twist = unit_motion(OrganMotionKind::kHeartbeat);
  twist.amplitude = 0.0;
  twist.rotation = kPi / 6.0;
  twist.period = 3.0;
  const Vec3 middle(0.01, 0, 0);
  const OrganMotion motion({twist}, middle);
  const Pose rest{Quat::Identity(), Vec3(0.1, 0, 0)};
  const Pose turned = motion.pose_at(rest, 1000, 1000.0);
  EXPECT_NEAR((turned * middle - Vec3(0.11, 0, 0)).norm(), 0.0, 1e-15);
  // A point 10 mm from the middle along x turns by 30 degrees towards y.
  EXPECT_NEAR((turned * Vec3(0.02, 0, 0) - Vec3(0.11 + 0.01 * std::cos(kPi / 6.0), 0.005, 0)).norm(), 0.0,
              1e-15);
}

TEST(OrganMotion, SeveralMotionsGoOnAtOnceAndDependOnTheTimeOnlyNotOnTheRate) {
  const OrganMotionParameters breathing = unit_motion(OrganMotionKind::kBreathing);
  const OrganMotionParameters heart = unit_motion(OrganMotionKind::kHeartbeat);
  const OrganMotion both({breathing, heart}, Vec3::Zero());
  for (const std::uint64_t tick : {1U, 137U, 2000U, 98765U}) {
    const double time = static_cast<double>(tick) / 1000.0;
    const double z =
        0.010 * share_of_way(breathing, time / 4.0) + 0.003 * share_of_way(heart, time * 70.0 / 60.0);
    const Pose pose = both.pose_at({}, tick, 1000.0);
    EXPECT_NEAR((pose.position - Vec3(0, 0, z)).norm(), 0.0, 1e-14);
    const Pose same = both.pose_at({}, 4 * tick, 4000.0);
    EXPECT_NEAR((pose.position - same.position).norm(), 0.0, 1e-15);
    EXPECT_NEAR(pose.rotation.angularDistance(same.rotation), 0.0, 1e-7);
    EXPECT_NEAR(pose.rotation.norm(), 1.0, 1e-15);
  }
}

TEST(OrganMotion, PresetsAreOfARestingAdultAndPass) {
  const OrganMotionParameters breathing = organ_motion_preset(OrganMotionKind::kBreathing);
  const OrganMotionParameters heart = organ_motion_preset(OrganMotionKind::kHeartbeat);
  EXPECT_EQ(error_of({breathing, heart}), "");
  EXPECT_NEAR(60.0 / breathing.period, 15.0, 1e-12) << "a minute";
  EXPECT_NEAR(60.0 / heart.period, 70.0, 1e-12);
  EXPECT_EQ(std::string(to_string(breathing.kind)), "breathing");
  EXPECT_EQ(std::string(to_string(heart.kind)), "heartbeat");
  EXPECT_NEAR(greatest_speed(breathing).translation, 0.0122, 1e-4);
  EXPECT_NEAR(greatest_speed(heart).translation, 0.0197, 1e-4);
}

TEST(OrganMotion, RefusesEveryBadFieldByItsNameAndValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto spoiled = [](auto spoil) {
    OrganMotionParameters motion = organ_motion_preset(OrganMotionKind::kBreathing);
    spoil(motion);
    return error_of({motion});
  };
  EXPECT_THAT(spoiled([](auto& m) { m.amplitude = 0.101; }),
              HasSubstr("amplitude_mm = 101: must be a number >= 0 and <= 100"));
  EXPECT_THAT(spoiled([](auto& m) { m.amplitude = -0.001; }), HasSubstr("amplitude_mm = -1"));
  EXPECT_THAT(spoiled([=](auto& m) { m.amplitude = nan; }), HasSubstr("amplitude_mm = nan"));
  EXPECT_THAT(spoiled([](auto& m) { m.rotation = 0.8; }), HasSubstr("must be a number >= -45 and <= 45"));
  EXPECT_THAT(spoiled([](auto& m) { m.period = 0.1; }),
              HasSubstr("period_s = 0.1: must be a number >= 0.2 and <= 60"));
  EXPECT_THAT(spoiled([](auto& m) { m.period = 61.0; }), HasSubstr("period_s = 61"));
  EXPECT_THAT(spoiled([=](auto& m) { m.period = nan; }), HasSubstr("period_s = nan"));
  EXPECT_THAT(spoiled([](auto& m) { m.phase = 1.0; }), HasSubstr("phase = 1: must be >= 0 and < 1"));
  EXPECT_THAT(spoiled([=](auto& m) { m.phase = nan; }), HasSubstr("phase = nan"));
  EXPECT_THAT(spoiled([](auto& m) { m.direction_W = Vec3(0, 0, 2); }), HasSubstr("direction = 2"));
  EXPECT_THAT(spoiled([](auto& m) { m.axis_W = Vec3::Zero(); }), HasSubstr("axis = 0"));
  EXPECT_THROW(OrganMotion(std::vector<OrganMotionParameters>(5), Vec3::Zero()), InputError);
}

TEST(OrganMotion, RefusesAnOrganThatWouldMoveTooFastAloneOrWithItsOtherMotions) {
  OrganMotionParameters heart = organ_motion_preset(OrganMotionKind::kHeartbeat);
  heart.amplitude = 0.05;
  heart.rotation = 0.0;
  heart.period = 0.25;  // 5.625 x 0.05 / 0.25 = 1.125 m/s
  EXPECT_THAT(error_of({heart}), HasSubstr("period_s = 0.25: must be so long"));
  EXPECT_THAT(error_of({heart}), HasSubstr("it would reach 1.125 m/s and 0 rad/s"));
  heart.amplitude = 0.03;  // 0.675 m/s
  EXPECT_EQ(error_of({heart}), "");
  EXPECT_THAT(error_of({heart, heart}), HasSubstr("it would reach 1.35 m/s"));
  heart.amplitude = 0.0;
  heart.rotation = 0.5;  // 5.625 x 0.5 / 0.25 = 11.25 rad/s
  EXPECT_THAT(error_of({heart}), HasSubstr("11.25 rad/s"));
}

}  // namespace
}  // namespace palpate::model
