// Each fault of an emulated device, and the force on the hand. The hand presses a block with more than 0.2 N
// when the fault comes. It presses again after a reset.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "run/devices/test/emulated_scene.h"
#include "run/devices/test/safety_line.h"

namespace palpate::devices {
namespace {

using haptics::Fault;
using haptics::TickRow;
using scene::EmulatedFaultKind;

constexpr double kFaultTime = 2.5;  // s
constexpr std::uint64_t kFaultTick = 2500;
constexpr std::uint64_t kReset = 5500;         // tick; the tool is outside again
constexpr std::uint64_t kPressedAgain = 8500;  // tick
constexpr std::uint64_t kLastTick = 9500;
constexpr std::uint64_t kNever = ~std::uint64_t{0};

/// Path: outside and still until 1 s, 10 mm in the block from 2 s to 4 s, outside at 5 s, still until 7 s, in
/// the block again from 8 s.
scene::ToolPath press_twice() {
  return test::heights({{0.0, 8e-3},
                        {1.0, 8e-3},
                        {2.0, -10e-3},
                        {4.0, -10e-3},
                        {5.0, 8e-3},
                        {7.0, 8e-3},
                        {8.0, -10e-3},
                        {9.0, -10e-3}});
}

struct Outcome {
  std::vector<TickRow> rows;
  std::vector<Vec3> felt;
  std::uint64_t latched = kNever;  // first tick with a fault
  std::uint64_t zero = kNever;     // first tick without force from the latched fault on
};

Outcome run_with(EmulatedFaultKind kind, double duration, std::vector<std::uint64_t> resets) {
  const scene::Scene scene = test::block_and_hand({{kind, kFaultTime, duration, 8e-3}});
  EmulatedDevice device(press_twice(), scene.devices[0], scene.rate_Hz);
  test::WithResets user(device, std::move(resets));
  Outcome outcome;
  outcome.rows = test::run_through(scene, user);
  outcome.felt = std::move(user.felt);
  for (const TickRow& row : outcome.rows) {
    if (row.fault == 0) continue;
    if (outcome.latched == kNever) outcome.latched = row.tick;
    if (outcome.zero == kNever && test::force_of(row).norm() == 0.0) outcome.zero = row.tick;
  }
  return outcome;
}

struct Case {
  EmulatedFaultKind kind;
  double duration;              // s
  Fault cause;                  // kNone: no fault, the jump is limited
  std::uint64_t latched_after;  // ticks from the first bad sample
  const char* injected;
};

bool jumps(EmulatedFaultKind kind) {
  return kind == EmulatedFaultKind::kSpike || kind == EmulatedFaultKind::kWrongUnits;
}

void expect_within_limits(const std::vector<TickRow>& rows) {
  Vec3 last = Vec3::Zero();
  for (const TickRow& row : rows) {
    const Vec3 force = test::force_of(row);
    ASSERT_TRUE(force.allFinite()) << row.tick;
    ASSERT_LE(force.norm(), 20.0) << row.tick;
    ASSERT_LE((force - last).norm(), 5.0 * (1 + 1e-12)) << row.tick;
    last = force;
  }
}

/// Expects that the force falls to zero, stays zero until the reset and returns through the force ramp only.
void expect_zero_and_recovery(const Case& bad, const Outcome& outcome) {
  ASSERT_EQ(outcome.latched, kFaultTick + bad.latched_after);
  ASSERT_LE(outcome.zero, outcome.latched + 10) << "10 ms at 1 kHz";
  for (std::uint64_t tick = outcome.latched; tick < kReset; ++tick) {
    ASSERT_EQ(outcome.rows[tick].fault, static_cast<std::uint32_t>(bad.cause)) << tick;
    if (tick >= outcome.zero) {
      ASSERT_EQ(test::force_of(outcome.rows[tick]).norm(), 0.0) << tick;
      ASSERT_EQ(outcome.felt[tick].norm(), 0.0) << tick;
    }
  }
  double largest_step = 0.0;
  for (std::uint64_t tick = kReset; tick < kLastTick; ++tick) {
    ASSERT_EQ(outcome.rows[tick].fault, 0U) << tick;
    largest_step = std::max(
        largest_step, (test::force_of(outcome.rows[tick]) - test::force_of(outcome.rows[tick - 1])).norm());
  }
  EXPECT_LT(largest_step, 0.1) << "N a tick: noise and tissue only, never a jump";
  EXPECT_GT(outcome.rows[kPressedAgain].tissue_force, 0.2);
  EXPECT_GT(test::force_of(outcome.rows[kPressedAgain]).norm(), 0.15);
}

/// Expects no fault. After a jump the tissue force is zero until the tool has been outside. Without a jump it
/// continues.
void expect_limited_and_unharmed(const Case& bad, const Outcome& outcome) {
  ASSERT_EQ(outcome.latched, kNever);
  for (std::uint64_t tick = kFaultTick; tick < kFaultTick + 1000; ++tick) {
    ASSERT_EQ(outcome.rows[tick].tissue_force > 0.2, !jumps(bad.kind)) << tick;
  }
  EXPECT_GT(test::force_of(outcome.rows[kPressedAgain]).norm(), 0.15);
}

const Case kCases[] = {
    {EmulatedFaultKind::kFreeze, 0.1, Fault::kStale, 5, "the same sample for 100 ms"},
    {EmulatedFaultKind::kFreeze, 4e-3, Fault::kNone, 0, "the same sample for 4 ms"},
    {EmulatedFaultKind::kDropOut, 0.0, Fault::kDevice, 0, "one sample that could not be read"},
    {EmulatedFaultKind::kDropOut, 1.0, Fault::kDevice, 0, "no sample could be read for 1 s"},
    {EmulatedFaultKind::kNotANumber, 0.0, Fault::kNotFinite, 0, "one position that is no number"},
    {EmulatedFaultKind::kNotANumber, 1.0, Fault::kNotFinite, 0, "positions that are no numbers for 1 s"},
    {EmulatedFaultKind::kSpike, 0.0, Fault::kNone, 0, "one position 50 mm too deep"},
    {EmulatedFaultKind::kSpike, 0.1, Fault::kNone, 0, "positions 50 mm too deep for 100 ms"},
    {EmulatedFaultKind::kLate, 0.5, Fault::kStale, 0, "samples 8 ms old for 500 ms"},
    {EmulatedFaultKind::kWrongUnits, 0.0, Fault::kNone, 0, "one position in mm where m are due"},
    {EmulatedFaultKind::kWrongUnits, 0.1, Fault::kNone, 0, "positions in mm where m are due for 100 ms"},
    {EmulatedFaultKind::kForceOff, 0.2, Fault::kForceOff, 0, "the device has its force off for 200 ms"},
    {EmulatedFaultKind::kRefuse, 0.0, Fault::kDevice, 1, "one command refused"},
    {EmulatedFaultKind::kRefuse, 1.0, Fault::kDevice, 1, "commands refused for 1 s"},
};

const char* recovery_of(const Case& bad) {
  if (bad.cause != Fault::kNone) return "reset, then force again by the ramp";
  return jumps(bad.kind) ? "no tissue force until the tool has been outside, then as before"
                         : "the force goes on";
}

void tell_of(const Case& bad, const Outcome& outcome, bool survived) {
  const bool latched = bad.cause != Fault::kNone;
  const double rate_per_ms = test::kRate / 1000.0;
  palpate::test::tell(
      {.device = "emulated",
       .fault = std::string(scene::name_of(bad.kind)),
       .injected = std::string(bad.injected) + ", while pressing",
       .zero_within_ms = latched ? static_cast<double>(outcome.zero - outcome.latched) / rate_per_ms
                                 : std::numeric_limits<double>::quiet_NaN(),
       .cause = haptics::name_of(bad.cause),
       .recovery = recovery_of(bad),
       .survived = survived});
}

TEST(EmulatedSafety, EveryFaultEndsInNoForceWithinTenMillisecondsOrWithinTheLimitsAndTheRunGoesOn) {
  for (const Case& bad : kCases) {
    SCOPED_TRACE(std::string(scene::name_of(bad.kind)) + ": " + bad.injected);
    const bool failed_before = HasFailure();
    const Outcome outcome = run_with(bad.kind, bad.duration, {kReset});
    ASSERT_EQ(outcome.rows.size(), kLastTick);
    EXPECT_GT(test::force_of(outcome.rows[kFaultTick - 1]).norm(), 0.15) << "there is a force to take away";
    expect_within_limits(outcome.rows);
    if (bad.cause == Fault::kNone) {
      expect_limited_and_unharmed(bad, outcome);
    } else {
      expect_zero_and_recovery(bad, outcome);
    }
    tell_of(bad, outcome, !failed_before && !HasFailure());
  }
}

TEST(EmulatedSafety, WithoutAResetTheForceStaysAtZeroToTheRunsEnd) {
  const Outcome outcome = run_with(EmulatedFaultKind::kDropOut, 0.0, {});
  ASSERT_LE(outcome.zero, kFaultTick + 10);
  for (std::uint64_t tick = outcome.zero; tick < kLastTick; ++tick) {
    ASSERT_EQ(test::force_of(outcome.rows[tick]).norm(), 0.0) << tick;
    ASSERT_EQ(outcome.rows[tick].fault, static_cast<std::uint32_t>(Fault::kDevice)) << tick;
  }
}

TEST(EmulatedSafety, AResetWhileTheFaultIsStillThereLatchesItAgain) {
  const Outcome outcome = run_with(EmulatedFaultKind::kDropOut, 1.0, {kFaultTick + 200});
  for (std::uint64_t tick = outcome.zero; tick < kLastTick; ++tick) {
    ASSERT_EQ(test::force_of(outcome.rows[tick]).norm(), 0.0) << tick;
    ASSERT_EQ(outcome.rows[tick].fault, static_cast<std::uint32_t>(Fault::kDevice)) << tick;
  }
}

TEST(EmulatedSafety, AResetInsideTheTissueGivesNoForceUntilTheHandWasStillOutside) {
  const Outcome outcome = run_with(EmulatedFaultKind::kDropOut, 0.0, {kFaultTick + 200});
  for (std::uint64_t tick = kFaultTick + 200; tick < 5000; ++tick) {  // outside from about 4.6 s
    ASSERT_EQ(test::force_of(outcome.rows[tick]).norm(), 0.0) << tick;
  }
  EXPECT_GT(test::force_of(outcome.rows[kPressedAgain]).norm(), 0.15);
}

}  // namespace
}  // namespace palpate::devices
