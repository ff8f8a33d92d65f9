// Pull: grasping tissue, force of the stretch, release.
#include <gtest/gtest.h>

#include "core/contact/test/rig.h"

namespace palpate::contact::test {
namespace {

constexpr double kGripRadius = 3e-3;
const Vec3 kTouch(0, 0, kGripRadius);

geometry::TriangleMesh plate() { return block(Vec3(60e-3, 60e-3, 20e-3), 0.1); }

void close_slowly(Rig& rig) {
  for (int i = 1; i <= 100; ++i) rig.tick(rig.pose(), 1.0 - 0.01 * i);
}

/// A ball that touches the plate with the gripper open. A tool without jaws grasps by the same rule.
Rig touching() {
  Rig rig(plate(), one_part_tool(geometry::make_ball(kGripRadius, 1280)), plain_tissue());
  rig.tick(place(Vec3(0, 0, 8e-3)), 1.0);
  rig.move_to(kTouch, 20e-3);
  return rig;
}

double pull_law(const Rig& rig, double stretch) { return rig.world().pull_law().force_at(stretch).force; }

TEST(Pull, ClosedAtTouchAndLiftedTheForceIsTheLawsAtTheStretch) {
  Rig rig = touching();
  close_slowly(rig);
  const ToolResult& result = rig.move_to(kTouch + Vec3(0, 0, 4e-3), 10e-3);
  EXPECT_EQ(result.phase, Phase::kPull);
  EXPECT_NEAR(result.force_W.z(), -pull_law(rig, 4e-3), 0.01 * pull_law(rig, 4e-3));
  EXPECT_NEAR(result.depth, 4e-3, 1e-6);
}

TEST(Pull, SidewaysTheForceIsAlongTheStretch) {
  Rig rig = touching();
  close_slowly(rig);
  const ToolResult& result = rig.move_to(kTouch + Vec3(3e-3, 0, 4e-3), 10e-3);
  EXPECT_NEAR(result.force_W.norm(), pull_law(rig, 5e-3), 0.01 * pull_law(rig, 5e-3));
  EXPECT_NEAR(result.force_W.x() / result.force_W.z(), 0.75, 1e-3);
}

TEST(Pull, OpenedTheForceIsGoneWithin40Milliseconds) {
  Rig rig = touching();
  close_slowly(rig);
  rig.move_to(kTouch + Vec3(0, 0, 6e-3), 10e-3);
  StepMeter meter;
  rig.each_tick([&](const ToolResult& result) { meter(result); });
  for (int i = 0; i < 40; ++i) rig.tick(rig.pose(), 1.0);
  EXPECT_EQ(rig.result().force_W, Vec3::Zero());
  EXPECT_EQ(rig.result().phase, Phase::kApproach);
  EXPECT_LT(meter.force_step(), 0.10);
}

TEST(Pull, PastTheGripsLimitItLetsGoWithoutAStepAndStaysOffUntilOpened) {
  Rig rig = touching();
  close_slowly(rig);
  StepMeter meter;
  rig.each_tick([&](const ToolResult& result) { meter(result); });
  const ToolResult& result = rig.move_to(Vec3(0, 0, 45e-3), 20e-3);
  EXPECT_GT(meter.peak_force(), 0.9 * rig.world().tissue().contact.grip_limit);
  EXPECT_LE(meter.peak_force(), rig.world().tissue().contact.grip_limit);
  EXPECT_LT(meter.force_step(), 0.10);
  EXPECT_EQ(result.force_W, Vec3::Zero());
  EXPECT_EQ(result.status & kGripReleased, kGripReleased);
}

TEST(Pull, ClosedAwayFromTheOrganNothingIsHeld) {
  Rig rig = touching();
  rig.move_to(kTouch + Vec3(0, 0, 1.5e-3), 20e-3);
  close_slowly(rig);
  EXPECT_EQ(rig.move_to(kTouch + Vec3(0, 0, 6e-3), 20e-3).force_W, Vec3::Zero());
}

TEST(Pull, ClosedFromTheStartThereIsNoClosingAndSoNoHold) {
  Rig rig(plate(), one_part_tool(geometry::make_ball(kGripRadius, 1280)), plain_tissue());
  rig.tick(place(Vec3(0, 0, 8e-3)), 0.0);
  rig.move_to(kTouch + Vec3(0, 0, -1e-3), 20e-3);
  EXPECT_EQ(rig.result().phase, Phase::kPress);
  EXPECT_EQ(rig.move_to(kTouch + Vec3(0, 0, 4e-3), 20e-3).force_W, Vec3::Zero());
}

TEST(Pull, JawsThatHoldPressNothingAndPressAgainAfterLettingGo) {
  Rig rig = touching();
  rig.move_to(kTouch + Vec3(0, 0, -3e-3), 20e-3);
  const double press = rig.hold(0.1).force_W.z();
  ASSERT_GT(press, 0.0);
  StepMeter meter;
  rig.each_tick([&](const ToolResult& result) { meter(result); });
  close_slowly(rig);
  rig.hold(0.05);
  EXPECT_EQ(rig.result().force_W, Vec3::Zero());  // held without stretch
  for (int i = 0; i < 100; ++i) rig.tick(rig.pose(), 1.0);
  EXPECT_NEAR(rig.result().force_W.z(), press, 1e-9);
  EXPECT_LT(meter.force_step(), 0.10);
}

TEST(Pull, TwoJawsHoldTogetherAndTheTorqueIsTheAnchorsLever) {
  geometry::Tool tool;
  for (const double side : {-1.0, 1.0}) {
    geometry::ToolPart jaw;
    jaw.name = side < 0.0 ? "left" : "right";
    jaw.is_jaw = true;
    jaw.mesh = moved(geometry::make_box(Vec3(4e-3, 4e-3, 20e-3), 2e-3), Vec3(2.1e-3 * side, 0, -10e-3));
    jaw.open_angle = -0.2 * side;  // the lower ends swing apart
    tool.parts.push_back(jaw);
  }
  Rig rig(plate(), tool, plain_tissue());
  rig.tick(place(Vec3(5e-3, 0, 25e-3)), 1.0);
  rig.move_to(Vec3(5e-3, 0, 20.2e-3), 20e-3);
  close_slowly(rig);
  const ToolResult& result = rig.move_to(Vec3(5e-3, 2e-3, 24e-3), 10e-3);
  EXPECT_EQ(result.phase, Phase::kPull);
  const Vec3 lever(0.0, 0.0, -20.2e-3);  // the displaced anchor, below the handle
  const Vec3 torque = lever.cross(result.force_W);
  EXPECT_LT((result.torque_W - torque).norm(), 0.02 * torque.norm());
}

}  // namespace
}  // namespace palpate::contact::test
