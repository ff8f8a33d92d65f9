#include "study/psychophysics/normal.h"

#include <gtest/gtest.h>

namespace palpate::psychophysics {
namespace {

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
