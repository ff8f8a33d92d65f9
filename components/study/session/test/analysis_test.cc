#include "study/session/analysis.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

#include "study/psychophysics/normal.h"
#include "study/session/test/simulated_log.h"

namespace palpate::study {
namespace {

constexpr std::size_t kThreshold = 0;
constexpr std::size_t kCurve = 1;
constexpr std::size_t kStiffness = 2;
constexpr std::size_t kHold = 3;

// People whose standard deviation with "constant" is `ratio` times that without noise.
std::vector<Participant> stiffness_group(const Study& study, int people, int trials, double ratio) {
  std::vector<Participant> group;
  for (std::uint32_t number = 0; number < static_cast<std::uint32_t>(people); ++number) {
    Random random(3, number, 0);
    const double spread = 0.15 + 0.1 * random.uniform();
    group.push_back(new_participant(number));
    add_stiffness(group.back(), study, trials, {spread, ratio * spread, spread}, random);
  }
  return group;
}

TEST(Analysis, PrimaryContrastIsFirstAndFindsTheEffect) {
  const Study study = test_study();
  const std::vector<Participant> people = stiffness_group(study, 12, 120, 0.65);
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  ASSERT_EQ(found.contrasts.size(), 2U);
  const Contrast& primary = found.contrasts.front();
  EXPECT_TRUE(primary.primary);
  EXPECT_EQ(primary.task, kStiffness);
  EXPECT_EQ(found.tasks[kStiffness].arms[primary.condition], "constant");
  EXPECT_EQ(found.tasks[kStiffness].arms[primary.reference], "off");
  EXPECT_FALSE(primary.holm);
  ASSERT_TRUE(primary.kept);
  EXPECT_NEAR(primary.kept->effect, std::log(0.65), 0.12);
  EXPECT_LT(primary.kept->high, 0.0);
  EXPECT_LT(primary.kept->p_value, 0.01);
  EXPECT_EQ(primary.kept->people, 12);
  const auto is_paper = [&](const Contrast& one) {
    return one.task == kStiffness && found.tasks[kStiffness].arms[one.condition] == "paper";
  };
  const auto paper = std::find_if(found.contrasts.begin(), found.contrasts.end(), is_paper);
  ASSERT_NE(paper, found.contrasts.end());
  EXPECT_FALSE(paper->primary);
  EXPECT_EQ(paper->alternative, "two-sided");
  ASSERT_TRUE(paper->holm);
  EXPECT_DOUBLE_EQ(*paper->holm, paper->kept->p_value);  // the only exploratory one of its task
  EXPECT_LT(std::abs(paper->kept->effect), 0.2);
}

TEST(Analysis, OneSidedAlternativeHalvesThePValueOnItsSideOnly) {
  Study study = test_study();
  const std::vector<Participant> people = stiffness_group(study, 4, 40, 0.8);
  study.primary->alternative = "two-sided";
  const Effect both = *analyse(study, people, kTestKey, true).contrasts.front().kept;
  ASSERT_LT(both.effect, 0.0);
  study.primary->alternative = "less";
  EXPECT_NEAR(analyse(study, people, kTestKey, true).contrasts.front().kept->p_value, 0.5 * both.p_value,
              1e-12);
  study.primary->alternative = "greater";
  const Effect greater = *analyse(study, people, kTestKey, true).contrasts.front().kept;
  EXPECT_NEAR(greater.p_value, 1.0 - 0.5 * both.p_value, 1e-12);
  // t(3): quantiles 0.975: 3.182446, 0.95: 2.353363, 0.8: 0.978472.
  EXPECT_NEAR(both.smallest_effect, 0.5 * (both.high - both.low) * (3.182446 + 0.978472) / 3.182446, 1e-6);
  EXPECT_NEAR(greater.smallest_effect, 0.5 * (both.high - both.low) * (2.353363 + 0.978472) / 3.182446, 1e-6);
}

TEST(Analysis, BlindAnalysisPoolsByLabelAndNamesNothing) {
  const Study study = test_study();
  const std::vector<Participant> people = stiffness_group(study, 3, 20, 0.7);
  const StudyAnalysis blind = analyse(study, people, kTestKey, false);
  const StudyAnalysis open = analyse(study, people, kTestKey, true);
  EXPECT_THAT(blind.tasks[kStiffness].arms, testing::ElementsAre("A", "B", "C"));
  EXPECT_TRUE(blind.tasks[kStiffness].shares.empty());
  const std::vector<std::size_t> labels = labels_of_arms(kTestKey, kStiffness, 3);
  for (std::size_t person = 0; person < 3; ++person) {
    for (std::size_t arm = 0; arm < 3; ++arm) {
      const ArmResult& a = open.people[person].tasks[kStiffness].arms[arm];
      const ArmResult& b = blind.people[person].tasks[kStiffness].arms[labels[arm]];
      EXPECT_EQ(a.fit->estimate.mean, b.fit->estimate.mean);
    }
  }
  int pairs = 0;
  for (const Contrast& contrast : blind.contrasts) {
    EXPECT_FALSE(contrast.primary);
    EXPECT_EQ(contrast.alternative, "two-sided");
    EXPECT_GT(contrast.condition, contrast.reference);
    pairs += contrast.task == kStiffness ? 1 : 0;
  }
  EXPECT_EQ(pairs, 3);
}

TEST(Analysis, EstimateDoesNotDependOnTheOrderOfTheTrials) {
  const Study study = test_study();
  std::vector<Participant> people = stiffness_group(study, 1, 30, 0.7);
  const double before = analyse(study, people, kTestKey, true).people[0].tasks[2].arms[1].fit->estimate.mean;
  std::reverse(people[0].log.trials.begin(), people[0].log.trials.end());
  const StudyAnalysis after = analyse(study, people, kTestKey, true);
  EXPECT_NEAR(after.people[0].tasks[2].arms[1].fit->estimate.mean, before, 1e-9);
}

TEST(Analysis, AConsentAfterARefusalCountsAsOneConsentedPerson) {
  std::vector<Participant> people = {new_participant(0), new_participant(1)};
  people[0].log.events.push_back({"", "consent", {{"answer", "no"}}});
  people[0].log.events.push_back({"", "consent", {{"answer", "yes"}}});
  people[1].log.events.push_back({"", "consent", {{"answer", "no"}}});
  people[1].log.events.push_back({"", "consent", {{"answer", "no"}}});
  const StudyAnalysis found = analyse(test_study(), people, kTestKey, true);
  EXPECT_EQ(found.consented, 1);
  EXPECT_EQ(found.refused, 1);
}

TEST(Analysis, PracticeAndSpoiledTrialsDoNotCount) {
  const Study study = test_study();
  std::vector<Participant> people = stiffness_group(study, 1, 20, 1.0);
  people[0].log.trials[0].practice = true;
  people[0].log.trials[3].spoiled = {"clamp", "late"};  // also of the first arm
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  const ArmResult& arm = found.people[0].tasks[kStiffness].arms[0];
  EXPECT_EQ(arm.trials, 18);
  EXPECT_EQ(arm.spoiled, 1);
  EXPECT_THAT(arm.reasons, testing::ElementsAre(testing::Pair("clamp", 1), testing::Pair("late", 1)));
  EXPECT_EQ(found.people[0].trials, 58);
  EXPECT_EQ(found.people[0].spoiled, 1);
  int answers = 0;
  for (const Point& point : arm.points) answers += point.count.trials;
  EXPECT_EQ(answers, 18);
}

TEST(Analysis, PeopleWhoWithdrewAreLeftOut) {
  const Study study = test_study();
  std::vector<Participant> people = stiffness_group(study, 3, 20, 1.0);
  people[1].log.events.push_back({"2026-03-01T10:00:00Z", "withdrawn", {}});
  people[1].log.events.push_back({"", "blinding", {{"who", "participant"}, {"task", "stiffness"}}});
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  EXPECT_EQ(found.withdrawn, 1);
  EXPECT_TRUE(found.people[1].tasks.empty());
  EXPECT_EQ(found.contrasts.front().everybody->people, 2);
  EXPECT_TRUE(found.guesses.empty());
}

TEST(Analysis, ExcludedPeopleAreShownBothWays) {
  const Study study = test_study();
  std::vector<Participant> people = stiffness_group(study, 4, 20, 1.0);
  for (int i = 0; i < 10; ++i) {  // 6 of 10 catch trials correct
    TrialRecord& trial = people[0].log.trials[static_cast<std::size_t>(i)];
    trial.catch_trial = true;
    trial.level = 1.0;
    trial.counted = i < 6;
  }
  for (std::size_t i = 0; i < 7; ++i) people[1].log.trials[i].spoiled = {"band"};  // 7 of 60
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  EXPECT_EQ(found.excluded, 2);
  EXPECT_THAT(found.people[0].exclusions,
              testing::ElementsAre("6 of 10 catch trials correct, less than 70 %"));
  EXPECT_THAT(found.people[1].exclusions, testing::ElementsAre("7 of 60 trials spoiled, more than 10 %"));
  EXPECT_EQ(found.contrasts.front().kept->people, 2);
  EXPECT_EQ(found.contrasts.front().everybody->people, 4);
}

TEST(Analysis, ThresholdOutsideTheRangeIsNoNumber) {
  const Study study = test_study();
  std::vector<Participant> people = {new_participant(0), new_participant(1)};
  for (Participant& person : people) {
    Random random(5, person.number, 0);
    const double threshold = person.number == 0 ? -0.8 : -2.0;  // the range ends at -1
    add_detection(person, study, kThreshold, 60, levels_near(study.tasks[kThreshold], threshold, 0.6),
                  threshold, 2.5, random);
  }
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  EXPECT_FALSE(is_number(found.people[0].tasks[kThreshold].arms[0].fit));
  EXPECT_THAT(found.people[0].flags, testing::Contains("threshold: range of stimuli too small"));
  ASSERT_TRUE(is_number(found.people[1].tasks[kThreshold].arms[0].fit));
  // 75 % lies at t + log10(ln 2)/b = -2 - 0.0637.
  EXPECT_NEAR(found.people[1].tasks[kThreshold].arms[0].fit->estimate.mean, -2.064, 0.15);
  EXPECT_FALSE(found.people[0].reached);
  ASSERT_TRUE(found.people[1].reached);
  EXPECT_NEAR(found.people[1].reached->mean, 0.0, 1e-12);  // no repetition: the same trials
}

TEST(Analysis, ShareReachedComparesTheFirstThresholdWithAllTrials) {
  const Study study = test_study();
  std::vector<Participant> people = {new_participant(0)};
  Random random(6, 0, 0);
  for (const double threshold : {-2.2, -1.9}) {
    add_detection(people[0], study, kThreshold, 80, levels_near(study.tasks[kThreshold], threshold, 0.4),
                  threshold, 3.0, random);
  }
  for (std::size_t i = 80; i < 160; ++i) people[0].log.trials[i].repeat = true;
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  const ArmResult& arm = found.people[0].tasks[kThreshold].arms[0];
  EXPECT_EQ(arm.fit->trials, 80);
  EXPECT_EQ(arm.repeated->trials, 80);
  EXPECT_NEAR(arm.repeated->estimate.mean - arm.fit->estimate.mean, 0.3, 0.12);
  // The noise was set by a threshold that was too low, so less than the share was reached.
  EXPECT_LT(found.people[0].reached->mean, -0.05);
  EXPECT_LT(found.people[0].reached->low, found.people[0].reached->mean);
  EXPECT_GT(found.people[0].reached->high, found.people[0].reached->mean);
  EXPECT_THAT(found.people[0].flags,
              testing::Contains(testing::HasSubstr("threshold changed by a factor of")));
}

TEST(Analysis, EachSessionHasItsOwnThresholdAndOneAtTheEdgeExcludesByRule) {
  Study study = test_study();
  study.tasks[kThreshold].each_session = true;
  std::vector<Participant> people = {new_participant(0)};
  Random random(6, 0, 0);
  for (const double threshold : {-2.2, -0.8}) {  // the range ends at -1
    add_detection(people[0], study, kThreshold, 60,
                  levels_near(study.tasks[kThreshold], std::min(threshold, -1.3), 0.5), threshold, 3.0,
                  random);
  }
  for (std::size_t i = 60; i < 120; ++i) {
    people[0].log.trials[i].repeat = true;
    people[0].log.trials[i].session = 2;
  }
  people[0].log.events.push_back(
      {"", "practice", {{"task", "stiffness"}, {"correct", "5"}, {"of", "10"}, {"met", "no"}}, 0});
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  const std::vector<SessionThreshold>& thresholds = found.people[0].tasks[kThreshold].thresholds;
  ASSERT_EQ(thresholds.size(), 2U);
  EXPECT_EQ(thresholds[0].session, 1);
  EXPECT_EQ(thresholds[1].session, 2);
  EXPECT_NEAR(thresholds[0].fit.estimate.mean, -2.2 - 0.053, 0.15);  // 75 % lies at t + log10(ln 2)/3
  EXPECT_TRUE(thresholds[1].fit.range_too_small);
  EXPECT_FALSE(found.people[0].tasks[kThreshold].arms[0].repeated);  // no run at the end
  EXPECT_NEAR(found.people[0].reached->mean, 0.0, 1e-12);            // of the first session's trials alone
  const char* const edge =
      "threshold: at the edge of the stimuli in session 2, so its noise is no share of it";
  EXPECT_THAT(found.people[0].flags, testing::Contains(edge));
  EXPECT_THAT(
      found.people[0].flags,
      testing::Contains("stiffness: practice ended with 5 of the last 10 correct, its criterion not met"));
  EXPECT_TRUE(found.people[0].kept());
  study.exclude_threshold_at_edge = true;
  EXPECT_THAT(analyse(study, people, kTestKey, true).people[0].exclusions, testing::Contains(edge));
}

TEST(Analysis, CatchTrialsOfACurveDoNotCountInItsSensitivity) {
  const Study study = test_study();
  std::vector<Participant> people = {new_participant(0)};
  Random random(8, 0, 0);
  add_trials(
      people[0], study, kCurve, 20, {-1.5}, [](std::size_t, double, double) { return 0.7; }, random);
  const double before =
      analyse(study, people, kTestKey, true).people[0].tasks[kCurve].arms[0].sensitivity->d_prime;
  for (int i = 0; i < 12; ++i) {  // easy ones of the first arm, all correct
    TrialRecord trial = people[0].log.trials[0];
    trial.catch_trial = true;
    trial.level = -1.0;
    trial.counted = true;
    trial.answer = trial.second ? 2 : 1;
    people[0].log.trials.push_back(trial);
  }
  const PersonResult after = analyse(study, people, kTestKey, true).people[0];
  EXPECT_EQ(after.tasks[kCurve].arms[0].sensitivity->d_prime, before);
  EXPECT_EQ(after.tasks[kCurve].arms[0].trials, 20);
  EXPECT_EQ(after.catch_trials.trials, 12);
  EXPECT_EQ(after.catch_trials.counted, 12);
}

TEST(Analysis, ForceControlComparesMeansOfLogarithms) {
  const Study study = test_study();
  // ln rms with "constant" less that without noise: -0.1, -0.2, -0.3. t(2, 0.975) = 4.302653, s = 0.1.
  std::vector<Participant> people;
  for (std::uint32_t number = 0; number < 3; ++number) {
    people.push_back(new_participant(number));
    for (std::size_t arm = 0; arm < 3; ++arm) {
      for (const double factor : {0.5, 2.0}) {
        TrialRecord trial;
        trial.task = "hold";
        trial.code = code_of(number, kHold, arm, 3);
        trial.level = 1.0;
        trial.rms_error = 0.2 * factor * (arm == 1 ? std::exp(-0.1 * (number + 1)) : 1.0);
        trial.variation = 0.1;
        people.back().log.trials.push_back(trial);
      }
    }
  }
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  const auto rms = std::find_if(found.contrasts.begin(), found.contrasts.end(), [](const Contrast& one) {
    return one.task == kHold && one.condition == 1 && one.measure == "ln_rms";
  });
  ASSERT_NE(rms, found.contrasts.end());
  EXPECT_NEAR(rms->kept->effect, -0.2, 1e-12);
  EXPECT_NEAR(rms->kept->high, -0.2 + 4.302653 * 0.1 / std::sqrt(3.0), 1e-6);
}

// test_study() with an inclusion task behind the others, whose ratios are 1.1 to 8.
Study study_with_lump() {
  Study study = test_study();
  StudyTask lump;
  lump.name = "lump";
  lump.kind = TaskKind::kInclusion;
  lump.arms = test_conditions();
  lump.least = 1.1;
  lump.largest = 8.0;
  lump.steps = 15;
  study.tasks.push_back(lump);
  return study;
}

constexpr std::size_t kLump = 4;

// Thresholds without noise of ln ratio 0.5 to 1.7; with noise 1.35 times as large, which is beyond ln 8
// = 2.08 for those above 1.54.
std::vector<Participant> lump_group(const Study& study, std::uint32_t people) {
  std::vector<Participant> group;
  const auto function = grid_of(study.tasks[kLump]).function;
  for (std::uint32_t number = 0; number < people; ++number) {
    Random random(9, number, 0);
    group.push_back(new_participant(number));
    const double threshold = std::log10(0.5 + 1.2 * number / people);
    add_trials(
        group.back(), study, kLump, 105, grid_of(study.tasks[kLump]).levels,
        [&](std::size_t arm, double level, double) {
          const double rise = arm == 0 ? 0.0 : std::log10(1.35);
          return function(level, {threshold + rise - psychophysics::threshold_of({0.0, 2.5, 0.0}), 2.5, 0.0});
        },
        random);
  }
  return group;
}

const Contrast& contrast_in(const StudyAnalysis& analysis, std::size_t task, std::size_t condition) {
  return *std::find_if(analysis.contrasts.begin(), analysis.contrasts.end(),
                       [&](const Contrast& one) { return one.task == task && one.condition == condition; });
}

TEST(Analysis, NobodyIsLeftOutBecauseTheThresholdLeavesTheRange) {
  const Study study = study_with_lump();
  const StudyAnalysis found = analyse(study, lump_group(study, 16), kTestKey, true);
  const Effect& effect = *contrast_in(found, kLump, 1).kept;
  EXPECT_EQ(effect.people, 16);
  EXPECT_EQ(effect.missing.people, 0);
  EXPECT_GE(effect.missing.outside_condition, 4);
  EXPECT_LT(effect.missing.outside_reference, effect.missing.outside_condition);
  EXPECT_NEAR(effect.effect, std::log(1.35), 0.15);
  // The mean of those whose two thresholds are numbers, as it was compared before, hides a part of the harm.
  double complete = 0.0;
  int numbers = 0;
  for (const PersonResult& person : found.people) {
    const std::vector<ArmResult>& arms = person.tasks[kLump].arms;
    if (!is_number(arms[0].fit) || !is_number(arms[1].fit)) continue;
    complete += arms[1].fit->estimate.mean - arms[0].fit->estimate.mean;
    ++numbers;
  }
  EXPECT_LT(numbers, 16);
  EXPECT_LT(std::log(10.0) * complete / numbers, effect.effect);
}

TEST(Analysis, TooFewTrialsLeaveAPersonOutWithAWorstCase) {
  const Study study = test_study();
  std::vector<Participant> people = stiffness_group(study, 4, 20, 1.0);
  std::erase_if(people[2].log.trials, [&](const TrialRecord& trial) {
    return trial.code == code_of(2, kStiffness, 1, 3) && trial.number > 20;
  });
  const StudyAnalysis open = analyse(study, people, kTestKey, true);
  const Effect& effect = *open.contrasts.front().kept;
  EXPECT_EQ(effect.people, 3);
  EXPECT_EQ(effect.missing.people, 1);
  EXPECT_EQ(effect.missing.in_condition, 1);
  EXPECT_EQ(effect.missing.in_reference, 0);
  // Three people with the estimate and one with a factor of 4.5 (52 steps of 0.0288) on either side.
  EXPECT_NEAR(effect.missing.low, (3.0 * effect.effect - 52 * 0.0288) / 4.0, 1e-12);
  EXPECT_NEAR(effect.missing.high, (3.0 * effect.effect + 52 * 0.0288) / 4.0, 1e-12);
  EXPECT_THAT(open.people[2].left_out, testing::Contains("stiffness: constant, fewer than 10 trials"));
  EXPECT_THAT(open.people[0].left_out, testing::Not(testing::Contains(testing::HasSubstr("stiffness"))));
  const StudyAnalysis blind = analyse(study, people, kTestKey, false);
  EXPECT_THAT(blind.people[2].left_out,
              testing::Contains("stiffness: some conditions, fewer than 10 trials"));
}

// People with a share of correct answers at each share of the noise.
StudyAnalysis curve_group(const Study& study, const std::vector<double>& correct, std::uint32_t group) {
  std::vector<Participant> people;
  for (std::uint32_t number = 0; number < 16; ++number) {
    Random random(7, number, group);
    people.push_back(new_participant(number));
    add_trials(
        people.back(), study, kCurve, 40, {-1.5},
        [&](std::size_t arm, double, double) { return correct[arm]; }, random);
  }
  return analyse(study, people, kTestKey, true);
}

TEST(Analysis, InvertedUIsFoundForStochasticResonanceAndNotForALinearObserver) {
  const Study study = test_study();
  psychophysics::Observer linear = psychophysics::make_observer("linear");
  std::vector<double> harmed;
  for (const Arm& arm : study.tasks[kCurve].arms) {
    harmed.push_back(psychophysics::probability_second(linear, {0.1907, 0.5818 * arm.share, true}));
  }
  EXPECT_NEAR(harmed.front(), 0.65, 0.001);
  int claimed = 0;
  for (std::uint32_t group = 0; group < 20; ++group) {
    claimed += curve_group(study, harmed, group).curves.front().found ? 1 : 0;
  }
  EXPECT_LE(claimed, 2);
  const StudyAnalysis found =
      curve_group(study, {.65, .69556716, .7577147, .76822891, .72827633, .66273063}, 1);
  ASSERT_EQ(found.curves.size(), 1U);
  EXPECT_TRUE(found.curves[0].found);
  EXPECT_EQ(found.curves[0].d_primes.size(), 16U);
  // d' of 65 % in two intervals: sqrt 2 z(0.65).
  EXPECT_NEAR(found.curves[0].levels[0].mean, 0.5449, 0.2);
}

TEST(Analysis, CurveIsShownBlindWithoutTheTestOfItsShape) {
  const Study study = test_study();
  std::vector<Participant> people;
  for (std::uint32_t number = 0; number < 3; ++number) {
    Random random(8, number, 0);
    people.push_back(new_participant(number));
    add_trials(
        people.back(), study, kCurve, 20, {-1.5}, [](std::size_t, double, double) { return 0.7; }, random);
  }
  const StudyAnalysis blind = analyse(study, people, kTestKey, false);
  ASSERT_EQ(blind.curves.size(), 1U);
  EXPECT_FALSE(blind.curves[0].inverted_u);
  EXPECT_FALSE(blind.curves[0].found);
}

// Two people, four levels. In the even trials of a level the person is right in all, in the odd ones in half
// of the intervals, or the other way round; the level with all right differs by person.
TEST(Analysis, TheOwnLevelIsChosenInOneHalfAndJudgedInTheOther) {
  Study study = test_study();
  study.own_level = "curve";
  std::vector<Participant> people;
  for (std::uint32_t number = 0; number < 2; ++number) {
    people.push_back(new_participant(number));
    for (std::size_t arm = 0; arm < 6; ++arm) {
      for (int i = 0; i < 40; ++i) {
        TrialRecord trial;
        trial.task = "curve";
        trial.number = static_cast<int>(arm) * 40 + i;
        trial.code = code_of(number, kCurve, arm, 6);
        trial.level = -1.5;
        trial.second = i / 2 % 2 == 1;
        // Right: in arm 2 + number 18 of 20 of each half, else in 12 of 20.
        trial.counted = i / 2 % 10 < (arm == 2 + number ? 9 : 6);
        trial.answer = trial.counted == trial.second ? 2 : 1;
        people.back().log.trials.push_back(trial);
      }
    }
  }
  EXPECT_FALSE(analyse(study, people, kTestKey, false).own_level);
  const StudyAnalysis found = analyse(study, people, kTestKey, true);
  ASSERT_TRUE(found.own_level);
  EXPECT_EQ(found.own_level->people, 2);
  // 18 of 20: by order 9 or 8 of 10 in each interval; d' log-linear, the same in both halves and people.
  const ArmResult& chosen = found.people[0].tasks[kCurve].arms[2];
  const ArmResult& off = found.people[0].tasks[kCurve].arms[0];
  EXPECT_NEAR(found.own_level->effect, chosen.sensitivity->d_prime - off.sensitivity->d_prime, 0.35);
  EXPECT_GT(found.own_level->effect, 0.5);
}

// Nobody has an effect: the level that was largest by chance in one half is not larger in the other.
TEST(Analysis, TheOwnLevelOfPeopleWithoutAnEffectShowsNone) {
  Study study = test_study();
  study.own_level = "curve";
  double sum = 0.0;
  for (std::uint32_t group = 0; group < 10; ++group) {
    sum += curve_group(study, std::vector<double>(6, 0.65), group).own_level->effect / 10.0;
  }
  // 10 groups of 16 people; sd of a difference of d' of 20 trials is about 0.6: standard error 0.05.
  EXPECT_NEAR(sum, 0.0, 0.15);
}

EventRecord guess(const char* code, const char* answer, const char* confidence) {
  return {"",
          "blinding",
          {{"who", "participant"},
           {"task", "stiffness"},
           {"code", code},
           {"answer", answer},
           {"confidence", confidence}}};
}

TEST(Analysis, GuessesAreCountedByNoiseAfterUnblindingAlone) {
  const Study study = test_study();
  std::vector<Participant> people = stiffness_group(study, 1, 10, 1.0);
  const std::string noise = code_of(0, kStiffness, 1, 3);
  const std::string off = code_of(0, kStiffness, 0, 3);
  for (const char* answer : {"yes", "yes", "yes", "no", "unsure"}) {
    people[0].log.events.push_back(guess(noise.c_str(), answer, "3"));
  }
  for (const char* answer : {"yes", "no"}) people[0].log.events.push_back(guess(off.c_str(), answer, "5"));
  const std::vector<Guesses> blind = analyse(study, people, kTestKey, false).guesses;
  ASSERT_EQ(blind.size(), 1U);  // pooled
  EXPECT_EQ(blind[0].yes, 4);
  EXPECT_EQ(blind[0].no, 2);
  EXPECT_EQ(blind[0].unsure, 1);
  const std::vector<Guesses> open = analyse(study, people, kTestKey, true).guesses;
  ASSERT_EQ(open.size(), 2U);
  EXPECT_FALSE(open[0].noise);
  EXPECT_EQ(open[0].yes, 1);
  EXPECT_TRUE(open[1].noise);
  EXPECT_EQ(open[1].yes, 3);
  EXPECT_EQ(open[1].no, 1);
  EXPECT_EQ(open[1].unsure, 1);
  EXPECT_NEAR(open[1].confidence, 3.0, 1e-12);
}

TEST(Analysis, UnknownTaskOrCodeIsRejected) {
  const Study study = test_study();
  std::vector<Participant> people = stiffness_group(study, 1, 5, 1.0);
  people[0].log.trials[0].code = "c4";
  EXPECT_THROW((void)analyse(study, people, kTestKey, false), InputError);
  people[0].log.trials[0].task = "squeeze";
  EXPECT_THROW((void)analyse(study, people, kTestKey, false), InputError);
}

}  // namespace
}  // namespace palpate::study
