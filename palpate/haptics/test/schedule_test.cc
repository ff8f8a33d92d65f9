#include "palpate/haptics/schedule.h"

#include <gtest/gtest.h>

namespace palpate::haptics {
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

}  // namespace
}  // namespace palpate::haptics
