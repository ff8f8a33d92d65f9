#include "palpate/haptics/loop.h"

#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "palpate/base/clock.h"
#include "palpate/haptics/test/test_world.h"

namespace palpate::haptics {
namespace {

using test::block_and_balls;
using test::FakeDevice;
using test::pressing;
using test::RowKeeper;

struct Outcome {
  LoopReport report;
  std::vector<TickRow> rows;
};

Outcome run_with(FakeDevice& device, const LoopOptions& options, double rate_Hz = 1000.0) {
  const SimulationWorld world = block_and_balls(1, rate_Hz);
  SimulationState state(world);
  Device* devices[] = {&device};
  RowKeeper rows(options.ticks);
  Outcome outcome{run_loop(world, state, devices, &rows, options), {}};
  outcome.rows = std::move(rows.rows);
  return outcome;
}

FakeDevice presser() {
  return FakeDevice([](std::uint64_t, double time) { return pressing(time); });
}

TEST(Loop, OfflineAndInRealTimeGiveTheSameRows) {
  FakeDevice first = presser();
  FakeDevice second = presser();
  const Outcome offline = run_with(first, {.ticks = 600, .offline = true});
  const Outcome real = run_with(second, {.ticks = 600, .offline = false});
  ASSERT_EQ(offline.rows.size(), 600u);
  ASSERT_EQ(real.rows.size(), 600u);
  for (std::size_t i = 0; i < 600; ++i) {
    ASSERT_TRUE(test::same_bits(offline.rows[i], real.rows[i])) << i;
    ASSERT_EQ(offline.rows[i].tick, i);
    ASSERT_EQ(offline.rows[i].tick_ns, 0);
    ASSERT_EQ(offline.rows[i].late_ns, 0);
    ASSERT_GT(real.rows[i].tick_ns, 0);
    ASSERT_GE(real.rows[i].late_ns, 0);
  }
  EXPECT_GT(real.rows.back().tissue_force, 0.0);
  EXPECT_EQ(real.report.lateness.count(), 600u);
  EXPECT_EQ(real.report.tick_time.count(), 600u);
  EXPECT_EQ(offline.report.lateness.count(), 0u);
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

TEST(Loop, TheSinkBeginsOnceWithTheWallTimeOfTheFirstTick) {
  const SimulationWorld world = block_and_balls(1, 1000.0);
  SimulationState state(world);
  FakeDevice device = presser();
  Device* devices[] = {&device};
  RowKeeper none(1);
  (void)run_loop(world, state, devices, &none, {.ticks = 0, .offline = false});
  EXPECT_EQ(none.begins, 0) << "no tick was due";
  RowKeeper some(10);
  const std::int64_t before = unix_ns();
  (void)run_loop(world, state, devices, &some, {.ticks = 10, .offline = false});
  EXPECT_EQ(some.begins, 1);
  EXPECT_GE(some.started, before);
  EXPECT_LE(some.started, unix_ns());
}

TEST(Loop, TheStopFlagEndsItWithDeviceStopped) {
  std::atomic<bool> stop{false};
  FakeDevice device([&](std::uint64_t tick, double time) {
    if (tick == 20) stop = true;
    return pressing(time);
  });
  const Outcome outcome = run_with(device, {.ticks = 1'000'000, .offline = false, .stop = &stop});
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
  // Only what is less than a period late is made up for: n ticks never take less than n - 1 periods (the
  // last 0.1 ms is what lies between the loop's clock and this test's).
  for (std::size_t i = 11; i < 60; ++i) {
    for (std::size_t j = i + 1; j < 60; ++j) {
      EXPECT_GE(begins[j] - begins[i], static_cast<std::int64_t>(j - i - 1) * kPeriod - 100'000)
          << i << ' ' << j;
    }
  }
}

TEST(Loop, ARefusedCommandIsADeviceFaultAtTheNextTick) {
  FakeDevice device = presser();
  device.refuse_write = 450;
  const Outcome outcome = run_with(device, {.ticks = 500, .offline = true});
  EXPECT_EQ(outcome.rows[449].fault, 0u);
  EXPECT_EQ(outcome.rows[450].fault, static_cast<std::uint32_t>(Fault::kDevice));
  EXPECT_EQ(outcome.rows[450].device_valid, 0u) << "so that a replay meets the same fault";
  EXPECT_EQ(outcome.rows[451].device_valid, 1u);
  EXPECT_EQ(outcome.report.fault, Fault::kDevice);
  EXPECT_EQ(outcome.report.ticks, 500u) << "the run goes on at zero force";
  EXPECT_EQ(device.last.force, Vec3::Zero().eval());
}

TEST(Loop, PublishesTheNewestTickForThePicture) {
  const SimulationWorld world = block_and_balls(1, 1000.0);
  SimulationState state(world);
  FakeDevice device = presser();
  Device* devices[] = {&device};
  RowKeeper rows(450);
  SnapshotCell<Snapshot> cell;
  std::atomic<std::uint64_t> progress{0};
  (void)run_loop(world, state, devices, &rows,
                 {.ticks = 450, .offline = true, .snapshots = &cell, .progress = &progress});
  ASSERT_TRUE(cell.refresh());
  const Snapshot& newest = cell.value();
  EXPECT_EQ(newest.tick, 449u);
  EXPECT_EQ(newest.hands, 1u);
  EXPECT_EQ(newest.organ_W.position, world.organ_W.position);
  EXPECT_EQ(newest.tools[0].pose_W.position.z(), rows.rows.back().tool[2]);
  EXPECT_EQ(newest.results[0].depth, rows.rows.back().depth);
  EXPECT_EQ(newest.commands[0].force.z(), rows.rows.back().force[2]);
  EXPECT_EQ(progress.load(), 450u);
}

TEST(Loop, RefusesMoreOrFewerDevicesThanHandsAndStopsThem) {
  const SimulationWorld world = block_and_balls(2, 1000.0);
  SimulationState state(world);
  FakeDevice device = presser();
  Device* devices[] = {&device};
  EXPECT_THROW((void)run_loop(world, state, devices, nullptr, {.ticks = 1}), std::invalid_argument);
  EXPECT_GE(device.stops, 1);
}

TEST(Loop, WhatWasNotGrantedIsSaidInWords) {
  FakeDevice device = presser();
  const Outcome outcome = run_with(device, {.ticks = 2, .offline = false});
  const int refused = (outcome.report.realtime_priority ? 0 : 1) + (outcome.report.memory_locked ? 0 : 1);
  EXPECT_EQ(outcome.report.remarks.size(), static_cast<std::size_t>(refused));
  FakeDevice again = presser();
  EXPECT_TRUE(run_with(again, {.ticks = 2, .offline = true}).report.remarks.empty()) << "not asked offline";
}

}  // namespace
}  // namespace palpate::haptics
