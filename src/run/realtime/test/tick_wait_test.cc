#include "run/realtime/tick_wait.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/haptics/test/test_world.h"
#include "io/system/clock.h"
#include "io/system/test/temporary_folder.h"
#include "run/realtime/loop.h"
#include "run/realtime/realtime.h"

namespace palpate::realtime {
namespace {

TEST(PollingRestShare, IsMoreThanTheKernelAsksOfRealTimeThreads) {
  EXPECT_NEAR(polling_sleep_fraction(RealtimeBudget{950'000, 1'000'000}), 0.08, 1e-12);  // Linux's default
  EXPECT_NEAR(polling_sleep_fraction(RealtimeBudget{500'000, 1'000'000}), 0.53, 1e-12);
  EXPECT_NEAR(polling_sleep_fraction(RealtimeBudget{99'000, 100'000}), 0.05, 1e-12);
  EXPECT_EQ(polling_sleep_fraction(RealtimeBudget{0, 1'000'000}), 1.0);
}

TEST(PollingRestShare, LeavesTheKernelsThreadsTheirTurnWhereItAsksForNone) {
  EXPECT_EQ(polling_sleep_fraction(RealtimeBudget{-1, 1'000'000}), 0.05);
  EXPECT_EQ(polling_sleep_fraction(RealtimeBudget{1'000'000, 1'000'000}), 0.05);
}

TEST(PollingRestShare, IsTheUsualWhereTheKernelSaysNothing) {
  EXPECT_NEAR(polling_sleep_fraction(std::nullopt), 0.08, 1e-12);
}

/// Budget that is read from kernel files with these texts. An empty text means that the file does not exist.
std::optional<RealtimeBudget> budget_where(const std::string& runtime, const std::string& period) {
  const palpate::test::TemporaryFolder folder;
  const std::filesystem::path kernel = folder.path() / "proc/sys/kernel";
  std::filesystem::create_directories(kernel);
  if (!runtime.empty()) std::ofstream(kernel / "sched_rt_runtime_us") << runtime << '\n';
  if (!period.empty()) std::ofstream(kernel / "sched_rt_period_us") << period << '\n';
  return realtime_budget(folder.path());
}

TEST(RealtimeBudget, IsWhatTheKernelSays) {
  const std::optional<RealtimeBudget> budget = budget_where("-1", "1000000");
  ASSERT_TRUE(budget);
  EXPECT_EQ(budget->runtime_us, -1);
  EXPECT_EQ(budget->period_us, 1'000'000);
}

TEST(RealtimeBudget, IsNoneWhereTheKernelSaysNothingOrNonsense) {
  EXPECT_FALSE(budget_where("", ""));
  EXPECT_FALSE(budget_where("950000", ""));
  EXPECT_FALSE(budget_where("a", "b"));
  EXPECT_FALSE(budget_where("950000", "0"));
}

/// Result of ticks on a simulated clock. Each tick works for the fraction `work(tick)` of its period, and
/// sleeps last exactly as requested.
struct Simulated {
  double slept = 0.0;           // fraction of the time
  double least_margin = 1e300;  // ns from the end of a sleep to the next tick
};

template <typename Work>
Simulated simulate(double rate_Hz, double share, std::uint64_t ticks, const Work& work) {
  const auto period = static_cast<std::int64_t>(1e9 / rate_Hz);
  PollingSleep rest(rate_Hz, share);
  Simulated result;
  double slept = 0.0;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    const std::int64_t due = static_cast<std::int64_t>(tick + 1) * period;
    const std::int64_t now =
        due - period + static_cast<std::int64_t>(work(tick) * static_cast<double>(period));
    const std::int64_t lasts = rest.next(now, due);
    EXPECT_GE(lasts, 0);
    if (lasts > 0)
      result.least_margin = std::min(result.least_margin, static_cast<double>(due - now - lasts));
    slept += static_cast<double>(lasts);
  }
  result.slept = slept / (static_cast<double>(ticks) * static_cast<double>(period));
  return result;
}

TEST(PollingSleep, AtEveryRateTheShareIsSleptAndEndsWellBeforeTheNextTick) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> fraction(0.0, 0.35);
  for (const double rate : {100.0, 500.0, 1000.0, 2000.0, 4000.0, 10'000.0, 20'000.0}) {
    for (const double share : {0.05, 0.08, 0.3}) {
      const auto seconds = static_cast<std::uint64_t>(2.0 * rate);
      const Simulated run = simulate(rate, share, seconds, [&](std::uint64_t) { return fraction(random); });
      EXPECT_GE(run.slept, 0.97 * share) << rate << " Hz";
      EXPECT_LE(run.slept, share + 1e-9) << rate << " Hz";
      EXPECT_GE(run.least_margin, std::min(100e3, 0.25e9 / rate)) << rate << " Hz";
    }
  }
}

TEST(PollingSleep, WhatBusyTicksLeaveNoRoomForIsMadeUpForLater) {
  // The first 0.1 s leave no time to sleep, the rest of the period leaves enough.
  const auto work = [](std::uint64_t tick) { return tick % 1000 < 100 ? 0.95 : 0.1; };
  EXPECT_NEAR(simulate(1000.0, 0.08, 2000, work).slept, 0.08, 1e-3);
}

TEST(PollingSleep, LateTicksAreNotMadeLater) {
  PollingSleep rest(1000.0, 0.08);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(rest.next(1'000'000 + i * 10'000, 1'000'000), 0);
}

TEST(TickWait, NeverEndsBeforeTheTickIsDue) {
  for (const haptics::Waiting waiting : {haptics::Waiting::kSleep, haptics::Waiting::kPoll}) {
    for (const double rate : {1000.0, 10'000.0}) {
      TickWait wait(waiting, rate);
      std::int64_t due = monotonic_ns();
      for (int tick = 0; tick < 50; ++tick) {
        due += static_cast<std::int64_t>(1e9 / rate);
        wait.until(due);
        EXPECT_GE(monotonic_ns(), due);
      }
    }
  }
}

TEST(Polling, OnTheOnlyCoreThereIsIsSaidInWords) {
  const auto remarks = [](haptics::Waiting waiting) {
    const haptics::SimulationWorld world = haptics::test::block_and_balls(1, 1000.0);
    haptics::SimulationState state(world);
    haptics::test::FakeDevice device(
        [](std::uint64_t, double time) { return haptics::test::pressing(time); });
    haptics::Device* devices[] = {&device};
    const LoopOptions options{.ticks = 2, .thread = {.waiting = waiting}, .stalled_after_ns = 0};
    return run_loop(world, state, devices, {}, options).remarks;
  };
  std::thread([&] {
    ASSERT_TRUE(pin_to_core(usable_cores().back()));
    std::vector<std::string> expected = remarks(haptics::Waiting::kSleep);
    expected.insert(expected.begin(),
                    "the loop polled on the only core that this program may use: all else had to wait");
    EXPECT_EQ(remarks(haptics::Waiting::kPoll), expected);
  }).join();
}

}  // namespace
}  // namespace palpate::realtime
