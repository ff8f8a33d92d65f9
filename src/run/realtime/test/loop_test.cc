#include "run/realtime/loop.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sched.h>

#include "core/haptics/test/test_world.h"
#include "io/system/clock.h"
#include "run/realtime/realtime.h"

namespace palpate::realtime {
namespace {

using haptics::test::block_and_balls;
using haptics::test::FakeDevice;
using haptics::test::pressing;
using haptics::test::RowKeeper;

struct Outcome {
  haptics::LoopReport report;
  std::vector<haptics::TickRow> rows;
};

Outcome run_with(FakeDevice& device, const LoopOptions& options, double rate_Hz = 1000.0) {
  const haptics::SimulationWorld world = block_and_balls(1, rate_Hz);
  haptics::SimulationState state(world);
  haptics::Device* devices[] = {&device};
  RowKeeper rows(options.ticks);
  Outcome outcome{run_loop(world, state, devices, {&rows}, options), {}};
  outcome.rows = std::move(rows.rows);
  return outcome;
}

constexpr std::int64_t kStallAfter = 300'000'000;  // ns; a busy machine hardly makes such gaps by itself

/// Disables the stall limit, because a tick may begin seconds late on a busy machine. Only tests of stalls
/// use the limit.
LoopOptions calm(LoopOptions options) {
  options.stalled_after_ns = 0;
  return options;
}

FakeDevice presser() {
  return FakeDevice([](std::uint64_t, double time) { return pressing(time); });
}

TEST(Loop, OfflineAndInRealTimeGiveTheSameRowsHoweverTicksAreWaitedFor) {
  FakeDevice first = presser();
  const Outcome offline = run_with(first, {.ticks = 600, .offline = true});
  ASSERT_EQ(offline.rows.size(), 600u);
  EXPECT_EQ(offline.report.lateness.count(), 0u);
  EXPECT_EQ(offline.report.tick_time.count(), 36u);  // of every 17th tick
  for (const haptics::Waiting waiting : {haptics::Waiting::kSleep, haptics::Waiting::kPoll}) {
    FakeDevice device = presser();
    const Outcome real =
        run_with(device, calm({.ticks = 600, .offline = false, .thread = {.waiting = waiting}}));
    ASSERT_EQ(real.rows.size(), 600u);
    for (std::size_t i = 0; i < 600; ++i) {
      ASSERT_TRUE(haptics::test::same_bits(offline.rows[i], real.rows[i])) << i;
      ASSERT_EQ(offline.rows[i].tick, i);
      ASSERT_EQ(offline.rows[i].tick_ns, 0);
      ASSERT_EQ(offline.rows[i].late_ns, 0);
      ASSERT_GT(real.rows[i].tick_ns, 0);
      ASSERT_GE(real.rows[i].late_ns, 0);
    }
    EXPECT_GT(real.rows.back().tissue_force, 0.0);
    EXPECT_EQ(real.report.lateness.count(), 600u);
    EXPECT_EQ(real.report.tick_time.count(), 600u);
    EXPECT_EQ(real.report.polled, waiting == haptics::Waiting::kPoll);
  }
}

TEST(Loop, ADeviceIsAskedAtTickOverRateAndHearsOneCommandATick) {
  std::vector<double> times;
  FakeDevice device([&](std::uint64_t, double time) {
    times.push_back(time);
    return pressing(time);
  });
  const Outcome outcome = run_with(device, {.ticks = 100, .offline = true}, 3000.0);
  ASSERT_EQ(times.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(times[i], static_cast<double>(i) / 3000.0);
  EXPECT_EQ(device.writes, 100u);
  EXPECT_EQ(device.last.force.z(), outcome.rows.back().force[2]);
}

TEST(Loop, EndsWithDeviceStop) {
  FakeDevice device = presser();
  (void)run_with(device, {.ticks = 5, .offline = true});
  EXPECT_GE(device.stops, 1);
}

// Without the right to real-time priority; with it, the loop has SCHED_FIFO anyway.
TEST(Loop, OfAThreadThatYieldsToLoopsDoesNotYieldItself) {
  std::thread([] {
    yield_to_loop();
    EXPECT_EQ(sched_getscheduler(0), SCHED_BATCH);
    int policy = -1;
    FakeDevice device([&policy](std::uint64_t, double time) {
      policy = sched_getscheduler(0);
      return pressing(time);
    });
    (void)run_with(device, calm({.ticks = 5, .offline = false}));
    EXPECT_TRUE(policy == SCHED_OTHER || policy == SCHED_FIFO) << policy;
  }).join();
}

TEST(Loop, ObserversAreStartedOnceWithTheWallTimeOfTheFirstTick) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::SimulationState state(world);
  FakeDevice device = presser();
  haptics::Device* devices[] = {&device};
  RowKeeper none(1);
  (void)run_loop(world, state, devices, {&none}, {.ticks = 0, .offline = false});
  EXPECT_EQ(none.begins, 0) << "no tick was due";
  RowKeeper some(10);
  const std::int64_t before = unix_ns();
  (void)run_loop(world, state, devices, {&some}, {.ticks = 10, .offline = false});
  EXPECT_EQ(some.begins, 1);
  EXPECT_GE(some.started, before);
  EXPECT_LE(some.started, unix_ns());
}

TEST(Loop, AStopEndsItWithDeviceStopped) {
  haptics::RunControl control;
  FakeDevice device([&](std::uint64_t tick, double time) {
    if (tick == 20) control.stop();
    return pressing(time);
  });
  const Outcome outcome = run_with(device, {.ticks = 1'000'000, .offline = false, .control = &control});
  EXPECT_EQ(outcome.report.ticks, 21u);
  EXPECT_EQ(outcome.rows.size(), 21u);
  EXPECT_TRUE(outcome.report.stopped_early);
  EXPECT_GE(device.stops, 1);
}

TEST(Loop, AfterASlowTickTheScheduleShiftsWithoutABurstOrASkippedNumber) {
  constexpr std::int64_t kPeriod = 1'000'000;  // ns
  std::vector<std::int64_t> begins;
  std::vector<std::uint64_t> numbers;
  FakeDevice device([&](std::uint64_t tick, double time) {
    begins.push_back(monotonic_ns());
    numbers.push_back(tick);
    if (tick == 10) sleep_until_ns(begins.back() + 10 * kPeriod);
    return pressing(time);
  });
  const Outcome outcome = run_with(device, {.ticks = 60, .offline = false});
  ASSERT_EQ(begins.size(), 60u);
  for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(numbers[i], i);
  EXPECT_GE(outcome.report.missed_deadlines, 1u);
  EXPECT_GE(outcome.report.longest_gap_ns, 10 * kPeriod);
  EXPECT_GE(outcome.rows[11].late_ns, 8 * kPeriod);
  // The loop catches up on less than one period, so n ticks never take less than n - 1 periods. The 0.1 ms
  // allow for the time between the loop's clock and this test's clock.
  for (std::size_t i = 11; i < 60; ++i) {
    for (std::size_t j = i + 1; j < 60; ++j) {
      EXPECT_GE(begins[j] - begins[i], static_cast<std::int64_t>(j - i - 1) * kPeriod - 100'000)
          << i << ' ' << j;
    }
  }
}

// Measured from outside: a loop that caught up on all missed time would give a shorter run. A busy machine
// only makes the run longer.
TEST(Loop, ASlowDeviceMakesTheRunLongerByItsDelayAtAnyRate) {
  for (const double rate : {1000.0, 2000.0, 4000.0, 10000.0}) {
    constexpr std::int64_t kDelay = 12'000'000;  // ns
    constexpr std::uint64_t kTicks = 100;
    const auto period = static_cast<std::int64_t>(1e9 / rate);
    FakeDevice device([&](std::uint64_t tick, double time) {
      if (tick == 30) sleep_until_ns(monotonic_ns() + kDelay);
      return pressing(time);
    });
    const std::int64_t before = monotonic_ns();
    const Outcome outcome = run_with(device, calm({.ticks = kTicks}), rate);
    EXPECT_GE(monotonic_ns() - before, static_cast<std::int64_t>(kTicks - 2) * period + kDelay) << rate;
    EXPECT_GE(outcome.report.missed_deadlines, 1u) << rate;
    ASSERT_EQ(outcome.rows.size(), kTicks);
    for (std::size_t i = 0; i < kTicks; ++i) ASSERT_EQ(outcome.rows[i].tick, i) << rate;
  }
}

TEST(Loop, AStallIsAFaultThatLatchesInTheTickThatBeginsAfterIt) {
  FakeDevice device([](std::uint64_t tick, double time) {
    if (tick == 449) sleep_until_ns(monotonic_ns() + 2 * kStallAfter);
    return pressing(time);
  });
  LoopOptions options{.ticks = 500};
  options.stalled_after_ns = kStallAfter;
  const Outcome outcome = run_with(device, options);
  const auto stalled = static_cast<std::uint32_t>(haptics::Fault::kStalled);
  EXPECT_EQ(outcome.rows[449].fault, 0u);
  EXPECT_EQ(outcome.rows[450].fault, stalled);
  EXPECT_EQ(outcome.rows[450].device_fault, stalled) << "so that a replay meets the same fault";
  EXPECT_EQ(outcome.rows[450].device_valid, 1u);
  EXPECT_EQ(outcome.rows[499].fault, stalled);
  EXPECT_EQ(outcome.rows[499].force, (std::array<double, 3>{}));
  EXPECT_EQ(outcome.report.fault, haptics::Fault::kStalled);
  ASSERT_GE(outcome.report.faults.size(), 1u);
  EXPECT_EQ(outcome.report.faults[0].tick, 450u);
  EXPECT_EQ(outcome.report.faults[0].reset_tick, haptics::FaultSeen::kNotReset);
}

TEST(Loop, AfterAStopByTheWatchdogNoForceIsWrittenUntilTheGatesOwnIsZero) {
  std::vector<double> written;
  FakeDevice device([&](std::uint64_t tick, double time) {
    if (tick == 449) sleep_until_ns(monotonic_ns() + 2 * kStallAfter);
    return pressing(time);
  });
  device.on_write = [&](const haptics::ForceCommand& command) { written.push_back(command.force.norm()); };
  LoopOptions options{.ticks = 500};
  options.stalled_after_ns = kStallAfter;
  const Outcome outcome = run_with(device, options);
  ASSERT_EQ(written.size(), 500u);
  EXPECT_GT(written[448], 0.0);
  for (std::size_t tick = 449; tick < 500; ++tick) EXPECT_EQ(written[tick], 0.0) << tick;
  EXPECT_GE(outcome.report.watchdog_stops, 1u);
  EXPECT_GE(device.stops, 2) << "the watchdog's and the run's last";
  ASSERT_GE(outcome.report.stops.size(), 1u);
  EXPECT_EQ(outcome.report.stops[0].tick, 449u);
  ASSERT_FALSE(outcome.report.remarks.empty());
  EXPECT_NE(outcome.report.remarks.back().find("the watchdog stopped the devices"), std::string::npos);
  EXPECT_NE(outcome.report.remarks.back().find("after tick 449"), std::string::npos);
}

TEST(Loop, WhereNobodyWatchesAStallIsALateTick) {
  FakeDevice device([](std::uint64_t tick, double time) {
    if (tick == 5) sleep_until_ns(monotonic_ns() + 30'000'000);
    return pressing(time);
  });
  LoopOptions options{.ticks = 20};
  options.stalled_after_ns = 0;
  const Outcome outcome = run_with(device, options);
  EXPECT_EQ(outcome.report.fault, haptics::Fault::kNone);
  EXPECT_GE(outcome.report.longest_gap_ns, 30'000'000);
  EXPECT_EQ(outcome.report.watchdog_stops, 0u);
}

TEST(Loop, APauseLeavesRowsAsTheyAreStopsTheDeviceAndMakesNoTickLate) {
  haptics::RunControl control;
  std::thread releaser;
  FakeDevice device([&](std::uint64_t tick, double time) {
    if (tick == 100 && !releaser.joinable()) {
      control.pause(true);
      releaser = std::thread([&] {
        std::this_thread::sleep_for(std::chrono::seconds(2));
        control.pause(false);
      });
    }
    return pressing(time);
  });
  const LoopOptions options = calm({.ticks = 200, .control = &control});
  const std::int64_t from = monotonic_ns();
  const Outcome paused = run_with(device, options);
  releaser.join();
  EXPECT_GE(monotonic_ns() - from, 2'000'000'000);
  FakeDevice other = presser();
  const Outcome offline = run_with(other, {.ticks = 200, .offline = true});
  ASSERT_EQ(paused.rows.size(), 200U);
  for (std::size_t i = 0; i < 200; ++i)
    ASSERT_TRUE(haptics::test::same_bits(offline.rows[i], paused.rows[i])) << i;
  EXPECT_EQ(paused.report.pauses, 1U);
  EXPECT_GE(paused.report.paused_ns, 1'900'000'000);
  EXPECT_LT(paused.report.longest_gap_ns, 1'900'000'000) << "the pause is no gap";
  EXPECT_LT(paused.report.lateness.max(), 1'900'000'000) << "nor is a tick late for it";
  EXPECT_EQ(device.stops.load(), 2) << "at the pause and at the end";
  EXPECT_NE(paused.report.remarks.back().find("paused once"), std::string::npos)
      << paused.report.remarks.back();
}

TEST(Loop, SaysPausesInTenthsOfASecond) {
  EXPECT_EQ(describe_pauses(1, 300'000'000), "the run was paused once, for 0.3 s; its times leave that out");
  EXPECT_EQ(describe_pauses(2, 2'260'000'000),
            "the run was paused 2 times, for 2.3 s; its times leave that out");
  EXPECT_EQ(describe_pauses(1, 49'000'000),
            "the run was paused once, for less than 0.1 s; its times leave that out");
}

TEST(Loop, WhereSomebodyWatchesForStallsAndOfflineNothingIsPaused) {
  haptics::RunControl control;
  control.pause(true);
  FakeDevice device = presser();
  const LoopOptions watched{.ticks = 50, .control = &control, .stalled_after_ns = 60'000'000'000};
  EXPECT_EQ(run_with(device, watched).report.ticks, 50U);
  const LoopOptions offline = calm({.ticks = 50, .offline = true, .control = &control});
  EXPECT_EQ(run_with(device, offline).report.ticks, 50U);
}

TEST(Loop, APausedRunCanBeEnded) {
  haptics::RunControl control;
  control.pause(true);
  std::thread ender([&control] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    control.stop();
  });
  FakeDevice device = presser();
  const Outcome outcome = run_with(device, calm({.ticks = 50, .control = &control}));
  ender.join();
  EXPECT_EQ(outcome.report.ticks, 0U);
  EXPECT_TRUE(outcome.report.stopped_early);
}

TEST(Loop, OfflineNothingIsAStall) {
  FakeDevice device([](std::uint64_t tick, double time) {
    if (tick == 5) sleep_until_ns(monotonic_ns() + 30'000'000);
    return pressing(time);
  });
  const Outcome outcome = run_with(device, {.ticks = 20, .offline = true});
  EXPECT_EQ(outcome.report.fault, haptics::Fault::kNone);
  EXPECT_EQ(outcome.report.watchdog_stops, 0u);
}

TEST(Loop, AResetReachesItsHandsOnceInTheNextTick) {
  const haptics::SimulationWorld world = block_and_balls(2, 1000.0);
  haptics::SimulationState state(world);
  haptics::RunControl control;
  FakeDevice first = presser();
  FakeDevice second([&](std::uint64_t tick, double time) {
    if (tick == 10) control.reset_faults(0b10);
    return pressing(time);
  });
  haptics::Device* devices[] = {&first, &second};
  RowKeeper rows(40);
  (void)run_loop(world, state, devices, {&rows}, {.ticks = 20, .offline = true, .control = &control});
  for (const haptics::TickRow& row : rows.rows) {
    EXPECT_EQ(row.events, row.tick == 11 && row.hand == 1 ? haptics::kResetFault : 0u)
        << row.tick << ' ' << row.hand;
  }
  EXPECT_EQ(control.take_resets(), 0u);
}

/// Collects the faults passed to on_fault().
class FaultKeeper final : public haptics::TickObserver {
 public:
  void on_fault(const haptics::FaultSeen& fault) noexcept override { faults.push_back(fault); }
  std::vector<haptics::FaultSeen> faults;
};

TEST(Loop, EachFaultIsInTheReportAndReportedToObservers) {
  const haptics::SimulationWorld world = block_and_balls(2, 1000.0);
  haptics::SimulationState state(world);
  FakeDevice first([](std::uint64_t tick, double time) {
    haptics::DeviceState sample = pressing(time);
    if (tick == 30) sample.position_D.x() = std::numeric_limits<double>::quiet_NaN();
    return sample;
  });
  FakeDevice second([](std::uint64_t tick, double time) {
    haptics::DeviceState sample = pressing(time);
    if (tick == 20) sample.fault = haptics::Fault::kForceOff;
    return sample;
  });
  haptics::Device* devices[] = {&first, &second};
  FaultKeeper keeper;
  const haptics::LoopReport report =
      run_loop(world, state, devices, {&keeper}, {.ticks = 50, .offline = true});
  ASSERT_EQ(report.faults.size(), 2u);
  EXPECT_EQ(report.faults[0].tick, 20u);
  EXPECT_EQ(report.faults[0].hand, 1u);
  EXPECT_EQ(report.faults[0].fault, haptics::Fault::kForceOff);
  EXPECT_EQ(report.faults[1].tick, 30u);
  EXPECT_EQ(report.faults[1].hand, 0u);
  EXPECT_EQ(report.fault, haptics::Fault::kForceOff) << "the first";
  ASSERT_EQ(keeper.faults.size(), 2u);
  EXPECT_EQ(keeper.faults[0].tick, 20u);
  EXPECT_EQ(keeper.faults[1].tick, 30u);
}

TEST(Loop, AFaultThatWasResetSaysWhenAndOneThatIsLatchedAnewIsAnotherOne) {
  haptics::RunControl control;
  FakeDevice device([&](std::uint64_t tick, double time) {
    haptics::DeviceState sample = pressing(time);
    if (tick >= 20 && tick < 30) sample.fault = haptics::Fault::kForceOff;
    if (tick == 24 || tick == 34) control.reset_faults(1);  // takes effect at the next tick
    return sample;
  });
  const haptics::LoopReport report =
      run_with(device, {.ticks = 50, .offline = true, .control = &control}).report;
  ASSERT_EQ(report.faults.size(), 2u);
  EXPECT_EQ(report.faults[0].tick, 20u);
  EXPECT_EQ(report.faults[0].reset_tick, 25u);
  EXPECT_EQ(report.faults[1].tick, 25u) << "the cause was still there";
  EXPECT_EQ(report.faults[1].reset_tick, 35u);
  EXPECT_EQ(report.fault, haptics::Fault::kForceOff) << "also after the reset";
}

TEST(Loop, ADeviceHearsItsCommandInItsOwnFrame) {
  // The device's frame is turned a quarter about x. Its z axis is the world's -y axis, so an upward push in
  // the world is along the device's y axis.
  haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  const Quat quarter(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0);
  world.mappings[0].base.rotation = quarter;
  haptics::SimulationState state(world);
  FakeDevice device([&](std::uint64_t, double time) {
    haptics::DeviceState sample = pressing(time);
    sample.position_D = quarter.conjugate() * sample.position_D;
    return sample;
  });
  haptics::Device* devices[] = {&device};
  RowKeeper rows(450);
  (void)run_loop(world, state, devices, {&rows}, {.ticks = 450, .offline = true});
  const haptics::TickRow& last = rows.rows.back();
  ASSERT_GT(last.force[2], 0.05);
  EXPECT_NEAR(device.last.force.x(), last.force[0], 1e-12);
  EXPECT_NEAR(device.last.force.y(), last.force[2], 1e-12);
  EXPECT_NEAR(device.last.force.z(), -last.force[1], 1e-12);
  EXPECT_NEAR(device.last.torque.x(), last.torque[0], 1e-12);
  EXPECT_NEAR(device.last.torque.y(), last.torque[2], 1e-12);
  EXPECT_NEAR(device.last.torque.z(), -last.torque[1], 1e-12);
}

TEST(Loop, RunsOnTheCoreThatIsAskedForAndRefusesOneThatIsNotThere) {
  const int core = usable_cores().back();
  std::vector<int> seen;
  FakeDevice device([&](std::uint64_t, double time) {
    seen.push_back(sched_getcpu());
    return pressing(time);
  });
  (void)run_with(device, {.ticks = 50, .offline = true, .thread = {.core = core}});
  EXPECT_EQ(seen, std::vector<int>(50, core));
  EXPECT_THROW((void)run_with(device, {.ticks = 1, .offline = true, .thread = {.core = 1'000'000}}),
               std::invalid_argument);
  EXPECT_THROW((void)run_with(device, {.ticks = 1, .offline = true, .thread = {.core = -1}}),
               std::invalid_argument);
}

TEST(Loop, ARefusedCommandIsADeviceFaultAtTheNextTick) {
  FakeDevice device = presser();
  device.failing_write = 450;
  const Outcome outcome = run_with(device, {.ticks = 500, .offline = true});
  EXPECT_EQ(outcome.rows[449].fault, 0u);
  EXPECT_EQ(outcome.rows[450].fault, static_cast<std::uint32_t>(haptics::Fault::kDevice));
  EXPECT_EQ(outcome.rows[450].device_valid, 0u) << "so that a replay meets the same fault";
  EXPECT_EQ(outcome.rows[451].device_valid, 1u);
  EXPECT_EQ(outcome.report.fault, haptics::Fault::kDevice);
  EXPECT_EQ(outcome.report.ticks, 500u) << "the run goes on at zero force";
  EXPECT_EQ(device.last.force, Vec3::Zero().eval());
}

TEST(Loop, RefusesMoreOrFewerDevicesThanHandsAndStopsThem) {
  const haptics::SimulationWorld world = block_and_balls(2, 1000.0);
  haptics::SimulationState state(world);
  FakeDevice device = presser();
  haptics::Device* devices[] = {&device};
  EXPECT_THROW((void)run_loop(world, state, devices, {}, {.ticks = 1}), std::invalid_argument);
  EXPECT_GE(device.stops, 1);
}

TEST(Loop, WhatWasNotGrantedIsSaidInWords) {
  FakeDevice device = presser();
  const Outcome outcome = run_with(device, {.ticks = 2, .offline = false});
  const int refused = (outcome.report.realtime_priority ? 0 : 1) + (outcome.report.memory_locked ? 0 : 1);
  const int stopped = outcome.report.watchdog_stops > 0 ? 1 : 0;
  EXPECT_EQ(outcome.report.remarks.size(), static_cast<std::size_t>(refused + stopped));
  FakeDevice again = presser();
  EXPECT_TRUE(run_with(again, {.ticks = 2, .offline = true}).report.remarks.empty()) << "not asked offline";
}

TEST(StallLimit, IsThereWhereAHandHoldsADevice) {
  haptics::SimulationWorld world = block_and_balls(2, 1000.0);
  EXPECT_EQ(stall_limit_ns(world), 0);
  world.mappings[1].held = true;
  EXPECT_EQ(stall_limit_ns(world), 20'000'000);
}

}  // namespace
}  // namespace palpate::realtime
