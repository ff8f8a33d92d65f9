// People whose answers have a known fault are flagged, others are not.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/session/analysis.h"
#include "study/session/test/simulated_log.h"

namespace palpate::study {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double kSpread = 0.2;

// A person who compares stiffness as the psychometric function says.
Participant fair_person(const Study& study, std::uint32_t number) {
  Participant person = new_participant(number);
  Random random(11, number, 0);
  add_stiffness(person, study, 100, {kSpread, kSpread, kSpread}, random, 0.02);
  return person;
}

// Changes the answer of a comparison.
void answer(TrialRecord& trial, int interval) {
  trial.answer = interval;
  trial.counted = trial.second == (interval == 2);
}

PersonResult result_of(const Participant& person) {
  return analyse(test_study(), std::vector<Participant>{person}, kTestKey, false).people.front();
}

TEST(PersonFlags, FairPeopleAreRarelyFlagged) {
  const Study study = test_study();
  int flagged = 0;
  for (std::uint32_t number = 0; number < 40; ++number) {
    flagged += result_of(fair_person(study, number)).flags.empty() ? 0 : 1;
  }
  EXPECT_LE(flagged, 6);
}

TEST(PersonFlags, TheSameAnswerAlwaysIsFlagged) {
  Participant person = fair_person(test_study(), 1);
  for (TrialRecord& trial : person.log.trials) answer(trial, 1);
  EXPECT_THAT(result_of(person).flags, Contains("answers \"first\" in 100 % of the trials"));
}

TEST(PersonFlags, RepeatedAnswersAreFlagged) {
  Participant person = fair_person(test_study(), 2);
  for (std::size_t i = 0; i < person.log.trials.size(); ++i) {
    answer(person.log.trials[i], 1 + static_cast<int>(i / 8 % 2));
  }
  const std::vector<std::string> flags = result_of(person).flags;
  EXPECT_THAT(flags, Contains(HasSubstr("repeats the last answer in")));
  EXPECT_THAT(flags, Contains(HasSubstr("not better than chance")));
}

TEST(PersonFlags, RandomAnswersAreFlagged) {
  Participant person = fair_person(test_study(), 3);
  Random random(12, 0, 0);
  for (TrialRecord& trial : person.log.trials) answer(trial, random.uniform() < 0.5 ? 1 : 2);
  const std::vector<std::string> flags = result_of(person).flags;
  EXPECT_THAT(flags, Contains(HasSubstr("not better than chance")));
  EXPECT_THAT(flags, Contains("stiffness: range of stimuli too small"));
  EXPECT_THAT(flags, Not(Contains(HasSubstr("repeats the last answer"))));
}

TEST(PersonFlags, LapsesAreFlagged) {
  const Study study = test_study();
  Participant person = new_participant(4);
  Random random(13, 0, 0);
  add_stiffness(person, study, 200, {0.1, 0.1, 0.1}, random, 0.25);
  EXPECT_THAT(result_of(person).flags, Contains("lapses often"));
}

// Peak forces that follow the stiffness, with a random part of 10 %.
void add_forces(Participant& person, bool answered_by_force) {
  Random random(14, person.number, 1);
  for (TrialRecord& trial : person.log.trials) {
    for (int i = 0; i < 2; ++i) {
      const bool comparison = trial.second == (i == 1);
      IntervalCues& cues = trial.intervals[static_cast<std::size_t>(i)];
      cues.peak_force = 2.0 * std::exp(comparison ? trial.level : 0.0) * (1.0 + 0.1 * random.normal());
      cues.depth = 8e-3;
    }
    if (!answered_by_force) continue;
    answer(trial, trial.intervals[1].peak_force > trial.intervals[0].peak_force ? 2 : 1);
  }
}

TEST(PersonFlags, AnswersByPeakForceAreFlagged) {
  Participant fair = fair_person(test_study(), 5);
  add_forces(fair, false);
  Participant by_force = fair;
  add_forces(by_force, true);
  const PersonResult flagged = result_of(by_force);
  EXPECT_THAT(flagged.flags, Contains(HasSubstr("stiffness: answers by peak force (r = ")));
  const std::vector<CueWeight>& cues = flagged.tasks[2].cues;
  ASSERT_EQ(cues.size(), 1U);  // depth and work are constant
  EXPECT_GT(cues[0].low, 0.2);
  const PersonResult not_flagged = result_of(fair);
  EXPECT_THAT(not_flagged.flags, Not(Contains(HasSubstr("answers by"))));
  EXPECT_LT(std::abs(not_flagged.tasks[2].cues[0].correlation), 0.2);
}

// A person whose standard deviation changes over the session by a factor.
Participant changing_person(double factor) {
  const Study study = test_study();
  Participant person = new_participant(6);
  Random random(15, 0, 0);
  const auto function = grid_of(study.tasks[2]).function;
  add_trials(
      person, study, 2, 200, levels_near(study.tasks[2], 0.0, 0.6),
      [&](std::size_t, double level, double progress) {
        return function(level, {0.0, 0.15 * std::pow(factor, progress), 0.0});
      },
      random);
  return person;
}

TEST(PersonFlags, CuesShowInTheGroup) {
  std::vector<Participant> people;
  for (std::uint32_t number = 0; number < 4; ++number) {
    people.push_back(fair_person(test_study(), number));
    add_forces(people.back(), true);
  }
  const StudyAnalysis found = analyse(test_study(), people, kTestKey, false);
  const auto cue = std::find_if(found.changes.begin(), found.changes.end(), [](const GroupChange& change) {
    return change.quantity == "correlation of the answer with peak force at the same stiffness";
  });
  ASSERT_NE(cue, found.changes.end());
  EXPECT_GT(cue->test.low, 0.0);
}

TEST(PersonFlags, LearningAndFatigueAreFlagged) {
  EXPECT_THAT(result_of(changing_person(8.0)).flags, Contains(HasSubstr("stiffness: tires")));
  EXPECT_THAT(result_of(changing_person(0.125)).flags, Contains(HasSubstr("stiffness: learns")));
  EXPECT_LT(result_of(changing_person(8.0)).tasks[2].trend->change, 0.0);
}

TEST(PersonFlags, PeopleWhoHearTheNoiseAreFlagged) {
  Participant person = fair_person(test_study(), 7);
  person.log.events.push_back({"", "audible", {{"trials", "20"}, {"correct", "14"}}});
  EXPECT_FALSE(result_of(person).heard);
  person.log.events.back().values[1].second = "15";
  const PersonResult heard = result_of(person);
  EXPECT_TRUE(heard.heard);
  EXPECT_THAT(heard.flags, Contains("hears the noise: 15 of 20 correct with the hand off the device"));
}

TEST(PersonFlags, TimeAndFaultsAreSummedOverSessions) {
  Participant person = fair_person(test_study(), 8);
  person.log.trials.resize(4);
  const char* times[] = {"2026-03-01T09:00:00.000Z", "2026-03-01T09:10:30.000Z", "2026-03-02T23:59:00.000Z",
                         "2026-03-03T00:01:00.000Z"};
  for (std::size_t i = 0; i < 4; ++i) {
    person.log.trials[i].time = times[i];
    person.log.trials[i].session = i < 2 ? 1 : 2;
  }
  for (const char* late : {"2", "3"}) {
    person.log.events.push_back({"", "block", {{"late_ticks", late}, {"faults", "1"}}});
  }
  const PersonResult result = result_of(person);
  EXPECT_NEAR(result.minutes, 12.5, 1e-9);
  EXPECT_EQ(result.late_ticks, 5);
  EXPECT_EQ(result.faults, 2);
}

}  // namespace
}  // namespace palpate::study
