#include "science/identify/distributions.h"

#include <gtest/gtest.h>

namespace palpate::identify {
namespace {

TEST(Normal, DensityAndDistributionAreTheStandardOnes) {
  EXPECT_NEAR(normal_density(0.0), 0.3989422804014327, 1e-15);
  EXPECT_NEAR(normal_density(1.0), 0.2419707245191434, 1e-15);
  EXPECT_NEAR(normal_cdf(0.0), 0.5, 1e-15);
  EXPECT_NEAR(normal_cdf(-1.96), 0.0249978951482204, 1e-15);
}

// Reference values: qt(0.975, f) of R.
TEST(Student, IsThatOfTheTablesFromThreeDegreesOfFreedomOn) {
  EXPECT_NEAR(student_t_quantile(1.0), 3.182446305, 1e-9);
  EXPECT_NEAR(student_t_quantile(3.0), 3.182446305, 1e-9);
  EXPECT_NEAR(student_t_quantile(10.0), 2.228138852, 1e-9);
  EXPECT_NEAR(student_t_quantile(1e6), 1.959966, 1e-5);
}

}  // namespace
}  // namespace palpate::identify
