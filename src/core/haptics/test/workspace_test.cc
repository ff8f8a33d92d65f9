#include "core/haptics/workspace.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate::haptics {
namespace {

constexpr double kPeriod = 1e-3;

DeviceState at(double x, double y, double z, std::uint32_t buttons = 0) {
  DeviceState sample;
  sample.position_D = Vec3(x, y, z);
  sample.buttons = buttons;
  return sample;
}

/// A quarter turn about z: x of the device is y of the world.
Quat quarter_turn() { return {std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)}; }

TEST(Workspace, TranslationIsScaledAndPlacedByTheBase) {
  const WorkspaceMapping mapping{.scale = 2.0, .base = {quarter_turn(), Vec3(0.0, 0.0, 1.0)}};
  const Pose pose = mapping.apply(Vec3(0.1, 0.0, 0.2), Quat::Identity());
  EXPECT_NEAR((pose.position - Vec3(0.0, 0.2, 1.4)).norm(), 0.0, 1e-15);
}

TEST(Workspace, ACommandIsTurnedBackIntoTheDevicesFrameAndNotScaled) {
  const WorkspaceMapping mapping{.scale = 2.0, .base = {quarter_turn(), Vec3(0.0, 0.0, 1.0)}};
  const ForceCommand command = mapping.to_device({Vec3(0.0, 3.0, 1.0), Vec3(0.0, 0.1, 0.0), 0.5});
  EXPECT_NEAR((command.force - Vec3(3.0, 0.0, 1.0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((command.torque - Vec3(0.1, 0.0, 0.0)).norm(), 0.0, 1e-15);
  EXPECT_EQ(command.gripper_force, 0.5);
}

TEST(Workspace, MotionIsTheDevicesOwnWayInTheWorldsAxes) {
  const WorkspaceMapping mapping{.scale = 3.0, .base = {quarter_turn(), Vec3(5.0, 0.0, 0.0)}};
  DeviceTrack track;
  EXPECT_EQ(follow(mapping, track, at(0.1, 0, 0), kPeriod).translation, Vec3::Zero().eval())
      << "nothing is known before the first sample";
  const DeviceMotion motion = follow(mapping, track, at(0.101, 0, 0), kPeriod);
  EXPECT_NEAR((motion.translation - Vec3(0.0, 0.001, 0.0)).norm(), 0.0, 1e-15);
}

TEST(Workspace, RotationIsTheSmallTurnSinceTheLastSampleWhicheverSignTheQuaternionHas) {
  const WorkspaceMapping mapping;
  DeviceTrack track;
  (void)follow(mapping, track, at(0, 0, 0), kPeriod);
  DeviceState turned = at(0, 0, 0);
  const double angle = 1e-3;
  turned.orientation_D = Quat(-std::cos(angle / 2), 0.0, -std::sin(angle / 2), 0.0);
  const DeviceMotion motion = follow(mapping, track, turned, kPeriod);
  EXPECT_NEAR((motion.rotation - Vec3(0.0, angle, 0.0)).norm(), 0.0, 1e-9);
}

TEST(Workspace, AJumpThatNoHandMakesIsNoMotion) {
  const WorkspaceMapping mapping;
  DeviceTrack track;
  (void)follow(mapping, track, at(0, 0, 0), kPeriod);
  EXPECT_EQ(follow(mapping, track, at(0.021, 0, 0), kPeriod).translation, Vec3::Zero().eval());
  EXPECT_NE(follow(mapping, track, at(0.040, 0, 0), kPeriod).translation, Vec3::Zero().eval());
}

TEST(Workspace, WhileTheClutchIsHeldTheToolStaysAndGoesOnFromThere) {
  const WorkspaceMapping mapping{.scale = 2.0, .base = {}, .clutch = 0b100};
  DeviceTrack track;
  const auto tool_x = [&](const DeviceState& sample) {
    (void)follow(mapping, track, sample, kPeriod);
    return mapping.apply(sample.position_D, sample.orientation_D, track.index_D).position.x();
  };
  EXPECT_DOUBLE_EQ(tool_x(at(0.010, 0, 0)), 0.020);
  EXPECT_DOUBLE_EQ(tool_x(at(0.008, 0, 0, 0b100)), 0.020) << "held";
  EXPECT_DOUBLE_EQ(tool_x(at(0.005, 0, 0, 0b111)), 0.020) << "held, with other buttons";
  EXPECT_DOUBLE_EQ(tool_x(at(0.005, 0, 0, 0b011)), 0.020) << "let go: no jump";
  EXPECT_DOUBLE_EQ(tool_x(at(0.006, 0, 0)), 0.022) << "and on from there";
}

TEST(Workspace, WithoutAClutchNoButtonHoldsTheTool) {
  const WorkspaceMapping mapping;
  DeviceTrack track;
  (void)follow(mapping, track, at(0.010, 0, 0), kPeriod);
  (void)follow(mapping, track, at(0.020, 0, 0, ~0U), kPeriod);
  EXPECT_EQ(track.index_D, Vec3::Zero().eval());
}

}  // namespace
}  // namespace palpate::haptics
