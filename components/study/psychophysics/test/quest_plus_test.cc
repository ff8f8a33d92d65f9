#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/error.h"

#include "study/psychophysics/psychophysics.h"
#include "study/psychophysics/test/watson_runs.h"

namespace palpate::psychophysics {
namespace {

using testing::HasSubstr;

std::vector<double> steps_of_one(int first, int last) {
  std::vector<double> values;
  for (int i = first; i <= last; ++i) values.push_back(i);
  return values;
}

// Watson's grid of a Weibull function in dB, two intervals.
QuestPlusGrid decibel_grid(std::vector<double> slopes, std::vector<double> lapses) {
  QuestPlusGrid grid;
  grid.function.decades_per_unit = 0.05;
  grid.levels = steps_of_one(-40, 0);
  grid.location.values = grid.levels;
  grid.spread.values = std::move(slopes);
  grid.lapse.values = std::move(lapses);
  grid.lapse_is_nuisance = false;
  grid.most_repeats = 0;
  return grid;
}

// Watson's grid of a normal distribution. His lapse rate is half of ours.
QuestPlusGrid normal_grid() {
  QuestPlusGrid grid;
  grid.function.shape = PsychometricFunction::Shape::kNormal;
  grid.levels = steps_of_one(-10, 10);
  grid.location.values = steps_of_one(-5, 5);
  grid.spread.values = steps_of_one(1, 10);
  grid.lapse.values = {0.0, 0.02, 0.04, 0.06, 0.08};
  grid.lapse_is_nuisance = false;
  grid.most_repeats = 0;
  return grid;
}

// Replays a run. Every published stimulus must have the least expected entropy within 1e-9 nats; next()
// returns it except in such a tie. Returns the number of ties.
int replay(QuestPlus& quest, const WatsonRun& run) {
  int ties = 0;
  for (std::size_t trial = 0; trial < run.stimuli.size(); ++trial) {
    const std::vector<double> entropies = quest.expected_entropies();
    const std::vector<double>& levels = quest.grid().levels;
    const auto published = static_cast<std::size_t>(
        std::find(levels.begin(), levels.end(), run.stimuli[trial]) - levels.begin());
    const double least = *std::min_element(entropies.begin(), entropies.end());
    EXPECT_LE(entropies[published], least + 1e-9) << "trial " << trial + 1;
    if (quest.next() != published) ++ties;
    quest.update(published, run.responses[trial] == 'C');
  }
  return ties;
}

double first_entropy(const QuestPlus& quest) {
  const std::vector<double> entropies = quest.expected_entropies();
  return *std::min_element(entropies.begin(), entropies.end());
}

double location_of(const Parameters& at) { return at.location; }
double spread_of(const Parameters& at) { return at.spread; }
double lapse_of(const Parameters& at) { return at.lapse; }

TEST(QuestPlus, ReplaysWatsonsThresholdRun) {
  QuestPlus quest(decibel_grid({3.5}, {0.02}));
  EXPECT_NEAR(first_entropy(quest), 3.562726827982, 1e-11);
  EXPECT_EQ(replay(quest, kThreshold), 0);
  const Estimate found = quest.estimate(location_of);
  EXPECT_NEAR(found.mean, -20.39360311639, 1e-10);
  EXPECT_NEAR(found.sd, 1.389334005921, 1e-10);
  double entropy = 0.0;
  for (const double one : quest.posterior()) entropy -= one > 0.0 ? one * std::log(one) : 0.0;
  EXPECT_NEAR(entropy, 1.6835011546, 1e-9);
}

TEST(QuestPlus, ReplaysWatsonsThresholdAndSlopeRun) {
  QuestPlus quest(decibel_grid({2, 3, 4, 5}, {0.02}));
  EXPECT_NEAR(first_entropy(quest), 4.952560574321, 1e-11);
  EXPECT_EQ(replay(quest, kThresholdSlope), 0);
  EXPECT_NEAR(quest.estimate(location_of).mean, -19.5824257232, 1e-9);
  EXPECT_NEAR(quest.estimate(spread_of).mean, 3.3075361995, 1e-9);
}

TEST(QuestPlus, ReplaysWatsonsThresholdSlopeAndLapseRun) {
  QuestPlus quest(decibel_grid({2, 3, 4, 5}, {0.0, 0.01, 0.02, 0.03, 0.04}));
  EXPECT_NEAR(first_entropy(quest), 6.558884097652, 1e-11);
  EXPECT_LE(replay(quest, kThresholdSlopeLapse), 2);  // stimuli near 0 tie in trials 95 and 96
  EXPECT_NEAR(quest.estimate(location_of).mean, -19.5972750672, 1e-9);
  EXPECT_NEAR(quest.estimate(spread_of).mean, 4.1822975163, 1e-9);
  EXPECT_NEAR(quest.estimate(lapse_of).mean, 0.0277765168, 1e-9);
}

TEST(QuestPlus, ReplaysWatsonsMeanAndDeviationRun) {
  QuestPlus quest(normal_grid());
  EXPECT_NEAR(first_entropy(quest), 6.161276901400, 1e-11);
  EXPECT_EQ(replay(quest, kMeanSdLapse), 0);
  EXPECT_NEAR(quest.estimate(location_of).mean, -0.1021096112, 1e-9);
  EXPECT_NEAR(quest.estimate(spread_of).mean, 4.1768222353, 1e-9);
  EXPECT_NEAR(quest.estimate(lapse_of).mean, 2 * 0.0193461069, 1e-9);
}

TEST(QuestPlus, ProbabilitiesGiveThePublishedLogLikelihood) {
  const std::vector<int> levels = {-18, -22, -12, -13, -15, -16, -17, -18, -19, -20, -22,
                                   -25, -19, -16, -17, -18, -18, -18, -16, -17, -17, -17,
                                   -18, -18, -18, -18, -18, -19, -19, -19, -19, -19};
  const std::string responses = "CICCCCCCCCCIICCCCICCCCCCCCCCCCCC";
  const PsychometricFunction function = decibel_grid({3}, {0.02}).function;
  double sum = 0.0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double correct = function(levels[i], {-20.0, 3.0, 0.02});
    sum += std::log(responses[i] == 'C' ? correct : 1.0 - correct);
  }
  EXPECT_NEAR(sum, -9.158826421454, 1e-11);
}

// The definition, by updating a copy with each response.
double entropy_after(const QuestPlus& quest, std::size_t level) {
  double sum = 0.0;
  double expected = 0.0;
  for (const bool counted : {true, false}) {
    double probability = 0.0;
    for (std::size_t i = 0; i < quest.posterior().size(); ++i) {
      const auto lapses = quest.grid().lapse.values.size();
      const auto spreads = quest.grid().spread.values.size();
      const double yes = quest.grid().function(
          quest.grid().levels[level],
          {quest.grid().location.values[i / lapses / spreads],
           quest.grid().spread.values[i / lapses % spreads], quest.grid().lapse.values[i % lapses]});
      probability += quest.posterior()[i] * (counted ? yes : 1.0 - yes);
    }
    QuestPlus copy = quest;
    copy.update(level, counted);
    const std::size_t group = copy.grid().lapse.values.size();
    double entropy = 0.0;
    for (std::size_t i = 0; i < copy.posterior().size(); i += group) {
      double one = 0.0;
      for (std::size_t j = i; j < i + group; ++j) one += copy.posterior()[j];
      if (one > 0.0) entropy -= one * std::log(one);
    }
    expected += probability * entropy;
    sum += probability;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  return expected;
}

TEST(QuestPlus, ExpectedEntropyWithoutTheLapseRateFollowsItsDefinition) {
  QuestPlus quest(difference_grid());
  Random random(1, 0, 0);
  for (int trial = 0; trial < 20; ++trial) {
    const std::size_t level = quest.next();
    quest.update(level,
                 random.uniform() < quest.grid().function(quest.grid().levels[level], {0.0, 0.2, 0.02}));
  }
  const std::vector<double> entropies = quest.expected_entropies();
  for (const std::size_t level : {std::size_t{0}, std::size_t{9}, std::size_t{20}}) {
    EXPECT_NEAR(entropies[level], entropy_after(quest, level), 1e-9);
  }
}

TEST(QuestPlus, StimulusIsNotShownMoreThanThreeTimesInSuccession) {
  QuestPlus quest(detection_grid(1.0, 100.0, 20));
  std::size_t last = 0;
  int repeats = 0;
  int longest = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const std::size_t level = quest.next();
    repeats = level == last ? repeats + 1 : 1;
    last = level;
    longest = std::max(longest, repeats);
    quest.update(level, quest.grid().levels[level] > 1.0);
  }
  EXPECT_EQ(longest, 3);
}

TEST(QuestPlus, FirstOfEqualStimuliIsTaken) {
  QuestPlusGrid grid = normal_grid();  // symmetric before the first trial
  grid.levels = {-1.0, 1.0};
  EXPECT_EQ(QuestPlus(grid).next(), 0U);
}

TEST(QuestPlus, ThresholdIsReportedAtThreeQuartersCorrect) {
  const PsychometricFunction function;
  const Parameters at = {0.7, 2.5, 0.0};
  EXPECT_NEAR(function(threshold_of(at), at), 0.75, 1e-14);
  EXPECT_NEAR(function(at.location, at), 1.0 - 0.5 / std::exp(1.0), 1e-14);
}

TEST(QuestPlus, JustNoticeableDifferenceIsAtThreeQuarters) {
  PsychometricFunction function;
  function.shape = PsychometricFunction::Shape::kNormal;
  const Parameters at = {0.0, 0.2, 0.0};
  const double difference = std::pow(10.0, log10_difference_of(at));
  EXPECT_NEAR(function(std::log1p(difference), at), 0.75, 1e-14);
}

TEST(QuestPlus, ResetReturnsToThePrior) {
  QuestPlus quest(detection_grid(1.0, 100.0, 20));
  const std::vector<double> prior(quest.posterior().begin(), quest.posterior().end());
  const std::size_t first = quest.next();
  for (int i = 0; i < 3; ++i) quest.update(first, i > 0);
  quest.reset();
  EXPECT_EQ(std::vector<double>(quest.posterior().begin(), quest.posterior().end()), prior);
  EXPECT_EQ(quest.next(), first);
}

TEST(QuestPlus, PersonBeyondTheRangeOfStimuliIsRecognized) {
  QuestPlus inside(detection_grid(1.0, 100.0, 20));
  QuestPlus beyond = inside;
  for (int trial = 0; trial < 40; ++trial) {
    const std::size_t level = inside.next();
    inside.update(level, inside.grid().levels[level] > 1.0);
    beyond.update(beyond.next(), trial % 2 == 0);
  }
  EXPECT_LT(inside.edge_probability(), 0.01);
  EXPECT_GT(beyond.edge_probability(), 0.01);
}

TEST(QuestPlus, DetectionGridIsAsDocumented) {
  const QuestPlusGrid grid = detection_grid(1.0, 100.0, 20);
  ASSERT_EQ(grid.levels.size(), 41U);
  EXPECT_NEAR(grid.levels.back(), 2.0, 1e-12);
  ASSERT_EQ(grid.location.values.size(), 81U);
  EXPECT_NEAR(grid.location.weights[16] / grid.location.weights[40], std::exp(-0.5), 1e-12);  // 0.6 below
}

TEST(QuestPlus, DifferenceGridIsSymmetricAndGeometric) {
  const QuestPlusGrid grid = difference_grid(1.02, 3.3, 14);
  ASSERT_EQ(grid.levels.size(), 28U);
  EXPECT_NEAR(grid.levels.back(), std::log(3.3), 1e-12);
  EXPECT_NEAR(grid.levels[14], std::log(1.02), 1e-12);
  EXPECT_EQ(grid.levels.front(), -grid.levels.back());
  EXPECT_NEAR(grid.levels[15] / grid.levels[14], grid.levels[27] / grid.levels[26], 1e-12);
  EXPECT_NEAR(grid.spread.values.front(), std::pow(10.0, -1.7), 1e-12);
  EXPECT_EQ(grid.spread.values.back(), 1.0);
  EXPECT_NEAR(grid.spread.weights[10] / grid.spread.weights[20], std::exp(-0.5), 1e-12);    // -1.2 and -0.7
  EXPECT_NEAR(grid.location.weights[3] / grid.location.weights[5], std::exp(-0.5), 1e-12);  // -0.08 and 0
}

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "no error";
}

TEST(QuestPlus, InvalidGridsAreRejectedByName) {
  const auto with = [](const std::function<void(QuestPlusGrid&)>& change) {
    QuestPlusGrid grid = decibel_grid({3.5}, {0.02});
    change(grid);
    return message_of([&] { QuestPlus quest(grid); });
  };
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.levels = {}; }), HasSubstr("levels"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.levels = {1.0, 1.0}; }), HasSubstr("ascending"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.spread.values = {0.0}; }), HasSubstr("spread"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.location.values = {}; }), HasSubstr("location"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.lapse.values = {0.6}; }), HasSubstr("lapse"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.lapse.weights = {0.5, 0.5}; }), HasSubstr("one for each"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.lapse.weights = {-1.0}; }), HasSubstr(">= 0"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.lapse.weights = {0.0}; }), HasSubstr("sum > 0"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.function.guess = 1.0; }), HasSubstr("guess"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.function.decades_per_unit = 0.0; }), HasSubstr("decades"));
  EXPECT_THAT(with([](QuestPlusGrid& grid) { grid.most_repeats = -1; }), HasSubstr("most_repeats"));
}

TEST(QuestPlus, InvalidRangesOfStimuliAreRejected) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)detection_grid(0.0, 1.0, 20), ParameterError);
  EXPECT_THROW((void)detection_grid(2.0, 1.0, 20), ParameterError);
  EXPECT_THROW((void)detection_grid(1.0, 1.01, 20), ParameterError);
  EXPECT_THROW((void)detection_grid(1.0, infinity, 20), ParameterError);
  EXPECT_THROW((void)detection_grid(1.0, 10.0, 0), ParameterError);
  EXPECT_THROW((void)difference_grid(1.0, 2.0, 5), ParameterError);
  EXPECT_THROW((void)difference_grid(2.0, 1.5, 5), ParameterError);
  EXPECT_THROW((void)difference_grid(1.1, 2.0, 1), ParameterError);
}

TEST(QuestPlus, ImpossibleTrialsAreRejected) {
  QuestPlusGrid grid = normal_grid();
  grid.lapse.values = {0.0};
  grid.levels = {1000.0};
  QuestPlus quest(grid);
  EXPECT_THAT(message_of([&] { quest.update(0, false); }), HasSubstr("lapse rate > 0"));
  EXPECT_THAT(message_of([&] { quest.update(1, true); }), HasSubstr("level"));
}

}  // namespace
}  // namespace palpate::psychophysics
