#include "core/base/normal_distribution.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Normal, DensityAndDistributionAreTheStandardOnes) {
  EXPECT_NEAR(normal_density(0.0), 0.3989422804014327, 1e-15);
  EXPECT_NEAR(normal_density(1.0), 0.2419707245191434, 1e-15);
  EXPECT_NEAR(normal_cdf(0.0), 0.5, 1e-15);
  EXPECT_NEAR(normal_cdf(-1.96), 0.0249978951482204, 1e-15);
}

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

}  // namespace
}  // namespace palpate
