#include "science/psychophysics/normal.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate::psychophysics {
namespace {

TEST(Normal, DistributionFunctionAgreesWithTheErrorFunction) {
  for (int i = -900; i <= 900; ++i) {
    const double z = 0.01 * i;
    EXPECT_NEAR(normal_cdf(z), 0.5 * std::erfc(-z / std::sqrt(2.0)), 1e-15) << z;
  }
  EXPECT_NEAR(normal_cdf(-8.0) / (0.5 * std::erfc(8.0 / std::sqrt(2.0))), 1.0, 1e-13);
}

TEST(Normal, DistributionFunctionHasItsLimits) {
  EXPECT_EQ(normal_cdf(0.0), 0.5);
  EXPECT_EQ(normal_cdf(1e300), 1.0);
  EXPECT_EQ(normal_cdf(-HUGE_VAL), 0.0);
  EXPECT_TRUE(std::isnan(normal_cdf(std::nan(""))));
}

TEST(Normal, QuantileInvertsTheDistributionFunction) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-14);
  for (const double p : {1e-6, 0.2, 0.5, 0.9}) EXPECT_NEAR(normal_cdf(normal_quantile(p)), p, 1e-14);
}

TEST(Normal, StudentQuantileHasItsTabulatedValue) {
  EXPECT_NEAR(student_t_quantile(11.0), 2.200985, 1e-6);
  EXPECT_NEAR(student_t_two_sided(2.200985, 11.0), 0.05, 1e-7);
  EXPECT_NEAR(student_t_two_sided(-2.200985, 11.0), 0.05, 1e-7);
}

}  // namespace
}  // namespace palpate::psychophysics
