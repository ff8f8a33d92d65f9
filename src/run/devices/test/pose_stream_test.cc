// Poses from a network as samples of the tick, with a clock set by hand.
#include "run/devices/pose_stream.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::devices {
namespace {

using haptics::DeviceState;
using haptics::Fault;
using testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;  // ns

StreamedPose pose_at(double x) { return {Vec3(x, 0.0, 0.0), Quat::Identity(), 0.0}; }

/// Sends a pose every `period_ms`, from `from_ms` on: x = 0.1 m/s times the time.
void stream(PoseStream& poses, std::int64_t from_ms, std::int64_t until_ms, std::int64_t period_ms) {
  for (std::int64_t at = from_ms; at <= until_ms; at += period_ms) {
    ASSERT_EQ(poses.add(pose_at(1e-4 * static_cast<double>(at)), at * kMs), "");
  }
}

TEST(PoseStream, GivesThePoseOfTwoPeriodsAgoAtAConstantVelocity) {
  PoseStream poses;
  stream(poses, 1000, 1200, 20);
  for (const std::int64_t now : {1200, 1207, 1219}) {
    const DeviceState sample = poses.at(now * kMs);
    EXPECT_NEAR(sample.position_D.x(), 1e-4 * static_cast<double>(now - 40), 1e-12) << "40 ms ago";
    EXPECT_NEAR(sample.velocity_D.x(), 0.1, 1e-9);
    EXPECT_EQ(sample.age, 0.0);
    EXPECT_EQ(sample.fault, Fault::kNone);
  }
}

TEST(PoseStream, TheDelayIsFromTenToAHundredMilliseconds) {
  PoseStream fast;
  stream(fast, 1000, 1007, 1);
  EXPECT_EQ(fast.at(1009 * kMs).fault, Fault::kDevice) << "the first pose is only 9 ms old";
  EXPECT_EQ(fast.at(1010 * kMs).fault, Fault::kNone);
  stream(fast, 1008, 1100, 1);
  EXPECT_NEAR(fast.at(1100 * kMs).position_D.x(), 1e-4 * 1090, 5e-4) << "poses within 4 ms are one";
  PoseStream slow;
  stream(slow, 1000, 1800, 80);
  EXPECT_NEAR(slow.at(1800 * kMs).position_D.x(), 1e-4 * 1700, 1e-12);
}

TEST(PoseStream, TurnsOnTheShorterArcAndMovesTheGripper) {
  PoseStream poses;
  for (int i = 0; i < 10; ++i) {
    Quat turned = rotation_about(Vec3::UnitZ(), 0.1 * i);
    if (i % 2 == 1) turned.coeffs() *= -1.0;  // the same orientation
    ASSERT_EQ(poses.add({Vec3::Zero(), turned, 0.1 * i}, i * 20 * kMs), "");
  }
  const DeviceState sample = poses.at(190 * kMs);
  EXPECT_NEAR(sample.orientation_D.angularDistance(rotation_about(Vec3::UnitZ(), 0.75)), 0.0, 1e-7);
  EXPECT_NEAR(sample.gripper, 0.75, 1e-12);
}

TEST(PoseStream, ALateMessageRestsTheToolAndThenMovesItWithoutAJump) {
  PoseStream poses;
  stream(poses, 1000, 1200, 20);
  std::vector<double> x;
  for (std::int64_t now = 1200; now <= 1330; ++now) {
    if (now >= 1280 && now % 20 == 0) stream(poses, now, now, 20);
    const DeviceState sample = poses.at(now * kMs);
    ASSERT_EQ(sample.fault, Fault::kNone) << now;
    ASSERT_EQ(sample.age, 0.0) << now;
    x.push_back(sample.position_D.x());
  }
  EXPECT_NEAR(x[40], 0.120, 1e-12) << "the newest pose, reached after 40 ms";
  EXPECT_EQ(x[79], x[40]) << "at rest there";
  for (std::size_t i = 1; i < x.size(); ++i) {
    EXPECT_GE(x[i], x[i - 1]) << i;
    EXPECT_LE(x[i] - x[i - 1], 2.001e-4 * 1.05) << "8 mm in 40 ms instead of 80 ms, at " << i;
  }
  EXPECT_NEAR(x.back(), 0.129, 1e-12) << "40 ms behind again";
}

TEST(PoseStream, TwoMessagesDeliveredTogetherGiveNoJump) {
  PoseStream poses;
  stream(poses, 1000, 1180, 20);
  ASSERT_EQ(poses.add(pose_at(0.120), 1220 * kMs), "");
  ASSERT_EQ(poses.add(pose_at(0.122), 1220 * kMs + 1), "");
  ASSERT_EQ(poses.add(pose_at(0.124), 1240 * kMs), "");
  double before = poses.at(1219 * kMs).position_D.x();
  for (std::int64_t now = 1220; now <= 1280; ++now) {
    const double x = poses.at(now * kMs).position_D.x();
    EXPECT_LE(x - before, 1.1e-4) << now << ": 0.1 m/s";
    before = x;
  }
  EXPECT_NEAR(before, 0.124, 1e-12);
}

TEST(PoseStream, SilenceIsAStaleSampleAfterAHundredMilliseconds) {
  PoseStream poses;
  stream(poses, 1000, 1200, 20);
  EXPECT_EQ(poses.at(1300 * kMs).age, 0.0);
  const DeviceState stale = poses.at(1301 * kMs);
  EXPECT_NEAR(stale.age, 0.101, 1e-12);
  EXPECT_GT(stale.age, haptics::kStaleAfter);
  EXPECT_NEAR(stale.position_D.x(), 0.120, 1e-12) << "the last pose";
  EXPECT_EQ(stale.velocity_D, Vec3(Vec3::Zero()));
}

TEST(PoseStream, AfterSilenceItLearnsThePeriodAndWaitsForTheDelayAgain) {
  PoseStream poses;
  stream(poses, 1000, 1200, 20);
  (void)poses.at(1200 * kMs);
  for (std::int64_t now = 1400; now < 1600; ++now) {
    if (now % 10 == 0) stream(poses, now, now, 10);
    const DeviceState sample = poses.at(now * kMs);
    if (now < 1470) {
      ASSERT_EQ(sample.fault, Fault::kDevice) << now << ": fewer than 8 poses";
      ASSERT_NEAR(sample.position_D.x(), 0.116, 1e-12) << "as before the silence";
    } else {
      ASSERT_EQ(sample.fault, Fault::kNone) << now;
      ASSERT_NEAR(sample.position_D.x(), 1e-4 * static_cast<double>(now - 20), 1e-9);
    }
  }
}

TEST(PoseStream, ABreakIsAFaultAtOnceAndUntilItHasRestarted) {
  PoseStream poses;
  EXPECT_EQ(poses.at(kMs).fault, Fault::kDevice) << "no pose yet";
  stream(poses, 1000, 1200, 20);
  EXPECT_EQ(poses.at(1200 * kMs).fault, Fault::kNone);
  poses.break_off();
  EXPECT_EQ(poses.at(1201 * kMs).fault, Fault::kDevice);
  stream(poses, 1220, 1340, 20);
  EXPECT_EQ(poses.at(1340 * kMs).fault, Fault::kDevice) << "7 poses";
  stream(poses, 1360, 1360, 20);
  EXPECT_EQ(poses.at(1360 * kMs).fault, Fault::kNone);
}

TEST(PoseStream, UnusablePosesAreRefusedWithTheCauseAndAreAFault) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Quat straight = Quat::Identity();
  const struct {
    StreamedPose pose;
    const char* words;
  } cases[] = {
      {{Vec3(kNan, 0, 0), straight, 0}, "not finite"},
      {{Vec3(0.12, 0, 0), Quat(kNan, 0, 0, 0), 0}, "not finite"},
      {{Vec3(0.12, 0, 0), straight, std::numeric_limits<double>::infinity()}, "not finite"},
      {{Vec3(0.12, 0, 0), Quat(1.02, 0, 0, 0), 0}, "no rotation"},
      {{Vec3(0.12, 0, 0), Quat(0, 0, 0, 0), 0}, "no rotation"},
      {{Vec3(0.12, 0, 5.01), straight, 0}, "5.01 m from the origin"},
      {{Vec3(0.221, 0, 0), straight, 0}, "jumped by 101 mm"},
      {{Vec3(0.12, 0, 0), rotation_about(Vec3::UnitX(), 1.06), 0}, "60 degrees"},
  };
  for (const auto& bad : cases) {
    PoseStream poses;
    stream(poses, 1000, 1200, 20);
    (void)poses.at(1200 * kMs);
    EXPECT_THAT(poses.add(bad.pose, 1205 * kMs), HasSubstr(bad.words));
    const DeviceState sample = poses.at(1206 * kMs);
    EXPECT_EQ(sample.fault, Fault::kDevice) << bad.words;
    EXPECT_TRUE(sample.position_D.allFinite());
    EXPECT_NEAR(sample.position_D.x(), 0.116, 1e-12) << "the last pose without fault";
  }
  PoseStream near;
  stream(near, 1000, 1200, 20);
  EXPECT_EQ(near.add({Vec3(0.219, 0, 0), rotation_about(Vec3::UnitX(), 1.04), 0}, 1220 * kMs), "");
}

TEST(PoseStream, TheSameArrivalsAndTicksGiveTheSameSamples) {
  const auto samples = [] {
    PoseStream poses;
    std::vector<DeviceState> all;
    std::int64_t next = 0;
    for (std::int64_t now = 0; now < 2000; ++now) {
      if (now >= next) {
        const double angle = 1e-3 * static_cast<double>(now);
        (void)poses.add({Vec3(0.05 * std::sin(angle), 0.05 * std::cos(angle), 0.0),
                         rotation_about(Vec3::UnitY(), 0.3 * std::sin(angle)), 0.5},
                        now * kMs + 1234 * (now % 7));
        next = now + 13 + (now * 7919) % 23;
      }
      all.push_back(poses.at(now * kMs + 500'000));
    }
    return all;
  };
  const std::vector<DeviceState> once = samples();
  const std::vector<DeviceState> again = samples();
  for (std::size_t i = 0; i < once.size(); ++i) {
    ASSERT_EQ(once[i].position_D, again[i].position_D) << i;
    ASSERT_EQ(once[i].velocity_D, again[i].velocity_D) << i;
    ASSERT_EQ(once[i].orientation_D.coeffs(), again[i].orientation_D.coeffs()) << i;
    ASSERT_EQ(once[i].fault, again[i].fault) << i;
  }
}

}  // namespace
}  // namespace palpate::devices
