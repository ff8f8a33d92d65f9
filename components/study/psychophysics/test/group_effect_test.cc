#include "study/psychophysics/group_effect.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/error.h"

#include "study/psychophysics/simulated_group.h"

namespace palpate::psychophysics {
namespace {

// A person with exactly the expected share of answers "second" in many trials at each level.
PairedCounts exact_person(const QuestPlusGrid& grid, double spread, double change) {
  constexpr int kTrials = 400;
  PairedCounts counts;
  for (const double level : grid.levels) {
    const double off = grid.function(level, {0.0, spread, 0.02});
    const double with = grid.function(level, {0.0, spread * std::exp(change), 0.02});
    counts.off.push_back({kTrials, static_cast<int>(std::lround(kTrials * off))});
    counts.with.push_back({kTrials, static_cast<int>(std::lround(kTrials * with))});
  }
  return counts;
}

TEST(GroupEffect, FindsThePopulationOfExactPeople) {
  const QuestPlusGrid grid = difference_grid();
  const GroupModel model(grid);
  const std::vector<double> ln_spreads = {-1.9, -1.6, -1.3, -1.9, -1.6, -1.3};
  const std::vector<double> changes = {-0.1, -0.1, -0.1, -0.3, -0.3, -0.3};
  std::vector<PairedCounts> people;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    people.push_back(exact_person(grid, std::exp(ln_spreads[i]), changes[i]));
  }
  const GroupEffect found = model.fit(people);
  EXPECT_NEAR(found.effect, -0.2, 0.01);
  EXPECT_NEAR(found.effect_sd, 0.1, 0.02);
  EXPECT_NEAR(found.mean_ln_spread, -1.6, 0.02);
  EXPECT_NEAR(found.ln_spread_sd, std::sqrt(0.06), 0.03);
  // Paired t of the changes: standard error 0.1095/sqrt 6 = 0.0447, t(5, 0.975) = 2.571, so -0.2 +- 0.115;
  // T = -4.47, p = 0.0066. The answers know each change up to about 0.03, which widens it a little.
  EXPECT_NEAR(found.low, -0.315, 0.02);
  EXPECT_NEAR(found.high, -0.085, 0.02);
  EXPECT_NEAR(found.p_value, 0.0066, 0.001);
}

// Each person's threshold rises by a factor of 1.35; three of six go beyond the largest stimulus.
TEST(GroupEffect, ThresholdsBeyondTheStimuliCountByTheirAnswers) {
  const QuestPlusGrid grid = detection_grid(0.01, 1.0, 10);
  const GroupModel model(grid);
  std::vector<PairedCounts> people;
  for (const double threshold : {-0.6, -0.5, -0.3, -0.1, -0.05, -0.02}) {
    PairedCounts counts;
    for (const double level : grid.levels) {
      constexpr int kTrials = 400;
      const double location = threshold - threshold_of({0.0, 2.5, 0.0});
      const double off = grid.function(level, {location, 2.5, 0.02});
      const double with = grid.function(level, {location + std::log10(1.35), 2.5, 0.02});
      counts.off.push_back({kTrials, static_cast<int>(std::lround(kTrials * off))});
      counts.with.push_back({kTrials, static_cast<int>(std::lround(kTrials * with))});
    }
    people.push_back(counts);
  }
  const GroupEffect found = model.fit(people);
  EXPECT_NEAR(found.effect, std::log(1.35), 0.05);  // beyond the stimuli the prior of the slopes decides too
  EXPECT_GT(found.low, 0.2);
  EXPECT_LT(found.high, 0.4);
}

// Nobody with noise is right more often than by chance: the thresholds are above all stimuli, as far as the
// model goes, and the interval says that it is open.
TEST(GroupEffect, AnArmAnsweredByChanceIsAnEffectWithoutAnUpperEnd) {
  const QuestPlusGrid grid = detection_grid(0.01, 1.0, 10);
  const GroupModel model(grid);
  std::vector<PairedCounts> people;
  for (int person = 0; person < 12; ++person) {
    const double threshold = -0.6 + 0.02 * person;
    PairedCounts counts;
    for (const double level : grid.levels) {
      const double off = grid.function(level, {threshold, 2.5, 0.02});
      counts.off.push_back({40, static_cast<int>(std::lround(40 * off))});
      counts.with.push_back({40, 20});
    }
    people.push_back(counts);
  }
  const GroupEffect found = model.fit(people);
  EXPECT_GT(found.low, std::log(1.5));
  EXPECT_GT(found.high, 0.99 * GroupModel::largest_effect());
}

TEST(GroupEffect, IntervalContainsZeroExactlyWhenTheTestDoesNotReject) {
  QuestPlus quest(difference_grid());
  const GroupModel model(quest.grid());
  for (std::uint32_t group = 0; group < 4; ++group) {
    const SimulatedGroup simulated{8, 30, group % 2 == 0 ? 1.0 : 0.8};
    const GroupEffect found = model.fit(simulate_group(quest, simulated, group));
    EXPECT_LT(found.low, found.effect);
    EXPECT_GT(found.high, found.effect);
    EXPECT_EQ(found.low <= 0.0 && found.high >= 0.0, found.p_value >= 0.05) << group;
  }
}

TEST(GroupEffect, InvalidDataAreRejected) {
  const QuestPlusGrid grid = difference_grid();
  const GroupModel model(grid);
  const PairedCounts person = exact_person(grid, 0.2, 0.0);
  EXPECT_THROW((void)model.fit(std::vector<PairedCounts>{person}), ParameterError);
  PairedCounts shorter = person;
  shorter.off.pop_back();
  EXPECT_THROW((void)model.fit(std::vector<PairedCounts>{person, shorter}), ParameterError);
  PairedCounts wrong = person;
  wrong.with[0] = {1, 2};
  EXPECT_THROW((void)model.fit(std::vector<PairedCounts>{person, wrong}), ParameterError);
  QuestPlusGrid three = detection_grid(1.0, 100.0, 20);
  three.function.guess = 1.0 / 3.0;
  EXPECT_THROW(GroupModel{three}, ParameterError);
  QuestPlusGrid decibels = detection_grid(1.0, 100.0, 20);
  decibels.function.decades_per_unit = 0.05;
  EXPECT_THROW(GroupModel{decibels}, ParameterError);
}

}  // namespace
}  // namespace palpate::psychophysics
