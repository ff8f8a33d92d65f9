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
  // Paired t of the changes: T = -0.2/(0.1095/sqrt 6) = -4.47. For known changes, twice the decrease of the
  // log likelihood is 6 ln(1 + T^2/5). It reaches t(5, 0.975)^2 = 2.571^2 at 3.17 standard errors, 0.142.
  EXPECT_NEAR(found.low, -0.342, 0.02);
  EXPECT_NEAR(found.high, -0.058, 0.02);
  EXPECT_NEAR(found.p_value, 0.0267, 0.003);
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
  EXPECT_THROW(GroupModel{detection_grid(1.0, 100.0, 20)}, ParameterError);
}

}  // namespace
}  // namespace palpate::psychophysics
