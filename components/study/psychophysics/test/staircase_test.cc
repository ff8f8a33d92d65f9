#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/error.h"

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {
namespace {

// Levels after each answer, 'C' or 'I'.
std::vector<double> levels_of(Staircase& stairs, const std::string& answers) {
  std::vector<double> levels;
  for (const char answer : answers) {
    stairs.update(answer == 'C');
    levels.push_back(stairs.level());
  }
  return levels;
}

TEST(Staircase, TwoCorrectAnswersStepDownAndOneIncorrectStepsUp) {
  Staircase stairs({.start = 10.0, .steps = {1.0}});
  EXPECT_EQ(levels_of(stairs, "CCICICC"), (std::vector<double>{10, 9, 10, 10, 11, 11, 10}));
}

TEST(Staircase, ThreeCorrectAnswersStepDown) {
  Staircase stairs({.start = 10.0, .down = 3, .steps = {1.0}});
  EXPECT_EQ(levels_of(stairs, "CCCCCI"), (std::vector<double>{10, 10, 9, 9, 9, 10}));
}

TEST(Staircase, StepsBecomeSmallerAfterReversals) {
  Staircase stairs({.start = 20.0, .down = 1, .steps = {4.0, 2.0, 1.0}});
  // Reversals at 16, 20, 18, 20: steps 4 before two, 2 before four, then 1.
  EXPECT_EQ(levels_of(stairs, "CICICI"), (std::vector<double>{16, 20, 18, 20, 19, 20}));
}

TEST(Staircase, DownwardStepIsWeighted) {
  Staircase stairs({.start = 9.0, .down = 1, .steps = {3.0}, .down_ratio = 1.0 / 3.0});
  EXPECT_EQ(levels_of(stairs, "CCI"), (std::vector<double>{8, 7, 10}));
}

TEST(Staircase, MeanOfReversalsLeavesOutTheFirst) {
  Staircase stairs({.start = 5.0, .down = 1, .steps = {1.0}, .discarded = 2});
  (void)levels_of(stairs, "CICC");  // reversals at 4 and 5
  EXPECT_FALSE(stairs.mean().has_value());
  (void)levels_of(stairs, "II");  // at 3
  EXPECT_FALSE(stairs.mean().has_value());
  (void)levels_of(stairs, "C");  // at 5
  ASSERT_TRUE(stairs.mean().has_value());
  EXPECT_EQ(*stairs.mean(), 4.0);
}

TEST(Staircase, LevelStaysWithinItsLimits) {
  Staircase stairs({.start = 1.0, .down = 1, .steps = {1.0}, .least = 0.5, .largest = 1.5});
  EXPECT_EQ(levels_of(stairs, "CCII"), (std::vector<double>{0.5, 0.5, 1.5, 1.5}));
}

TEST(Staircase, InvalidSetupsAreRejected) {
  EXPECT_THROW(Staircase({.down = 0}), ParameterError);
  EXPECT_THROW(Staircase({.steps = {}}), ParameterError);
  EXPECT_THROW(Staircase({.steps = {0.0}}), ParameterError);
  EXPECT_THROW(Staircase({.reversals_per_step = 0}), ParameterError);
  EXPECT_THROW(Staircase({.down_ratio = 0.0}), ParameterError);
  EXPECT_THROW(Staircase({.start = 1.0, .largest = 0.0}), ParameterError);
  EXPECT_THROW(Staircase({.discarded = -1}), ParameterError);
}

// Mean share of correct answers of a long staircase with small steps.
double share_correct(int down, double down_ratio) {
  Staircase stairs({.start = 0.0, .down = down, .steps = {0.02}, .down_ratio = down_ratio});
  const PsychometricFunction function;
  Random random(3, static_cast<std::uint32_t>(down), static_cast<std::uint32_t>(100.0 * down_ratio));
  constexpr int kTrials = 20000;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double correct = function(stairs.level(), {0.0, 2.0, 0.0});
    sum += correct;
    stairs.update(random.uniform() < correct);
  }
  return sum / kTrials;
}

TEST(Staircase, LongRunsConvergeToTheKnownShares) {
  EXPECT_NEAR(share_correct(2, 1.0), std::sqrt(0.5), 0.01);
  EXPECT_NEAR(share_correct(3, 1.0), std::cbrt(0.5), 0.01);
  EXPECT_NEAR(share_correct(1, 1.0 / 3.0), 0.75, 0.01);  // [Kaernbach 1991]
  EXPECT_NEAR(share_correct(2, 0.5488), 0.8035, 0.01);   // [Garcia-Perez 1998]
  EXPECT_NEAR(share_correct(3, 0.7393), 0.8315, 0.01);
}

// Share of 400 people with a mean of reversals after 40 trials.
double share_with_mean(int down) {
  constexpr int kPeople = 400;
  const PsychometricFunction function;
  int usable = 0;
  for (std::uint32_t person = 0; person < kPeople; ++person) {
    Random random(4, static_cast<std::uint32_t>(down), person);
    Staircase stairs({.start = 0.5, .down = down, .steps = {0.2, 0.1, 0.05}});
    for (int trial = 0; trial < 40; ++trial) {
      stairs.update(random.uniform() < function(stairs.level(), {0.0, 2.5, 0.02}));
    }
    usable += stairs.mean().has_value() ? 1 : 0;
  }
  return static_cast<double>(usable) / kPeople;
}

TEST(Staircase, FortyTrialsAreTooFewForThreeDown) {
  EXPECT_GT(share_with_mean(2), 0.8);
  EXPECT_LT(share_with_mean(3), 0.5);
}

}  // namespace
}  // namespace palpate::psychophysics
