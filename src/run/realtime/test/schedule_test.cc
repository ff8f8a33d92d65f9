#include "run/realtime/schedule.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::realtime {
namespace {

TEST(Schedule, TicksInTimeStayOnTheGridOfTheFirst) {
  Schedule schedule(3000.0, 1'000);
  for (std::int64_t tick = 0; tick < 3'000'000; ++tick) {
    const std::int64_t on_grid = 1'000 + (tick * 1'000'000 + 1) / 3;  // period 333,333 1/3 ns, rounded
    ASSERT_EQ(schedule.due(), on_grid) << tick;
    const Schedule::Begin begin = schedule.begin(schedule.due() + 50);
    ASSERT_EQ(begin.late_ns, 50);
    ASSERT_FALSE(begin.missed);
  }
}

TEST(Schedule, ALessThanAPeriodLateTickLeavesTheNextWhereItWas) {
  Schedule schedule(1000.0, 0);
  EXPECT_FALSE(schedule.begin(999'999).missed);
  EXPECT_EQ(schedule.due(), 1'000'000);
}

TEST(Schedule, ATickAFullPeriodLateShiftsAllThatFollow) {
  Schedule schedule(1000.0, 0);
  (void)schedule.begin(0);
  const Schedule::Begin late = schedule.begin(7'300'000);
  EXPECT_TRUE(late.missed);
  EXPECT_EQ(late.late_ns, 6'300'000);
  EXPECT_EQ(schedule.due(), 8'300'000);
  (void)schedule.begin(8'300'000);
  EXPECT_EQ(schedule.due(), 9'300'000);
}

TEST(Schedule, AnEarlyBeginIsNotNegativelyLate) {
  Schedule schedule(1000.0, 10);
  EXPECT_EQ(schedule.begin(5).late_ns, 0);
}

// One tick takes 7.3 periods, and the next ticks take no time. Each tick begins when it is due, or at once
// when it is overdue. The schedule catches up on less than one period in all.
TEST(Schedule, ASlowTickIsNeverMadeUpForAtAnyRate) {
  for (const double rate : {1000.0, 2000.0, 4000.0, 10000.0}) {
    const double period = 1e9 / rate;
    Schedule schedule(rate, 1'000'000);
    std::vector<std::int64_t> begins;
    std::int64_t now = 0;
    int missed = 0;
    for (int tick = 0; tick < 200; ++tick) {
      now = std::max(now, schedule.due());
      begins.push_back(now);
      if (schedule.begin(now).missed) ++missed;
      if (tick == 20) now += static_cast<std::int64_t>(7.3 * period);
    }
    EXPECT_EQ(missed, 1) << rate;
    for (std::size_t i = 21; i + 1 < begins.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(begins[i + 1] - begins[i]), period, 1.0) << rate << ' ' << i;
    }
    const auto whole = static_cast<double>(begins.back() - begins.front());
    EXPECT_NEAR(whole, (199 + 6.3) * period, 2.0) << rate << ": the slow tick's own period counts once";
  }
}

}  // namespace
}  // namespace palpate::realtime
