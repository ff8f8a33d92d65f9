#include "study/psychophysics/nelder_mead.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::psychophysics {
namespace {

TEST(NelderMead, FindsTheMinimumOfRosenbrocksFunction) {
  const auto cost = [](const std::vector<double>& x) {
    return 100.0 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1.0 - x[0], 2);
  };
  const Minimum found = minimize(cost, {-1.2, 1.0}, {0.1, 0.1}, 1e-14);
  EXPECT_NEAR(found.at[0], 1.0, 1e-4);
  EXPECT_NEAR(found.at[1], 1.0, 1e-4);
}

}  // namespace
}  // namespace palpate::psychophysics
