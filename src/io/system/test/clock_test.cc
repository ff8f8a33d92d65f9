#include "io/system/clock.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Clock, MonotonicTimeNeverGoesBack) {
  std::int64_t previous = monotonic_ns();
  for (int i = 0; i < 10'000; ++i) {
    const std::int64_t now = monotonic_ns();
    ASSERT_GE(now, previous);
    previous = now;
  }
}

TEST(Clock, SleepReachesItsDeadline) {
  const std::int64_t deadline = monotonic_ns() + 2'000'000;
  sleep_until_ns(deadline);
  EXPECT_GE(monotonic_ns(), deadline);
}

TEST(Clock, SleepReturnsAtOnceForADeadlineInThePast) {
  const std::int64_t past = monotonic_ns() - 1'000'000;
  sleep_until_ns(past);
  EXPECT_GE(monotonic_ns(), past);
}

TEST(Clock, SleepingTakesNoProcessorTimeOfTheThread) {
  const std::int64_t wall = monotonic_ns();
  const std::int64_t before = thread_cpu_ns();
  sleep_until_ns(wall + 50'000'000);
  EXPECT_LT(thread_cpu_ns() - before, 25'000'000);
}

TEST(Clock, WallTimeIsPastTheYear2020) { EXPECT_GT(unix_ns(), 1'577'836'800'000'000'000); }

TEST(Clock, WallTimeOfAMonotonicTimeIsTheWallTimeThen) {
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t before = unix_ns();
    const std::int64_t wall = wall_time_of(monotonic_ns());
    EXPECT_GE(wall, before - 1'000'000);
    EXPECT_LE(wall, unix_ns() + 1'000'000);
  }
  EXPECT_NEAR(static_cast<double>(wall_time_of(5'000'000'000) - wall_time_of(0)), 5e9, 1e6);
}

}  // namespace
}  // namespace palpate
