// A held device: the soft start, faults and the return of the force after a fault.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/haptics/simulation.h"
#include "core/haptics/test/test_world.h"

namespace palpate::realtime {
namespace {

constexpr double kHeldNaN = std::numeric_limits<double>::quiet_NaN();

/// One held device with a 3 mm ball over the block.
struct HeldBench {
  explicit HeldBench(double rate = 1000.0)
      : world(haptics::test::block_and_balls(1, rate, haptics::test::no_noise())),
        rate_Hz(rate),
        state(world) {
    world.mappings[0].held = true;
    world.mappings[0].clutch = 1U;
    at_height(0.010);
  }

  void at_height(double z) { sample.position_D = Vec3(0.001, 0.002, haptics::test::kBallRadius + z); }

  void step() {
    haptics::tick(world, state, number++, {&sample, 1}, {&command, 1}, {&row, 1});
    sample.events = 0;
  }

  void wait(double seconds) {
    const auto ticks = static_cast<int>(std::lround(seconds * rate_Hz));
    for (int i = 0; i < ticks; ++i) step();
  }

  /// Moves the ball straight to the height z [m] at 20 mm/s.
  void go_to(double z) {
    const double from = sample.position_D.z() - haptics::test::kBallRadius;
    const auto ticks = static_cast<int>(std::ceil(std::abs(z - from) / 0.020 * rate_Hz));
    for (int i = 1; i <= ticks; ++i) {
      at_height(from + (z - from) * i / ticks);
      step();
    }
  }

  /// Completes the soft start and presses 5 mm deep.
  void press() {
    wait(1.0);
    go_to(-0.005);
  }

  [[nodiscard]] double force() const { return command.force.norm(); }

  haptics::SimulationWorld world;
  double rate_Hz;
  haptics::SimulationState state;
  haptics::DeviceState sample;
  haptics::ForceCommand command;
  haptics::TickRow row;
  std::uint64_t number = 0;
};

TEST(HeldDevice, IsFeltAfterStillnessAndARampAndNotBefore) {
  HeldBench early;
  early.go_to(-0.005);
  early.wait(2.0);
  EXPECT_EQ(early.force(), 0.0) << "taken straight into the tissue";
  EXPECT_GT(early.row.tissue_force, 0.05);
  EXPECT_EQ(early.row.engagement, 0.0);
  HeldBench ready;
  ready.press();
  EXPECT_EQ(ready.row.engagement, 1.0);
  EXPECT_NEAR(ready.force(), ready.row.tissue_force, 1e-12);
  EXPECT_GT(ready.force(), 0.05);
}

TEST(HeldDevice, ADeviceThatNobodyHoldsIsEngagedFromTheStart) {
  HeldBench bench;
  bench.world.mappings[0].held = false;
  bench.go_to(-0.005);
  EXPECT_EQ(bench.row.engagement, 1.0);
  EXPECT_GT(bench.force(), 0.05);
}

struct FaultCase {
  const char* what;
  haptics::Fault fault;
  std::function<void(haptics::DeviceState&)> spoil;
};

std::vector<FaultCase> all_faults() {
  return {
      {"position not finite", haptics::Fault::kNotFinite,
       [](haptics::DeviceState& s) { s.position_D.x() = kHeldNaN; }},
      {"age not finite", haptics::Fault::kNotFinite, [](haptics::DeviceState& s) { s.age = kHeldNaN; }},
      {"unreadable", haptics::Fault::kDevice,
       [](haptics::DeviceState& s) { s.fault = haptics::Fault::kDevice; }},
      {"no new sample for 6 ms", haptics::Fault::kStale, [](haptics::DeviceState& s) { s.age = 6e-3; }},
      {"stalled loop", haptics::Fault::kStalled,
       [](haptics::DeviceState& s) { s.fault = haptics::Fault::kStalled; }},
      {"force off", haptics::Fault::kForceOff,
       [](haptics::DeviceState& s) { s.fault = haptics::Fault::kForceOff; }},
  };
}

TEST(HeldDevice, EveryFaultTakesTheForceToZeroWithinTenMillisecondsAtEveryRateAndLatches) {
  for (const double rate : {1000.0, 2000.0, 4000.0, 10'000.0}) {
    for (const FaultCase& fault : all_faults()) {
      HeldBench bench(rate);
      bench.press();
      const double before = bench.force();
      ASSERT_GT(before, 0.05) << fault.what;
      const haptics::DeviceState good = bench.sample;
      fault.spoil(bench.sample);
      bench.step();
      EXPECT_EQ(bench.row.fault, static_cast<std::uint32_t>(fault.fault)) << fault.what;
      bench.sample = good;
      double last = before;
      for (int i = 0; i < static_cast<int>(haptics::kFaultFall * rate); ++i) {
        EXPECT_LE(bench.force(), last) << fault.what;
        last = bench.force();
        bench.step();
      }
      EXPECT_EQ(bench.force(), 0.0) << fault.what << " at " << rate << " Hz";
      bench.wait(0.2);
      EXPECT_EQ(bench.force(), 0.0) << "latched though the samples are good again";
      EXPECT_EQ(bench.row.fault, static_cast<std::uint32_t>(fault.fault));
    }
  }
}

TEST(HeldDevice, AfterAResetTheForceComesBackOnlyOutsideStillAndByTheRamp) {
  for (const FaultCase& fault : all_faults()) {
    HeldBench bench;
    bench.press();
    const haptics::DeviceState good = bench.sample;
    fault.spoil(bench.sample);
    bench.step();
    bench.sample = good;
    bench.wait(0.05);
    bench.sample.events = haptics::kResetFault;
    bench.step();
    EXPECT_EQ(bench.row.fault, 0U) << fault.what;
    EXPECT_EQ(bench.row.events, haptics::kResetFault);
    bench.wait(2.0);
    EXPECT_EQ(bench.force(), 0.0) << fault.what << ": still inside, so nothing comes back";
    bench.go_to(0.010);
    bench.wait(1.0);
    double last = 0.0;
    bench.go_to(-0.001);
    for (int i = 0; i < 200; ++i) {
      bench.at_height(-0.001 - 2e-5 * i);
      bench.step();
      EXPECT_LT(bench.force() - last, 0.05) << "no jump";
      last = bench.force();
    }
    EXPECT_GT(last, 0.05) << fault.what << ": felt again";
  }
}

TEST(HeldDevice, AResetWhileTheDeviceIsStillBrokenLatchesAgain) {
  HeldBench bench;
  bench.press();
  bench.sample.fault = haptics::Fault::kForceOff;
  bench.wait(0.1);
  bench.sample.events = haptics::kResetFault;
  bench.step();
  EXPECT_EQ(bench.row.fault, static_cast<std::uint32_t>(haptics::Fault::kForceOff));
  EXPECT_EQ(bench.force(), 0.0);
}

TEST(HeldDevice, AFiniteJumpInPositionIsLimitedAndNoFault) {
  HeldBench bench;
  bench.press();
  Vec3 last = bench.command.force;
  for (const double z : {-0.012, 0.5, -0.030, 0.02, -0.005}) {
    bench.at_height(z);
    bench.step();
    EXPECT_EQ(bench.row.fault, 0U);
    EXPECT_LE((bench.command.force - last).norm(), bench.world.limits.force_step * (1 + 1e-12));
    last = bench.command.force;
  }
}

TEST(HeldDevice, PositionsInTheWrongUnitAreADeviceFaultWhenNoHandReachesThatFar) {
  HeldBench bench;
  bench.press();
  bench.sample.position_D = Vec3(120.0, -85.0, 110.0);  // mm where m are expected
  bench.step();
  EXPECT_EQ(bench.row.fault, static_cast<std::uint32_t>(haptics::Fault::kDevice));
}

TEST(HeldDevice, TheClutchInsideTheTissueLetsGoAndAsksForStillnessOutside) {
  HeldBench bench;
  bench.press();
  ASSERT_GT(bench.force(), 0.05);
  bench.sample.buttons = 1U;
  double last = bench.force();
  for (int i = 0; i < 60; ++i) {
    bench.step();
    EXPECT_LE(bench.force(), last + 1e-12);
    last = bench.force();
  }
  EXPECT_EQ(bench.force(), 0.0);
  bench.sample.buttons = 0U;
  bench.wait(2.0);
  EXPECT_EQ(bench.force(), 0.0);
}

TEST(HeldDevice, ItsRowsRunAgainBitForBitThroughFaultsResetsAndTheClutch) {
  HeldBench bench;
  HeldBench again;
  std::mt19937_64 random(17);
  const std::vector<FaultCase> faults = all_faults();
  double z = 0.010;
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t dice = random();
    if (i > 1000) z += dice % 2 == 0 ? -4e-5 : 3.9e-5;
    bench.at_height(std::clamp(z, -0.008, 0.012));
    haptics::DeviceState sample = bench.sample;
    if (dice % 997 == 0) faults[(dice >> 20) % faults.size()].spoil(sample);
    sample.buttons = (dice >> 32) % 512 == 0 ? 1U : 0U;
    sample.events = (dice >> 42) % 256 == 0 ? haptics::kResetFault : 0U;
    bench.sample = sample;
    bench.step();
    again.sample = haptics::sample_of(bench.row);
    again.step();
    ASSERT_TRUE(haptics::test::same_bits(bench.row, again.row)) << i;
    bench.sample = sample;
    bench.sample.fault = haptics::Fault::kNone;
    bench.sample.age = 0.0;
  }
}

TEST(HeldDevice, ADeviceWithoutTorqueIsAskedForNone) {
  HeldBench with;
  HeldBench without;
  without.world.mappings[0].torque = false;
  for (HeldBench* bench : {&with, &without}) {
    bench->wait(1.0);
    bench->sample.orientation_D = rotation_from_degrees(Vec3(0, 30, 0));
    bench->go_to(-0.005);
  }
  EXPECT_GT(with.command.torque.norm(), 1e-6) << "friction on the ball";
  EXPECT_EQ(without.command.torque, Vec3::Zero().eval());
  EXPECT_EQ(without.command.force, with.command.force);
}

TEST(HeldDevice, TheRowSaysWhatTheHandHasPutIn) {
  HeldBench bench;
  bench.world.mappings[0].base.rotation = rotation_from_degrees(Vec3(0, 0, 90));
  bench.press();
  // A slow motion down to 5 mm: the work is about the integral of the force over the depth.
  const model::LayeredSpringLaw law(model::tissue_preset("gallbladder"), model::Direction::kPress, 1e-3);
  double work = 0.0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) work += law.force_at(0.005 * (i + 0.5) / kSteps).force * 0.005 / kSteps;
  EXPECT_NEAR(bench.row.energy, work, 0.25 * work) << "damping adds a little";
  EXPECT_GT(bench.row.energy, work * 0.95);
  bench.go_to(0.005);
  EXPECT_EQ(bench.row.energy, 0.0) << "outside nothing is stored";
}

}  // namespace
}  // namespace palpate::realtime
