#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/session/study.h"
#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;

Study example() { return load_study(PALPATE_EXAMPLES "/study/touch-noise.toml"); }

double seconds_of(const Study& study, const std::string& task) {
  return trial_seconds(study, study.tasks.at(study.find_task(task).value()));
}

// Detection: 0.5 + 0.8 homing, 2 x 0.8 + 0.5 + 0.1, 1.2 answer, 0.3. Stiffness: two presses of 2.5 s and
// returns of 1.1 s. Inclusion: two searches of 0.8 x 15 s.
TEST(TrialSeconds, AreThoseOfEachKindOfTask) {
  const Study study = example();
  EXPECT_THAT(seconds_of(study, "curve"), DoubleNear(5.0, 1e-9));
  EXPECT_THAT(seconds_of(study, "threshold"), DoubleNear(5.0, 1e-9));
  EXPECT_THAT(seconds_of(study, "stiffness"), DoubleNear(10.6, 1e-9));
  EXPECT_THAT(seconds_of(study, "lump"), DoubleNear(29.6, 1e-9));
  EXPECT_THAT(seconds_of(study, "hold"), DoubleNear(10.7, 1e-9));
}

TEST(Plan, OfTheExampleFitsIntoFourSessionsOfAnHour) {
  const Study study = example();
  const std::vector<PlannedSession> sessions = plan_sessions(study);
  ASSERT_EQ(sessions.size(), 4U);
  for (const PlannedSession& session : sessions) EXPECT_LE(session.minutes, 60.0);
}

TEST(Plan, OfTheShortExampleIsOneSessionOf45Minutes) {
  const Study study = load_study(PALPATE_EXAMPLES "/study/one-session.toml");
  const std::vector<PlannedSession> sessions = plan_sessions(study);
  ASSERT_EQ(sessions.size(), 1U);
  ASSERT_EQ(sessions[0].parts.size(), 2U);
  const StudyTask& stiffness = study.tasks[1];
  const int more = stiffness.practice_until->most - stiffness.practice_until->of;
  EXPECT_LE(sessions[0].minutes + more * trial_seconds(study, stiffness) / 60.0, 45.0);
  EXPECT_EQ(study.primary->task, stiffness.name);
}

// Every task of the shipped studies with two intervals has practice and catch trials.
TEST(Plan, OfTheExamplesHasPracticeAndCatchTrials) {
  for (const char* name : {"/study/one-session.toml", "/study/touch-noise.toml"}) {
    for (const StudyTask& task : load_study(std::string(PALPATE_EXAMPLES) + name).tasks) {
      if (!task.two_intervals()) continue;
      EXPECT_TRUE(task.practice > 0 || task.practice_until) << task.name;
      EXPECT_GT(task.catch_share, 0.0) << task.name;
    }
  }
}

TEST(Plan, IsRefusedWithTooFewSessionsNamingTheirNumber) {
  Study study = example();
  study.sessions = 2;
  EXPECT_EQ(error_of([&] { static_cast<void>(plan_sessions(study)); }),
            study.file.string() +
                ": study.sessions = 2: the tasks need 4 sessions of at most 60 min, or longer ones");
}

TEST(Plan, IsRefusedIfASessionIsTooShortForARound) {
  Study study = example();
  study.max_minutes = 5.0;
  EXPECT_EQ(error_of([&] { static_cast<void>(plan_sessions(study)); }),
            study.file.string() +
                ": study.max_minutes = 5: is too short for task threshold: must hold its practice, 1 trial "
                "of 5 s and its repetition");
}

TEST(Plan, HasEachTrialOnceInWholeRoundsAndInOrder) {
  for (const double minutes : {18.0, 20.0, 33.0, 60.0, 240.0}) {
    Study study = example();
    study.sessions = 50;
    study.max_minutes = minutes;
    study.latin_order = false;
    study.tasks[0].each_session = false;
    std::vector<int> next(study.tasks.size(), 0);
    std::size_t last_task = 0;
    for (const PlannedSession& session : plan_sessions(study)) {
      EXPECT_LE(session.minutes, minutes);
      for (const PlannedPart& part : session.parts) {
        if (part.run != kFirstRun) continue;
        EXPECT_GE(part.task, last_task);
        last_task = part.task;
        EXPECT_EQ(part.first_trial, next[part.task]);
        next[part.task] += part.trials;
        const StudyTask& task = study.tasks[part.task];
        const std::size_t round =
            task.kind == TaskKind::kForceControl ? task.targets.size() : task.arms.size();
        EXPECT_EQ(static_cast<std::size_t>(next[part.task]) % round, 0U);
      }
    }
    for (std::size_t i = 0; i < next.size(); ++i) {
      EXPECT_EQ(next[i], study.tasks[i].trials * static_cast<int>(study.tasks[i].arms.size()));
    }
  }
}

TEST(Plan, RepeatsATaskAtTheEndOfItsSession) {
  const std::vector<PlannedSession> sessions = plan_sessions(example());
  const PlannedPart& last = sessions[0].parts.back();
  EXPECT_EQ(last.run, kRunAtEnd);
  EXPECT_EQ(last.task, 0U);
  EXPECT_EQ(last.trials, 40);
  EXPECT_EQ(sessions[0].parts.front().task, 0U);
}

// One task of 10 trials of 5 s, 3 of practice: 90 s set-up + 13 x 5 s + 2 breaks of 30 s after 5 and 10.
TEST(Plan, CountsSetUpPracticeAndBreaks) {
  Study study = example();
  study.tasks = {study.tasks[0]};
  study.tasks[0].trials = 10;
  study.tasks[0].practice = 3;
  study.tasks[0].repeat_at_end = false;
  study.check_audible = false;
  study.break_trials = 5;
  EXPECT_THAT(plan_sessions(study)[0].minutes, DoubleNear((90.0 + 65.0 + 60.0) / 60.0, 1e-9));
  study.check_audible = true;  // 20 trials of 4 s
  EXPECT_THAT(plan_sessions(study)[0].minutes, DoubleNear((90.0 + 65.0 + 60.0 + 80.0) / 60.0, 1e-9));
  study.break_minutes = 0.25;  // a break after 3 trials: 4 in all
  EXPECT_THAT(plan_sessions(study)[0].minutes, DoubleNear((90.0 + 65.0 + 120.0 + 80.0) / 60.0, 1e-9));
}

}  // namespace
}  // namespace palpate::study
