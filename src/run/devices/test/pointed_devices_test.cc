// Mouse and gamepad: the input of a window becomes the smooth motion of a calm hand.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "run/devices/window_device.h"

namespace palpate::devices {
namespace {

constexpr double kRate = 1000.0;

scene::PathRow start_at(const Vec3& position, double gripper = 1.0) {
  scene::PathRow row;
  row.position = position;
  row.orientation = Quat(0.0, 1.0, 0.0, 0.0);
  row.gripper = gripper;
  return row;
}

void say(MouseDevice& mouse, const Vec3& target, double gripper, bool present = true) {
  MouseInput input;
  input.target_D = target;
  input.gripper = gripper;
  input.buttons = 1U;
  input.present = present;
  mouse.input().writable() = input;
  mouse.input().publish();
}

void say(GamepadDevice& pad, const GamepadInput& input) {
  pad.input().writable() = input;
  pad.input().publish();
}

template <typename AnyDevice>
haptics::DeviceState after(AnyDevice& device, std::uint64_t ticks, std::uint64_t from = 0) {
  haptics::DeviceState sample;
  for (std::uint64_t tick = from; tick < from + ticks; ++tick) {
    sample = device.read(tick, static_cast<double>(tick) / kRate);
  }
  return sample;
}

TEST(MouseDevice, StaysWhereItStartsUntilTheWindowSaysMore) {
  MouseDevice mouse(start_at(Vec3(0.01, 0.02, 0.03), 0.5), kRate);
  const haptics::DeviceState sample = after(mouse, 500);
  EXPECT_EQ(sample.position_D, Vec3(0.01, 0.02, 0.03));
  EXPECT_EQ(sample.velocity_D, Vec3(Vec3::Zero()));
  EXPECT_EQ(sample.gripper, 0.5);
  EXPECT_EQ(sample.orientation_D.coeffs(), Quat(0.0, 1.0, 0.0, 0.0).coeffs());
  EXPECT_EQ(sample.fault, haptics::Fault::kNone);
}

TEST(MouseDevice, ArrivesAtItsTargetWithoutPassingItOrHurrying) {
  MouseDevice mouse(start_at(Vec3::Zero()), kRate);
  say(mouse, Vec3(0.0, 0.0, -0.03), 0.0);
  Vec3 before = Vec3::Zero();
  for (std::uint64_t tick = 0; tick < 1000; ++tick) {
    const haptics::DeviceState sample = mouse.read(tick, 0.0);
    EXPECT_LE((sample.position_D - before).norm(), 1.0001 * TargetFollower::kMaxSpeed / kRate);
    EXPECT_NEAR((sample.position_D - before).norm() * kRate, sample.velocity_D.norm(), 1e-9);
    EXPECT_GE(sample.position_D.z(), -0.03 - 1e-6);
    before = sample.position_D;
  }
  EXPECT_NEAR(before.z(), -0.03, 1e-6);
}

TEST(MouseDevice, ItsWayIsTheSameAtEveryRateWithinTwoTenthsOfAMillimetre) {
  MouseDevice slow(start_at(Vec3::Zero()), 100.0);
  MouseDevice fast(start_at(Vec3::Zero()), 10000.0);
  say(slow, Vec3(0.005, 0.0, 0.0), 1.0);
  say(fast, Vec3(0.005, 0.0, 0.0), 1.0);
  for (int hundredth = 0; hundredth < 40; ++hundredth) {
    const Vec3 at_slow = after(slow, 1).position_D;
    const Vec3 at_fast = after(fast, 100).position_D;
    EXPECT_NEAR(at_slow.x(), at_fast.x(), 2e-4);
  }
}

TEST(MouseDevice, ClosesTheJawsInAQuarterOfASecond) {
  MouseDevice mouse(start_at(Vec3::Zero(), 1.0), kRate);
  say(mouse, Vec3::Zero(), 0.0);
  EXPECT_NEAR(after(mouse, 125).gripper, 0.5, 1e-9);
  EXPECT_EQ(after(mouse, 200).gripper, 0.0);
}

TEST(MouseDevice, DrawsFarAndSenselessTargetsInToItsReach) {
  MouseDevice mouse(start_at(Vec3(0.1, 0.0, 0.0)), kRate);
  say(mouse, Vec3(100.0, 0.0, 0.0), 1.0);
  EXPECT_NEAR(after(mouse, 5000).position_D.x(), 0.1 + TargetFollower::kMaxDistance, 1e-6);
  say(mouse, Vec3(std::nan(""), 0.0, 0.0), std::nan(""));
  const haptics::DeviceState sample = after(mouse, 100);
  EXPECT_TRUE(sample.position_D.allFinite());
  EXPECT_EQ(sample.gripper, 1.0);
}

TEST(MouseDevice, TurnsAboutTheHeldPointWhichStaysAndItsVelocityIsThatOfItsPositions) {
  MouseDevice mouse(start_at(Vec3::Zero()), kRate);  // half a turn about x: z of the handle is down
  MouseInput input;
  input.held = Vec3(0.0, 0.0, 0.1);
  input.target_D = Vec3(0.0, 0.0, -0.1);
  input.turns = true;
  input.orientation_D = rotation_about(Vec3::UnitY(), 0.5) * Quat(0.0, 1.0, 0.0, 0.0);
  mouse.input().writable() = input;
  mouse.input().publish();
  Vec3 before = Vec3::Zero();
  Quat turned = Quat(0.0, 1.0, 0.0, 0.0);
  haptics::DeviceState sample;
  for (std::uint64_t tick = 0; tick < 1000; ++tick) {
    sample = mouse.read(tick, 0.0);
    const Vec3 tip = sample.position_D + sample.orientation_D * input.held;
    EXPECT_LT((tip - input.target_D).norm(), 1e-9);
    EXPECT_LE(sample.orientation_D.angularDistance(turned), 1.001 * TargetFollower::kMaxTurnSpeed / kRate);
    EXPECT_NEAR(((sample.position_D - before) * kRate - sample.velocity_D).norm(), 0.0, 1e-3);
    before = sample.position_D;
    turned = sample.orientation_D;
  }
  EXPECT_LT(sample.orientation_D.angularDistance(input.orientation_D), 1e-6);
  EXPECT_NEAR(sample.velocity_D.norm(), 0.0, 1e-6);
}

TEST(MouseDevice, AWindowThatIsGoneIsAFaultInWords) {
  MouseDevice mouse(start_at(Vec3::Zero()), kRate);
  EXPECT_EQ(mouse.last_error(), "");
  say(mouse, Vec3::Zero(), 1.0, false);
  EXPECT_EQ(after(mouse, 1).fault, haptics::Fault::kDevice);
  EXPECT_NE(mouse.last_error().find("window"), std::string::npos);
  EXPECT_EQ(mouse.last_tick(kRate), ~std::uint64_t{0});
  EXPECT_TRUE(mouse.write({}));
}

TEST(GamepadDevice, TheSticksLeadAndTheTriggerPresses) {
  GamepadDevice pad(start_at(Vec3::Zero()), kRate);
  say(pad, {.velocity_D = Vec3(0.02, 0.0, 0.0), .gripper = 1.0});
  after(pad, 1000);
  say(pad, {.advance_D = Vec3(0.0, 0.0, -0.01), .gripper = 0.0});
  haptics::DeviceState sample = after(pad, 1000);
  EXPECT_NEAR(sample.position_D.x(), 0.02, 1e-6);
  EXPECT_NEAR(sample.position_D.z(), -0.01, 1e-6);
  EXPECT_EQ(sample.gripper, 0.0);
  say(pad, {.gripper = 0.0});
  sample = after(pad, 1000);
  EXPECT_NEAR(sample.position_D.z(), 0.0, 1e-6) << "the trigger was let go";
}

TEST(GamepadDevice, UnpluggedItIsAFaultInWordsAndStandsStill) {
  GamepadDevice pad(start_at(Vec3::Zero()), kRate);
  say(pad, {.advance_D = Vec3(0.0, 0.0, -0.01), .gripper = 1.0});
  const Vec3 pressed = after(pad, 1000).position_D;
  GamepadInput lost;
  lost.connected = false;
  say(pad, lost);
  const haptics::DeviceState sample = after(pad, 1000);
  EXPECT_EQ(sample.fault, haptics::Fault::kDevice);
  EXPECT_LT((sample.position_D - pressed).norm(), 1e-6);
  EXPECT_NE(pad.last_error().find("no gamepad is connected"), std::string::npos);
  say(pad, {.gripper = 1.0});
  EXPECT_EQ(after(pad, 1).fault, haptics::Fault::kNone);
  EXPECT_EQ(pad.last_error(), "");
}

TEST(GamepadDevice, TheSticksDoNotLeadOutOfReach) {
  GamepadDevice pad(start_at(Vec3::Zero()), kRate);
  say(pad, {.velocity_D = Vec3(0.1, 0.0, 0.0), .gripper = 1.0});
  after(pad, 10000);
  say(pad, {.velocity_D = Vec3(-0.1, 0.0, 0.0), .gripper = 1.0});
  EXPECT_LT(after(pad, 500).position_D.x(), TargetFollower::kMaxDistance - 0.03) << "it turns round at once";
  EXPECT_EQ(pad.last_tick(kRate), ~std::uint64_t{0});
  EXPECT_TRUE(pad.write({}));
}

}  // namespace
}  // namespace palpate::devices
