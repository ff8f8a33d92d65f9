// Simulated groups are analysed. Bounds hold for another seed with more than 99 % probability.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"

#include "study/psychophysics/comparisons.h"
#include "study/psychophysics/group_effect.h"
#include "study/psychophysics/psychophysics.h"
#include "study/psychophysics/simulated_group.h"
#include "study/psychophysics/test/study_table.h"

namespace palpate::psychophysics {
namespace {

struct GroupFigures {
  double bias = 0.0;      // of the mean of ln(s with/s off)
  double coverage = 0.0;  // of its 95 % interval
  double rejected = 0.0;  // share of groups with p < 0.05
};

GroupFigures analyse_groups(const SimulatedGroup& group, int groups, std::uint32_t first,
                            const QuestPlusGrid& grid = difference_grid()) {
  QuestPlus quest(grid);
  const GroupModel model(quest.grid());
  const double truth = std::log(group.ratio);
  GroupFigures figures;
  for (int i = 0; i < groups; ++i) {
    const GroupEffect found = model.fit(simulate_group(quest, group, first + static_cast<std::uint32_t>(i)));
    figures.bias += (found.effect - truth) / groups;
    figures.coverage += (found.low <= truth && truth <= found.high ? 1.0 : 0.0) / groups;
    figures.rejected += (found.p_value < 0.05 ? 1.0 : 0.0) / groups;
  }
  const std::string what = "ratio " + std::to_string(group.ratio) + ", " + std::to_string(group.people) +
                           " people, " + std::to_string(group.trials) + " trials: ";
  print_figure(what + "bias", figures.bias);
  print_figure(what + "coverage", figures.coverage);
  print_figure(what + "rejected", figures.rejected);
  return figures;
}

TEST(GroupStudy, GroupWithoutEffectIsRarelySignificant) {
  const GroupFigures figures = analyse_groups({24, 60, 1.0}, simulated(4, 400), 1000);
  EXPECT_LE(std::abs(figures.bias), full_table() ? 0.02 : 0.15);
  EXPECT_GE(figures.coverage, full_table() ? 0.92 : 0.5);
  EXPECT_LE(figures.coverage, full_table() ? 0.995 : 1.0);
  EXPECT_LE(figures.rejected, full_table() ? 0.06 : 0.5);
}

TEST(GroupStudy, EffectOfTwentyPercentIsFoundWithoutBias) {
  const GroupFigures figures = analyse_groups({32, 60, 0.80}, simulated(4, 400), 2000);
  EXPECT_LE(std::abs(figures.bias), full_table() ? 0.02 : 0.15);
  EXPECT_GE(figures.coverage, full_table() ? 0.92 : 0.5);
  EXPECT_GE(figures.rejected, full_table() ? 0.85 : 0.5);
}

TEST(GroupStudy, EffectOfFifteenPercentIsFoundWithManyTrials) {
  if (!full_table()) return;
  const GroupFigures figures = analyse_groups({24, 120, 0.85}, 400, 3000);
  EXPECT_LE(std::abs(figures.bias), 0.02);
  EXPECT_GE(figures.coverage, 0.92);
  EXPECT_GE(figures.rejected, 0.77);
}

// Stimuli as of an inclusion task with ratios 1.1 to 8: log10 of ln ratio. The mean threshold is that of a
// ratio of 4.5 without noise; with 1.35 times as much, every fourth person's lies above the largest stimulus.
TEST(GroupStudy, PeopleWhoseThresholdsLeaveTheRangeDoNotHideTheHarm) {
  const QuestPlusGrid grid = detection_grid(std::log(1.1), std::log(8.0), 11);
  SimulatedGroup group{24, 60, 1.35};
  group.mean_threshold = std::log10(std::log(4.5));
  const GroupFigures figures = analyse_groups(group, simulated(4, 600), 6000, grid);
  EXPECT_LE(std::abs(figures.bias), full_table() ? 0.02 : 0.15);
  EXPECT_GE(figures.coverage, full_table() ? 0.93 : 0.5);
  EXPECT_LE(figures.coverage, full_table() ? 0.97 : 1.0);
}

// Levels of the noise as shares of a person's own noise threshold.
const std::vector<double> kShares = {0.0, 0.3, 0.6, 0.9, 1.5, 2.5};
const std::vector<std::size_t> kMiddle = {2, 3};

// Probability of a correct answer at each share. @param noise_threshold in units of T
std::vector<double> curve_of(const Observer& observer, double signal, double noise_threshold) {
  std::vector<double> correct;
  for (const double share : kShares) {
    correct.push_back(probability_second(observer, {signal, share * noise_threshold, true}));
  }
  return correct;
}

// Shares of groups with an inverted U, and with a rise alone. Each person has 40 trials at each level.
// @param most_lapse lapse rates are uniform from 0 to this
std::pair<double, double> inverted_u_rate(const std::vector<double>& correct, int people, double most_lapse,
                                          int groups, std::uint32_t study) {
  constexpr int kTrials = 40;
  int found = 0;
  int rises = 0;
  for (int group = 0; group < groups; ++group) {
    Random random(29, study, static_cast<std::uint32_t>(group));
    std::vector<std::vector<double>> d_primes;
    for (int person = 0; person < people; ++person) {
      const double lapse = most_lapse * random.uniform();
      std::vector<double> of_person;
      for (const double without_lapse : correct) {
        const double probability = 0.5 * lapse + (1.0 - lapse) * without_lapse;
        Count intervals[2] = {{kTrials / 2, 0}, {kTrials / 2, 0}};
        for (int i = 0; i < kTrials; ++i) intervals[i % 2].counted += random.uniform() < probability ? 1 : 0;
        of_person.push_back(two_interval(intervals[0], intervals[1], true).d_prime);
      }
      d_primes.push_back(of_person);
    }
    const InvertedU result = inverted_u(d_primes, kMiddle);
    found += result.found() ? 1 : 0;
    rises += result.rise.greater <= 0.05 ? 1 : 0;
  }
  return {static_cast<double>(found) / groups, static_cast<double>(rises) / groups};
}

TEST(GroupStudy, InvertedUOfStochasticResonanceIsFound) {
  // 65 % correct without noise, 76 to 77 % at the middle levels.
  Observer observer = make_observer("sr");
  const int groups = simulated(100, 1000);
  const double weak =
      inverted_u_rate(curve_of(observer, 0.3783249292, 0.5817562888), 16, 0.02, groups, 1).first;
  print_figure("sr 0.35, 16 people: inverted U", weak);
  EXPECT_GE(weak, full_table() ? 0.95 : 0.88);
  observer.internal_noise = 0.40;  // 64 % correct without noise, 70 to 71 % at the middle levels
  const std::vector<double> curve = curve_of(observer, 0.301209, 0.575729);
  const double strong = inverted_u_rate(curve, 24, 0.02, groups, 2).first;
  print_figure("sr 0.40, 24 people: inverted U", strong);
  EXPECT_GE(strong, full_table() ? 0.88 : 0.78);
}

TEST(GroupStudy, InvertedUIsNotClaimedWithoutStochasticResonance) {
  const int groups = simulated(300, 1000);
  const std::vector<double> linear = curve_of(make_observer("linear"), 0.1907, 0.5818);
  for (const double most_lapse : {0.0, 0.1, 0.3}) {
    const auto harmed = inverted_u_rate(linear, 16, most_lapse, groups, 3);
    const auto same = inverted_u_rate(std::vector<double>(6, 0.65), 16, most_lapse, groups, 4);
    const std::string lapses = ", lapses to " + std::to_string(most_lapse);
    print_figure("linear, inverted U" + lapses, harmed.first);
    print_figure("no effect, inverted U" + lapses, same.first);
    print_figure("no effect, rise alone" + lapses, same.second);
    EXPECT_LE(harmed.first, 0.05);
    EXPECT_LE(same.first, 0.05);
  }
}

}  // namespace
}  // namespace palpate::psychophysics
