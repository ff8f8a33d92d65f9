#include "study/session/power.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

#include "study/psychophysics/test/study_table.h"
#include "study/session/analysis.h"
#include "study/session/simulate.h"
#include "study/session/test/simulated_log.h"

namespace palpate::study {
namespace {

// The test's study with calibration, few trials and no force control.
Study power_study(int trials) {
  Study study = test_study();
  study.seed = 5;
  study.max_minutes = 1e6;
  StudyTask weak = study.tasks[0];
  weak.name = "weak-force";
  weak.kind = TaskKind::kForceDetection;
  weak.sets_threshold = false;
  weak.least = 5e-3;
  weak.largest = 0.5;
  study.tasks = {study.tasks[0], weak, study.tasks[1], study.tasks[2]};
  for (StudyTask& task : study.tasks) task.trials = trials;
  study.primary->alternative = "two-sided";
  return study;
}

TEST(Power, GrowsWithTheNumberOfPeopleAndTheEffect) {
  const Study study = power_study(60);
  const Power strong = simulate_power(study, {0.7, {}, {4, 16}, 5}, nullptr, {});
  ASSERT_EQ(strong.rows.size(), 2U);
  EXPECT_EQ(strong.rows[0].effect, "jnd=0.7");
  EXPECT_EQ(strong.rows[0].analysis, "JND in stiffness, constant - off, two-sided test at 5 %");
  EXPECT_LE(strong.rows[0].power, strong.rows[1].power);
  EXPECT_GE(strong.rows[1].power, 0.6);
  EXPECT_GT(strong.rows[0].width, strong.rows[1].width);
  EXPECT_NEAR(strong.rows[1].mean_effect, std::log(0.7), 0.08);
  EXPECT_NEAR(strong.rows[0].error, std::sqrt(strong.rows[0].power * (1.0 - strong.rows[0].power) / 5.0),
              1e-12);
  const Power none = simulate_power(study, {1.0, {}, {8}, 5}, nullptr, {});
  EXPECT_LE(none.rows[0].power, 0.4);
}

TEST(Power, OneSidedAlternativeFindsEffectsOfItsSignOnly) {
  Study study = power_study(60);
  study.primary->alternative = "greater";
  EXPECT_EQ(simulate_power(study, {0.7, {}, {8}, 4}, nullptr, {}).rows[0].power, 0.0);
}

TEST(Power, InvertedUIsSimulatedWithItsCalibration) {
  const Study study = power_study(40);
  std::vector<double> shares;
  const Power power =
      simulate_power(study, {{}, 0.35, {10}, 2}, nullptr, [&](double share) { shares.push_back(share); });
  ASSERT_EQ(power.rows.size(), 1U);
  EXPECT_EQ(power.rows[0].analysis, "inverted U in curve, two one-sided tests at 5 %");
  EXPECT_GE(power.rows[0].power, 0.5);
  EXPECT_GT(power.rows[0].mean_effect, 0.2);  // of d', from 0.54 to 1.0
  EXPECT_LT(power.rows[0].mean_effect, 0.7);
  EXPECT_THAT(shares, testing::ElementsAre(0.5, 1.0));
}

TEST(Power, WithoutEffectBothAnalysesAreSimulated) {
  const Power power = simulate_power(power_study(10), {{}, {}, {2, 3}, 2}, nullptr, {});
  ASSERT_EQ(power.rows.size(), 4U);
  EXPECT_EQ(power.rows[0].effect, "jnd=0.85");
  EXPECT_EQ(power.rows[2].effect, "sr=0.4");
  EXPECT_GT(power.hours_per_person, 0.0);
}

TEST(Power, TextStatesAssumptions) {
  const Study study = power_study(10);
  const Power power{200, {{"jnd=0.85", "JND in stiffness", 24, 0.84, 0.026, std::log(0.85), 0.25}}, 2.5};
  const std::string text = power_text(study, power);
  EXPECT_THAT(text, testing::HasSubstr("24   0.84 +- 0.03    x 0.850           x/: 1.13           60"));
  EXPECT_THAT(text, testing::HasSubstr("No pooled effect size"));
}

TEST(Power, ValuesOutOfRangeAreRejected) {
  Study study = power_study(10);
  const auto power = [&](const PowerRequest& request) { return simulate_power(study, request, nullptr, {}); };
  EXPECT_THROW((void)power({0.1, {}, {8}, 4}), InputError);
  EXPECT_THROW((void)power({{}, 5.0, {8}, 4}), InputError);
  EXPECT_THROW((void)power({0.8, {}, {1}, 4}), InputError);
  EXPECT_THROW((void)power({0.8, {}, {}, 4}), InputError);
  EXPECT_THROW((void)power({0.8, {}, {8}, 1}), InputError);
  study.primary->measure = "d_prime";
  EXPECT_THROW((void)power({0.8, {}, {8}, 4}), InputError);
  study.inverted_u.reset();
  EXPECT_THROW((void)power({{}, 0.4, {8}, 4}), InputError);
  EXPECT_THROW((void)power({{}, {}, {8}, 4}), InputError);
}

// The whole chain: thresholds, weak force and curve by QUEST+, then the analysis of the study.
TEST(Power, NoInvertedUIsClaimedForALinearObserverByTheWholeChain) {
  Study study = power_study(40);
  study.tasks.pop_back();
  study.primary.reset();
  int claimed = 0;
  for (std::uint64_t group = 0; group < static_cast<std::uint64_t>(psychophysics::simulated(3, 200));
       ++group) {
    study.seed = 100 + group;
    std::vector<Participant> people;
    for (std::uint32_t number = 0; number < 8; ++number) {
      SimulatedPerson person = make_person("linear", study.seed, number);
      people.push_back({number, simulate_trials(study, kTestKey, number, person)});
    }
    claimed += analyse(study, people, kTestKey, true).curves.at(0).found ? 1 : 0;
  }
  psychophysics::print_figure("linear, whole chain: inverted U", claimed / 200.0);
  EXPECT_LE(claimed, psychophysics::simulated(0, 10));
}

}  // namespace
}  // namespace palpate::study
