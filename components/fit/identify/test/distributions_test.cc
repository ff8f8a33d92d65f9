#include <gtest/gtest.h>

#include "fit/identify/intervals.h"

namespace palpate::identify {
namespace {

// Reference values: qt(0.975, f) of R.
TEST(Student, IsThatOfTheTablesFromThreeDegreesOfFreedomOn) {
  EXPECT_NEAR(student_t_quantile(1.0), 3.182446305, 1e-9);
  EXPECT_NEAR(student_t_quantile(3.0), 3.182446305, 1e-9);
  EXPECT_NEAR(student_t_quantile(10.0), 2.228138852, 1e-9);
  EXPECT_NEAR(student_t_quantile(1e6), 1.959966, 1e-5);
}

}  // namespace
}  // namespace palpate::identify
