#include <cmath>

#include <gtest/gtest.h>

#include "palpate/error.h"

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {
namespace {

TEST(DetectionTheory, YesNoHasItsReferenceValues) {
  const Sensitivity found = yes_no({25, 20}, {25, 10});
  EXPECT_NEAR(found.d_prime, 1.0949683367, 1e-9);
  EXPECT_NEAR(found.criterion, -0.2941370652, 1e-9);
  EXPECT_TRUE(found.reliable);
}

TEST(DetectionTheory, LogLinearCorrectionHasItsReferenceValues) {
  const Sensitivity found = yes_no({25, 20}, {25, 10}, true);
  EXPECT_NEAR(found.d_prime, 1.0444987071, 1e-9);
  EXPECT_NEAR(found.criterion, -0.2788451757, 1e-9);
  EXPECT_NEAR(found.ln_beta, -0.2912534255, 1e-9);
}

TEST(DetectionTheory, TwoIntervalsHaveTheirReferenceValues) {
  const Sensitivity found = two_interval({50, 40}, {50, 30});
  EXPECT_NEAR(found.d_prime, 0.7742595361, 1e-9);
  EXPECT_NEAR(found.criterion, -0.2941370652, 1e-9);
}

TEST(DetectionTheory, ManyIntervalsHaveTheirReferenceValues) {
  EXPECT_NEAR(d_prime_of_correct(0.75, 2), 0.9538725524, 1e-9);
  EXPECT_NEAR(d_prime_of_correct(0.75, 3), 1.43383059, 1e-8);
  EXPECT_NEAR(d_prime_of_correct(0.75, 4), 1.68219520, 1e-8);
  EXPECT_NEAR(correct_of_d_prime(1.0, 2), 0.7602499389, 1e-9);
  EXPECT_NEAR(correct_of_d_prime(1.0, 3), 0.6337020458, 1e-9);
  EXPECT_NEAR(correct_of_d_prime(1.0, 4), 0.5520314384, 1e-9);
}

TEST(DetectionTheory, NoStatementIsMadeWithAnExtremeRate) {
  EXPECT_FALSE(yes_no({40, 38}, {40, 1}).reliable);   // 0.025
  EXPECT_FALSE(yes_no({40, 39}, {40, 10}).reliable);  // 0.975
  EXPECT_TRUE(yes_no({40, 38}, {40, 2}).reliable);
  EXPECT_FALSE(two_interval({40, 40}, {40, 20}).reliable);
  EXPECT_FALSE(two_interval({40, 20}, {40, 1}).reliable);
}

TEST(DetectionTheory, RatesOfZeroAndOneAreInfiniteWithoutCorrection) {
  EXPECT_EQ(yes_no({40, 20}, {40, 0}).d_prime, HUGE_VAL);
  EXPECT_TRUE(std::isfinite(yes_no({40, 40}, {40, 0}, true).d_prime));
}

TEST(DetectionTheory, InvalidCountsAreRejected) {
  EXPECT_THROW((void)yes_no({0, 0}, {1, 1}), ParameterError);
  EXPECT_THROW((void)yes_no({1, 2}, {1, 1}), ParameterError);
  EXPECT_THROW((void)two_interval({1, 1}, {1, -1}), ParameterError);
  EXPECT_THROW((void)correct_of_d_prime(1.0, 1), ParameterError);
  EXPECT_THROW((void)d_prime_of_correct(1.0, 2), ParameterError);
}

}  // namespace
}  // namespace palpate::psychophysics
