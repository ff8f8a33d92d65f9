// Questions about numbers that are in another unit than a file says.
#include "io/system/plausible.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Plausible, AMeshIsAskedForTheUnitThatGivesAUsualSize) {
  EXPECT_EQ(unit_question(kOrganExtent, 110.0),
            ": is its unit right? (1000 times smaller it would be 110 mm)");
  EXPECT_EQ(unit_question(kOrganExtent, 110e-6),
            ": is its unit right? (1000 times larger it would be 110 mm)");
  EXPECT_EQ(unit_question(kToolExtent, 12e-6), ": is its unit right? (1000 times larger it would be 12 mm)");
  EXPECT_EQ(unit_question(kOrganExtent, 1e30), ": is its unit right?");
}

TEST(Plausible, AColumnIsAskedForTheUnitThatGivesAUsualNumber) {
  EXPECT_EQ(column_question(kForceRange, 2300.0, "force_N", 1.0),
            ": is force_N in mN or gf? (it would be 2.3 or 22.6 N)");
  EXPECT_EQ(column_question(kPlausibleStiffness, 0.018, "k1_N_per_m", 1.0),
            ": is k1_N_per_m in N/cm? (it would be 1.8 N/m)")
      << "N/mm is ten times as much";
  EXPECT_EQ(column_question(kForceRange, 300e3, "force_N", 1.0), ": is force_N in uN? (it would be 0.3 N)");
  EXPECT_EQ(column_question(kDepthRange, 12.0, "displacement_mm", 1e-3),
            ": is displacement_mm in um? (it would be 12 mm)");
  EXPECT_EQ(column_question(kDepthRange, 12e-6, "displacement_mm", 1e-3),
            ": is displacement_mm in m? (it would be 12 mm)");
  EXPECT_EQ(column_question(kForceRange, 1e30, "force_N", 1.0), "");
}

TEST(Plausible, TimesSince1970InOtherUnitsThanSecondsAreRecognizedByTheirSize) {
  EXPECT_EQ(unix_time_question(0.0), "");
  EXPECT_EQ(unix_time_question(-5.0), "");
  EXPECT_EQ(unix_time_question(1636500000.1), "") << "seconds since 1970";
  EXPECT_EQ(unix_time_question(1636500000100.0), "must be in seconds: is time_s in ms since 1970?");
  EXPECT_EQ(unix_time_question(1.6365e15), "must be in seconds: is time_s in us since 1970?");
  EXPECT_EQ(unix_time_question(1.6365e18), "must be in seconds: is time_s in ns since 1970?");
  EXPECT_EQ(unix_time_question(1e30), "must be in seconds");
}

TEST(Plausible, SlowRowsAreAskedForTheUnitOfTheirTimes) {
  EXPECT_EQ(slow_rows_question({20.0, 12e-6}, 1e-4), ": is time_s in ms? (the motion would reach 12 mm/s)");
  EXPECT_EQ(slow_rows_question({2e7, 12e-12}, 1e-4), ": is time_s in ns? (the motion would reach 12 mm/s)");
  EXPECT_EQ(slow_rows_question({0.9, 12e-6}, 1e-4), "") << "rows less than a second apart";
  EXPECT_EQ(slow_rows_question({20.0, 12e-3}, 1e-4), "") << "a usual speed";
}

TEST(Plausible, FastRowsAreAskedForTheUnitOfTheirTimes) {
  EXPECT_EQ(fast_rows_question({1e-6, 700.0}), ": is time_s in hours or days, as Excel counts?");
  EXPECT_EQ(fast_rows_question({1e-3, 4.9}), "") << "a fast hand";
}

}  // namespace
}  // namespace palpate
