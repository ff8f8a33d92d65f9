#include "run/devices/fault_schedule.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::devices {
namespace {

using haptics::DeviceState;
using haptics::Fault;
using scene::EmulatedFault;
using scene::EmulatedFaultKind;

/// A sample whose position encodes its tick.
DeviceState fresh(std::uint64_t tick) {
  DeviceState sample;
  sample.position_D = Vec3(1e-3 * static_cast<double>(tick), 0.02, 0.03);
  sample.velocity_D = Vec3(0.1, 0.0, -0.2);
  return sample;
}

/// Samples of ticks 0 to 99 at 1 kHz with one fault of `kind`, from 50 ms on for `duration` [s].
std::vector<DeviceState> spoiled(EmulatedFaultKind kind, double duration, double age = 8e-3) {
  FaultSchedule schedule({{kind, 0.05, duration, age}}, 1000.0);
  std::vector<DeviceState> samples;
  for (std::uint64_t tick = 0; tick < 100; ++tick) samples.push_back(schedule.with_faults(tick, fresh(tick)));
  return samples;
}

void expect_fresh(const std::vector<DeviceState>& samples, std::uint64_t tick) {
  EXPECT_EQ(samples[tick].position_D, fresh(tick).position_D) << tick;
  EXPECT_EQ(samples[tick].velocity_D, fresh(tick).velocity_D) << tick;
  EXPECT_EQ(samples[tick].age, 0.0) << tick;
  EXPECT_EQ(samples[tick].fault, Fault::kNone) << tick;
}

TEST(FaultSchedule, EveryFaultIsOnForItsTicksOnlyAndOneTickWithoutADuration) {
  for (const scene::EmulatedFaultName& known : scene::emulated_fault_names()) {
    FaultSchedule schedule({{known.kind, 0.05, 0.01, 8e-3}, {known.kind, 0.0701, 0.0, 8e-3}}, 1000.0);
    for (std::uint64_t tick = 0; tick < 100; ++tick) {
      const bool expected = (tick >= 50 && tick < 60) || tick == 71;
      ASSERT_EQ(schedule.is_active(known.kind, tick), expected) << known.name << " " << tick;
      ASSERT_EQ(schedule.first_active(tick).has_value(), expected) << known.name << " " << tick;
    }
    const std::vector<DeviceState> samples = spoiled(known.kind, 0.01);
    expect_fresh(samples, 49);
    expect_fresh(samples, 60);
  }
}

TEST(FaultSchedule, AFrozenDeviceRepeatsTheLastGoodSampleAsItGrowsOld) {
  const auto samples = spoiled(EmulatedFaultKind::kFreeze, 0.02);
  for (std::uint64_t tick = 50; tick < 70; ++tick) {
    EXPECT_EQ(samples[tick].position_D, fresh(49).position_D);
    EXPECT_NEAR(samples[tick].age, 1e-3 * static_cast<double>(tick - 49), 1e-15);
    EXPECT_EQ(samples[tick].fault, Fault::kNone) << "a device that hangs does not say so";
  }
}

TEST(FaultSchedule, AFreezeFromTheFirstTickRepeatsThatTicksSample) {
  FaultSchedule schedule({{EmulatedFaultKind::kFreeze, 0.0, 1.0, 8e-3}}, 1000.0);
  EXPECT_EQ(schedule.with_faults(0, fresh(0)).age, 0.0);
  const DeviceState second = schedule.with_faults(1, fresh(1));
  EXPECT_EQ(second.position_D, fresh(0).position_D);
  EXPECT_EQ(second.age, 1e-3);
}

TEST(FaultSchedule, ADroppedDeviceCannotBeReadAndOneWithItsForceOffSaysSo) {
  EXPECT_EQ(spoiled(EmulatedFaultKind::kDropOut, 0.0)[50].fault, Fault::kDevice);
  EXPECT_EQ(spoiled(EmulatedFaultKind::kForceOff, 0.0)[50].fault, Fault::kForceOff);
}

TEST(FaultSchedule, SpoiledPositionsAreNoNumberOrFarOffOrInMillimetres) {
  const auto nan = spoiled(EmulatedFaultKind::kNotANumber, 0.0);
  EXPECT_TRUE(std::isnan(nan[50].position_D.x()));
  const auto spike = spoiled(EmulatedFaultKind::kSpike, 0.0);
  EXPECT_NEAR(spike[50].position_D.z(), 0.03 - 0.05, 1e-15);
  EXPECT_EQ(spike[50].position_D.x(), 0.05);
  const auto units = spoiled(EmulatedFaultKind::kWrongUnits, 0.0);
  EXPECT_TRUE(units[50].position_D.isApprox(Vec3(50.0, 20.0, 30.0), 1e-12));
  EXPECT_TRUE(units[50].velocity_D.isApprox(Vec3(100.0, 0.0, -200.0), 1e-12));
}

TEST(FaultSchedule, LateSamplesAreThoseOfThenAndSayTheirAge) {
  const auto samples = spoiled(EmulatedFaultKind::kLate, 0.02, 8e-3);
  for (std::uint64_t tick = 50; tick < 70; ++tick) {
    EXPECT_EQ(samples[tick].position_D, fresh(tick - 8).position_D) << tick;
    EXPECT_NEAR(samples[tick].age, 8e-3, 1e-15);
  }
  FaultSchedule early({{EmulatedFaultKind::kLate, 0.0, 1.0, 8e-3}}, 1000.0);
  EXPECT_EQ(early.with_faults(0, fresh(0)).position_D, fresh(0).position_D) << "there is no older one";
}

TEST(FaultSchedule, ARefusingDeviceStillGivesItsSamples) {
  expect_fresh(spoiled(EmulatedFaultKind::kRefuse, 0.01), 55);
}

TEST(FaultSchedule, FaultsAtOneTimeWorkInTheScenesOrder) {
  FaultSchedule schedule(
      {{EmulatedFaultKind::kSpike, 0.0, 1.0, 8e-3}, {EmulatedFaultKind::kWrongUnits, 0.0, 1.0, 8e-3}},
      1000.0);
  EXPECT_NEAR(schedule.with_faults(0, fresh(0)).position_D.z(), 1000.0 * (0.03 - 0.05), 1e-9);
  EXPECT_EQ(schedule.first_active(0), EmulatedFaultKind::kSpike);
}

TEST(FaultSchedule, RefusesTimesDurationsAndAgesThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto made = [](const EmulatedFault& fault) { return FaultSchedule({fault}, 1000.0); };
  EXPECT_THROW(made({EmulatedFaultKind::kLate, -1e-9, 0.0, 8e-3}), ParameterError);
  EXPECT_THROW(made({EmulatedFaultKind::kLate, nan, 0.0, 8e-3}), ParameterError);
  EXPECT_THROW(made({EmulatedFaultKind::kLate, 0.0, -1.0, 8e-3}), ParameterError);
  EXPECT_THROW(made({EmulatedFaultKind::kLate, 0.0, 1e10, 8e-3}), ParameterError);
  EXPECT_THROW(made({EmulatedFaultKind::kLate, 0.0, 0.0, 0.0}), ParameterError);
  EXPECT_THROW(made({EmulatedFaultKind::kLate, 0.0, 0.0, 1.1}), ParameterError);
  EXPECT_NO_THROW(made({EmulatedFaultKind::kLate, 0.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace palpate::devices
