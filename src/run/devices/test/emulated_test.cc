#include "run/devices/emulated.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::devices {
namespace {

using haptics::DeviceState;
using haptics::Fault;
using scene::EmulatedFaultKind;
using testing::HasSubstr;

constexpr double kEmulatedRate = 1000.0;

scene::PathRow row_at(double time, const Vec3& position, double gripper = 0.0) {
  return {time, position, Quat::Identity(), gripper};
}

scene::ToolPath still_at(const Vec3& position) { return scene::ToolPath({row_at(0.0, position)}); }

scene::DeviceSetup emulated() {
  scene::DeviceSetup setup;
  setup.kind = "emulated";
  return setup;
}

scene::DeviceSetup with_fault(EmulatedFaultKind kind, double time, double duration) {
  scene::DeviceSetup setup = emulated();
  setup.emulated.faults.push_back({kind, time, duration, 8e-3});
  return setup;
}

/// Runs ticks `from` to `to` - 1 under a constant force. @return the last sample
DeviceState run(EmulatedDevice& device, std::uint64_t from, std::uint64_t to,
                const Vec3& force = Vec3::Zero()) {
  DeviceState last;
  for (std::uint64_t tick = from; tick < to; ++tick) {
    last = device.read(tick, static_cast<double>(tick) / kEmulatedRate);
    (void)device.write({force, Vec3::Zero(), 0.0});
  }
  return last;
}

TEST(EmulatedDevice, WithoutForceItFollowsItsPathToWithinFrictionOverStiffness) {
  EmulatedDevice device(scene::ToolPath({row_at(0.0, Vec3(0, 0, 0.05)), row_at(1.0, Vec3(0, 0.01, 0.02))}),
                        emulated(), kEmulatedRate);
  EXPECT_EQ(run(device, 0, 1).position_D, Vec3(0, 0, 0.05));
  const DeviceState end = run(device, 1, 3000);
  const double slack = scene::kEmulatedFriction / scene::kFirmGrip.stiffness;
  EXPECT_NEAR((end.position_D - Vec3(0, 0.01, 0.02)).norm(), 0.0, slack + scene::kEmulatedResolution);
  EXPECT_EQ(device.hand().velocity(), Vec3::Zero()) << "friction holds it";
}

TEST(EmulatedDevice, AForceMovesTheHandByForceOverStiffness) {
  for (const scene::HandGrip& grip : {scene::kLightGrip, scene::kFirmGrip}) {
    scene::DeviceSetup setup = emulated();
    setup.emulated.grip = grip;
    EmulatedDevice device(still_at(Vec3(0, 0, 0.03)), setup, kEmulatedRate);
    const DeviceState end = run(device, 0, 10000, Vec3(0, 0, 1.0));
    EXPECT_NEAR(end.position_D.z(), 0.03 + 1.0 / grip.stiffness,
                scene::kEmulatedFriction / grip.stiffness + scene::kEmulatedResolution);
  }
}

TEST(EmulatedDevice, TheForceOfATickActsFromThatTickOn) {
  EmulatedDevice device(still_at(Vec3::Zero()), emulated(), kEmulatedRate);
  (void)device.read(0, 0.0);
  EXPECT_TRUE(device.write({Vec3(0, 0, 1.0), Vec3::Zero(), 0.0}));
  EXPECT_EQ(device.hand().position().z(), 0.0);
  (void)device.read(1, 1e-3);
  EXPECT_GT(device.hand().position().z(), 0.0);
  const Vec3 place = device.hand().position();
  (void)device.read(1, 1e-3);
  EXPECT_EQ(device.hand().position(), place) << "one tick, one move";
}

TEST(EmulatedDevice, ReadsItsPositionInStepsOfTheEncoder) {
  scene::DeviceSetup setup = emulated();
  setup.dynamics.resolution = 0.1e-3;
  EmulatedDevice device(scene::ToolPath({row_at(0.0, Vec3::Zero()), row_at(1.0, Vec3(0.013, -0.007, 0.003))}),
                        setup, kEmulatedRate);
  for (std::uint64_t tick = 0; tick < 1000; ++tick) {
    const DeviceState sample = run(device, tick, tick + 1);
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = sample.position_D(axis) / 0.1e-3;
      ASSERT_NEAR(steps, std::round(steps), 1e-9);
      ASSERT_LE(std::abs(sample.position_D(axis) - device.hand().position()(axis)), 0.05e-3 * (1 + 1e-9));
    }
  }
}

TEST(EmulatedDevice, WithoutAnEncoderItReadsTheTruth) {
  scene::DeviceSetup setup = emulated();
  setup.dynamics.resolution = 0.0;
  EmulatedDevice device(still_at(Vec3::Zero()), setup, kEmulatedRate);
  for (std::uint64_t tick = 0; tick < 100; ++tick) {
    ASSERT_EQ(run(device, tick, tick + 1, Vec3(0.2, 0.3, 1.0)).position_D, device.hand().position());
  }
}

TEST(EmulatedDevice, ItsVelocityIsTheFilteredDifferenceOfItsReadings) {
  scene::DeviceSetup setup = emulated();
  setup.dynamics.friction = 0.0;
  EmulatedDevice device(scene::ToolPath({row_at(0.0, Vec3::Zero()), row_at(10.0, Vec3(0.2, 0, 0))}), setup,
                        kEmulatedRate);
  Vec3 reading = run(device, 0, 1).position_D;
  Vec3 filtered = Vec3::Zero();
  double mean = 0.0;
  for (std::uint64_t tick = 1; tick < 3000; ++tick) {
    const DeviceState sample = run(device, tick, tick + 1);
    filtered =
        5.0 / 6.0 * filtered + 1.0 / 6.0 * (sample.position_D - reading) * kEmulatedRate;  // 5 ms at 1 kHz
    reading = sample.position_D;
    ASSERT_NEAR((sample.velocity_D - filtered).norm(), 0.0, 1e-12) << tick;
    if (tick >= 2000) mean += sample.velocity_D.x() / 1000.0;
  }
  EXPECT_NEAR(mean, 0.02, 1e-4);
}

TEST(EmulatedDevice, OrientationAndGripperAreThePathsOwn) {
  const Quat turned = rotation_from_degrees(Vec3(0, 90, 0));
  EmulatedDevice device(scene::ToolPath({row_at(0.0, Vec3::Zero(), 1.0), {1.0, Vec3::Zero(), turned, 0.0}}),
                        emulated(), kEmulatedRate);
  (void)device.read(0, 0.0);
  EXPECT_TRUE(device.write({Vec3::Zero(), Vec3(0.1, 0.2, 0.3), 1.0}));
  const DeviceState sample = device.read(500, 0.5);
  EXPECT_EQ(sample.gripper, 0.5);
  EXPECT_NEAR(sample.orientation_D.angularDistance(rotation_from_degrees(Vec3(0, 45, 0))), 0.0, 1e-9);
}

TEST(EmulatedDevice, TheSameCommandsGiveTheSameBits) {
  const scene::ToolPath path({row_at(0.0, Vec3::Zero()), row_at(1.0, Vec3(0.01, 0.02, -0.03))});
  EmulatedDevice one(path, emulated(), kEmulatedRate);
  EmulatedDevice other(path, emulated(), kEmulatedRate);
  for (std::uint64_t tick = 0; tick < 1500; ++tick) {
    const Vec3 force(std::sin(0.01 * static_cast<double>(tick)), 0.3, tick % 7 == 0 ? 2.0 : 0.0);
    const DeviceState a = run(one, tick, tick + 1, force);
    const DeviceState b = run(other, tick, tick + 1, force);
    ASSERT_EQ(a.position_D, b.position_D);
    ASSERT_EQ(a.velocity_D, b.velocity_D);
  }
}

TEST(EmulatedDevice, StopTakesTheForceAwayUntilTheNextCommand) {
  EmulatedDevice device(still_at(Vec3::Zero()), emulated(), kEmulatedRate);
  run(device, 0, 10, Vec3(0, 0, 2.0));
  EXPECT_EQ(device.force_on_hand(), Vec3(0, 0, 2.0));
  device.stop();
  device.stop();
  EXPECT_EQ(device.force_on_hand(), Vec3::Zero());
  EXPECT_TRUE(device.write({Vec3(0, 0, 0.5), Vec3::Zero(), 0.0}));
  EXPECT_EQ(device.force_on_hand(), Vec3(0, 0, 0.5));
}

TEST(EmulatedDevice, ARefusedCommandLeavesTheLastForceUntilItsOwnWatchdogLetsGo) {
  EmulatedDevice device(still_at(Vec3::Zero()), with_fault(EmulatedFaultKind::kRefuse, 0.1, 0.05),
                        kEmulatedRate);
  run(device, 0, 100, Vec3(0, 0, 1.0));
  for (std::uint64_t tick = 100; tick < 150; ++tick) {
    (void)device.read(tick, static_cast<double>(tick) / kEmulatedRate);
    ASSERT_FALSE(device.write({Vec3(0, 0, 3.0), Vec3::Zero(), 0.0})) << tick;
    ASSERT_EQ(device.force_on_hand(), tick < 110 ? Vec3(0, 0, 1.0) : Vec3(Vec3::Zero())) << tick;
  }
  run(device, 150, 151, Vec3(0, 0, 0.25));
  EXPECT_EQ(device.force_on_hand(), Vec3(0, 0, 0.25));
}

TEST(EmulatedDevice, WithItsForceOffNoCommandReachesTheHand) {
  EmulatedDevice device(still_at(Vec3::Zero()), with_fault(EmulatedFaultKind::kForceOff, 0.1, 0.05),
                        kEmulatedRate);
  run(device, 0, 100, Vec3(0, 0, 1.0));
  EXPECT_EQ(device.force_on_hand(), Vec3(0, 0, 1.0));
  EXPECT_EQ(run(device, 100, 101, Vec3(0, 0, 1.0)).fault, Fault::kForceOff);
  EXPECT_EQ(device.force_on_hand(), Vec3::Zero());
  EXPECT_EQ(run(device, 101, 151, Vec3(0, 0, 1.0)).fault, Fault::kNone);
  EXPECT_EQ(device.force_on_hand(), Vec3(0, 0, 1.0));
}

TEST(EmulatedDevice, AFaultSpoilsWhatItSaysAndNotWhereTheHandIs) {
  EmulatedDevice good(still_at(Vec3(0, 0, 0.02)), emulated(), kEmulatedRate);
  EmulatedDevice bad(still_at(Vec3(0, 0, 0.02)), with_fault(EmulatedFaultKind::kSpike, 0.1, 0.0),
                     kEmulatedRate);
  for (std::uint64_t tick = 0; tick < 200; ++tick) {
    const DeviceState a = run(good, tick, tick + 1, Vec3(0, 0, 0.7));
    const DeviceState b = run(bad, tick, tick + 1, Vec3(0, 0, 0.7));
    ASSERT_EQ(good.hand().position(), bad.hand().position());
    ASSERT_EQ(a.position_D == b.position_D, tick != 100) << tick;
  }
}

TEST(EmulatedDevice, SaysWhichFaultItHadLast) {
  EmulatedDevice device(still_at(Vec3::Zero()), with_fault(EmulatedFaultKind::kDropOut, 0.1, 0.0),
                        kEmulatedRate);
  run(device, 0, 100);
  EXPECT_EQ(device.last_error(), "");
  run(device, 100, 200);
  EXPECT_THAT(device.last_error(), HasSubstr("\"drop-out\""));
}

TEST(EmulatedDevice, EndsHalfASecondAfterThePathsLastRow) {
  const EmulatedDevice device(scene::ToolPath({row_at(0.0, Vec3::Zero()), row_at(1.2, Vec3::Zero())}),
                              emulated(), kEmulatedRate);
  EXPECT_EQ(device.last_tick(1000.0), 1700U);
  EXPECT_EQ(device.last_tick(4000.0), 6800U);
}

TEST(EmulatedDevice, RefusesFiguresOutOfTheirRange) {
  const auto made = [](void (*spoil)(scene::DeviceSetup&)) {
    scene::DeviceSetup setup = emulated();
    spoil(setup);
    return EmulatedDevice(still_at(Vec3::Zero()), setup, kEmulatedRate).last_error();
  };
  EXPECT_THROW(made([](scene::DeviceSetup& s) { s.emulated.mass = 0.0; }), ParameterError);
  EXPECT_THROW(made([](scene::DeviceSetup& s) { s.emulated.mass = std::nan(""); }), ParameterError);
  EXPECT_THROW(made([](scene::DeviceSetup& s) { s.emulated.grip.stiffness = -1.0; }), ParameterError);
  EXPECT_THROW(made([](scene::DeviceSetup& s) { s.emulated.grip.damping = -1.0; }), ParameterError);
  EXPECT_THROW(made([](scene::DeviceSetup& s) { s.dynamics.damping = -1.0; }), ParameterError);
  EXPECT_THROW(made([](scene::DeviceSetup& s) { s.dynamics.friction = HUGE_VAL; }), ParameterError);
  EXPECT_THROW(made([](scene::DeviceSetup& s) { s.dynamics.resolution = -1e-6; }), ParameterError);
  EXPECT_THROW(made([](scene::DeviceSetup& s) {
                 s.emulated.faults = {{EmulatedFaultKind::kLate, 0.0, 0.0, 2.0}};
               }),
               ParameterError);
}

}  // namespace
}  // namespace palpate::devices
