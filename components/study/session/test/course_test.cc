#include "study/session/course.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/error.h"

#include "study/session/simulated_person.h"
#include "study/session/test/small_study.h"

namespace palpate::study {
namespace {

constexpr SealedKey kCourseKey = 123456789;

// An answered trial; some are spoiled.
TrialRecord answered(const Study& study, SimulatedPerson& person, const Trial& trial, double spoiled_share,
                     std::uint32_t count) {
  TrialRecord record = record_of(study, trial, 1, 1);
  answer_by_formula(study, person, trial, 0.0, 5, 0, record);
  if (Random(99, 0, count).uniform() < spoiled_share) record.spoiled = {"the force left the band"};
  return record;
}

std::vector<TrialRecord> whole_session(const Study& study, Course& course, double spoiled_share = 0.0,
                                       std::size_t most = 100'000) {
  SimulatedPerson person = make_person("sr", 3, 0);
  std::vector<TrialRecord> trials;
  while (trials.size() < most) {
    const auto next = course.next();
    if (!next) break;
    trials.push_back(
        answered(study, person, *next, spoiled_share, static_cast<std::uint32_t>(trials.size())));
    course.add(trials.back());
  }
  return trials;
}

TEST(Course, GoesOnFromTheLogAsWithoutAnInterruption) {
  const Study study = small_study();
  Course uninterrupted(study, kCourseKey, 2);
  uninterrupted.begin_session(1);
  const std::vector<TrialRecord> all = whole_session(study, uninterrupted, 0.1);
  for (const std::size_t cut :
       {std::size_t{0}, std::size_t{1}, all.size() / 3, all.size() / 2, all.size() - 1}) {
    Course course(study, kCourseKey, 2);
    course.begin_session(1);
    for (std::size_t i = 0; i < cut; ++i) course.add(all[i]);
    for (std::size_t i = cut; i < all.size(); ++i) course.add(all[i]);  // throws if a trial differs
    EXPECT_FALSE(course.next().has_value());
  }
}

TEST(Course, AfterAnInterruptionPracticeComesFirstAndThenTheSameTrials) {
  const Study study = small_study();
  Course uninterrupted(study, kCourseKey, 2);
  uninterrupted.begin_session(1);
  const std::vector<TrialRecord> all = whole_session(study, uninterrupted);
  Course course(study, kCourseKey, 2);
  course.begin_session(1);
  for (std::size_t i = 0; i < 20; ++i) course.add(all[i]);
  course.resume();
  SimulatedPerson person = make_person("ideal", 3, 0);
  for (int i = 0; i < Course::kPracticeAgain; ++i) {
    const Trial trial = course.next().value();
    EXPECT_TRUE(trial.practice);
    course.add(answered(study, person, trial, 0.0, 0));
  }
  for (std::size_t i = 20; i < all.size(); ++i) {
    const Trial trial = course.next().value();
    EXPECT_EQ(trial.number, all[i].number);
    EXPECT_EQ(trial.level, all[i].level);
    EXPECT_EQ(trial.code, all[i].code);
    EXPECT_EQ(trial.second, all[i].second);
    if (all[i].practice) {
      course.add(answered(study, person, trial, 0.0, 0));
    } else {
      course.add(all[i]);
    }
  }
}

TEST(Course, SpoiledTrialsAreRepeatedLaterAndThriceAtMost) {
  const Study study = small_study();
  Course course(study, kCourseKey, 1);
  course.begin_session(1);
  const std::vector<TrialRecord> all = whole_session(study, course, 0.4);
  std::map<std::pair<std::string, int>, int> attempts;
  std::map<std::pair<std::string, int>, int> finished;
  int at_once = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const TrialRecord& trial = all[i];
    if (trial.practice) continue;
    const std::pair<std::string, int> which{trial.task + (trial.repeat ? "2" : "1"), trial.number};
    ++attempts[which];
    finished[which] += trial.spoiled.empty() ? 1 : 0;
    at_once += i + 1 < all.size() && !trial.spoiled.empty() && all[i + 1].task == trial.task &&
                       all[i + 1].repeat == trial.repeat && all[i + 1].number == trial.number
                   ? 1
                   : 0;
  }
  int lost = 0;
  for (const auto& [which, count] : attempts) {
    EXPECT_LE(count, Course::kMaxAttempts);
    EXPECT_LE(finished[which], 1);
    EXPECT_TRUE(finished[which] == 1 || count == Course::kMaxAttempts) << which.first << which.second;
    lost += finished[which] == 0 ? 1 : 0;
  }
  EXPECT_EQ(course.lost(), lost);
  EXPECT_GT(lost, 0);
  EXPECT_LE(at_once, 12);  // only the last trial of a part, with nothing to come before it
}

TEST(Course, EachArmComesOnceARoundAndCodesAreDrawnForEachParticipant) {
  const Study study = small_study();
  std::set<std::vector<std::size_t>> orders;
  for (std::uint32_t participant = 0; participant < 12; ++participant) {
    Course course(study, kCourseKey, participant);
    course.begin_session(1);
    SimulatedPerson person = make_person("ideal", 3, participant);
    std::vector<std::string> codes;
    std::vector<std::size_t> arms;
    for (std::uint32_t count = 0; const auto next = course.next(); ++count) {
      if (study.tasks[next->task].name == "stiffness" && !next->practice) {
        codes.push_back(next->code);
        arms.push_back(next->arm);
        EXPECT_EQ(arms_of_codes(kCourseKey, participant, next->task,
                                3)[static_cast<std::size_t>(next->code[1] - '1')],
                  next->arm);
      }
      course.add(answered(study, person, *next, 0.0, count));
    }
    ASSERT_EQ(codes.size(), 30U);
    for (std::size_t round = 0; round < 10; ++round) {
      EXPECT_EQ(std::set<std::string>(codes.begin() + static_cast<std::ptrdiff_t>(3 * round),
                                      codes.begin() + static_cast<std::ptrdiff_t>(3 * round + 3)),
                (std::set<std::string>{"c1", "c2", "c3"}));
    }
    orders.insert({arms.begin(), arms.begin() + 3});
  }
  EXPECT_GT(orders.size(), 2U);
}

TEST(Course, ForceControlHasOneArmAfterTheOtherInABalancedOrder) {
  const Study study = small_study();
  std::map<std::pair<std::size_t, std::size_t>, int> place_of_arm;
  for (std::uint32_t participant = 0; participant < 6; ++participant) {
    Course course(study, kCourseKey, participant);
    course.begin_session(1);
    SimulatedPerson person = make_person("ideal", 3, participant);
    std::vector<std::size_t> arms;
    for (std::uint32_t count = 0; const auto next = course.next(); ++count) {
      if (study.tasks[next->task].name == "hold") arms.push_back(next->arm);
      course.add(answered(study, person, *next, 0.0, count));
    }
    ASSERT_EQ(arms.size(), 18U);
    for (std::size_t i = 0; i < 18; ++i) EXPECT_EQ(arms[i], arms[i / 6 * 6]);
    for (std::size_t place = 0; place < 3; ++place) ++place_of_arm[{place, arms[6 * place]}];
  }
  for (const auto& [place, count] : place_of_arm) EXPECT_EQ(count, 2);
  EXPECT_EQ(place_of_arm.size(), 9U);
}

TEST(Course, TheNoiseIsTheArmsShareOfTheOwnThreshold) {
  const Study study = small_study();
  Course course(study, kCourseKey, 0);
  course.begin_session(1);
  SimulatedPerson person = make_person("sr", 3, 0);
  double log_error = 1.0;
  for (std::uint32_t count = 0; const auto next = course.next(); ++count) {
    const StudyTask& task = study.tasks[next->task];
    if (task.name == "stiffness") {
      const double threshold = std::pow(10.0, course.threshold().value().log10.mean);
      EXPECT_DOUBLE_EQ(next->noise, task.arms[next->arm].share * threshold);
      log_error = std::log10(threshold / person.noise_threshold);
    }
    if (task.name == "threshold") {
      EXPECT_DOUBLE_EQ(next->noise, std::min(std::pow(10.0, next->level), 0.1));
    }
    course.add(answered(study, person, *next, 0.0, count));
  }
  EXPECT_NEAR(log_error, 0.0, 0.3);  // three standard errors of 40 trials
}

// The study's seed is in the study file: orders that followed from it and the arm would reveal the arm.
TEST(Course, LevelsOfAnArmFollowFromTheKey) {
  Study study = small_study();
  study.tasks[study.find_task("stiffness").value()].method = Method::kConstant;
  std::set<std::vector<double>> orders;
  for (SealedKey key = 1; key <= 4; ++key) {
    Course course(study, key, 0);
    course.begin_session(1);
    std::vector<double> levels;
    for (const TrialRecord& trial : whole_session(study, course)) {
      const std::size_t task = study.find_task(trial.task).value();
      if (trial.task != "stiffness" || trial.practice) continue;
      if (arms_of_codes(key, 0, task, 3)[static_cast<std::size_t>(trial.code[1] - '1')] == 1)
        levels.push_back(trial.level);
    }
    ASSERT_EQ(levels.size(), 10U);
    orders.insert(levels);
  }
  EXPECT_EQ(orders.size(), 4U);
}

TEST(Course, TheOrderOfOnePersonsForceControlDoesNotTellAnothersOrder) {
  const Study study = small_study();
  std::set<std::size_t> places;  // of the first one's first arm in the order of the second one
  for (SealedKey key = 1; key <= 20; ++key) {
    std::vector<std::vector<std::size_t>> orders;
    for (const std::uint32_t participant : {0U, 1U}) {
      Course course(study, key, participant);
      course.begin_session(1);
      SimulatedPerson person = make_person("ideal", 3, participant);
      std::vector<std::size_t>& arms = orders.emplace_back();
      for (std::uint32_t count = 0; const auto next = course.next(); ++count) {
        if (study.tasks[next->task].name == "hold" && next->number % 6 == 0) arms.push_back(next->arm);
        course.add(answered(study, person, *next, 0.0, count));
      }
    }
    const auto found = std::find(orders[1].begin(), orders[1].end(), orders[0][0]);
    places.insert(static_cast<std::size_t>(found - orders[1].begin()));
  }
  EXPECT_EQ(places, (std::set<std::size_t>{0, 1, 2}));
}

TEST(Course, ASessionWhoseNoiseWasNotMeasuredIsRefused) {
  Study study = small_study();
  study.sessions = 5;
  study.max_minutes = 8.0;
  Course course(study, kCourseKey, 0);
  try {
    course.begin_session(4);
    FAIL() << "begins without a threshold";
  } catch (const InputError& error) {
    EXPECT_NE(
        std::string(error.what()).find("follows from task threshold, of which 0 of 40 trials were done"),
        std::string::npos)
        << error.what();
  }
  for (const int session : {1, 2, 3, 4, 5}) {
    course.begin_session(session);
    whole_session(study, course);
  }
}

TEST(Course, ALogOfAnotherStudyIsRefused) {
  const Study study = small_study();
  Course course(study, kCourseKey, 0);
  course.begin_session(1);
  TrialRecord record = record_of(study, course.next().value(), 1, 1);
  record.level += 0.1;
  EXPECT_THROW(course.add(record), InputError);
  Course other(study, kCourseKey + 1, 3);
  other.begin_session(1);
}

TEST(Course, ALogWhoseSessionHasNoNumberIsRefusedInWords) {
  const Study study = small_study();
  for (const std::string number : {"", "x", "0", "1.5", "1e99", "nan"}) {
    ParticipantLog log;
    log.events.push_back({"", "session", {{"session", number}}});
    Course course(study, kCourseKey, 0);
    try {
      (void)course.replay(log);
      ADD_FAILURE() << number;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(),
                "a session of the log: session = \"" + number + "\": must be a whole number from 1");
    }
  }
}

// Two sessions: the threshold task, then the stiffness task in the second.
Study two_sessions() {
  Study study = small_study();
  const StudyTask threshold = study.tasks[0];
  const StudyTask stiffness = study.tasks[3];
  study.tasks = {threshold, stiffness};
  study.tasks[0].each_session = true;
  study.tasks[1].trials = 40;
  study.tasks[1].practice = 0;
  study.sessions = 3;
  study.max_minutes = 18.0;
  return study;
}

TEST(Course, TheThresholdIsMeasuredAgainAndSetsTheNoiseOfItsSession) {
  const Study study = two_sessions();
  const std::vector<PlannedSession> plan = plan_sessions(study);
  ASSERT_GE(plan.size(), 2U);
  EXPECT_EQ(plan[0].parts.front().run, kFirstRun);
  EXPECT_EQ(plan[1].parts.front().task, 0U);
  EXPECT_EQ(plan[1].parts.front().run, 2);
  EXPECT_EQ(plan[1].parts.front().trials, 40);
  Course course(study, kCourseKey, 0);
  // In the second session the person needs four times as much noise.
  ParticipantLog log;
  double thresholds[2] = {0.0, 0.0};
  for (int session = 1; session <= 2; ++session) {
    SimulatedPerson person = make_person("ideal", 3, 0);
    person.noise_threshold = session == 1 ? 0.01 : 0.04;
    log.events.push_back({"", "session", {{"session", std::to_string(session)}}, log.trials.size()});
    course.begin_session(session);
    for (std::uint32_t count = 0; const auto next = course.next(); ++count) {
      if (next->task == 1) {
        const Course::Threshold own = course.threshold().value();
        EXPECT_EQ(own.session, session);
        EXPECT_FALSE(own.at_edge);
        thresholds[session - 1] = std::pow(10.0, own.log10.mean);
        EXPECT_DOUBLE_EQ(next->noise, study.tasks[1].arms[next->arm].share * thresholds[session - 1]);
      }
      log.trials.push_back(answered(study, person, *next, 0.0, count));
      log.trials.back().session = session;
      course.add(log.trials.back());
    }
  }
  EXPECT_NEAR(std::log10(thresholds[0] / 0.01), 0.0, 0.3);
  EXPECT_NEAR(std::log10(thresholds[1] / 0.04), 0.0, 0.3);
  Course again(study, kCourseKey, 0);
  EXPECT_EQ(again.replay(log), 2);  // throws if a trial differs
}

TEST(Course, AThresholdThatNobodyReachesIsAtTheEdge) {
  const Study study = two_sessions();
  Course course(study, kCourseKey, 0);
  course.begin_session(1);
  SimulatedPerson person = make_person("random", 3, 0);
  EXPECT_FALSE(course.threshold());
  for (std::uint32_t count = 0; course.next()->task == 0; ++count) {
    EXPECT_FALSE(course.uses_threshold());
    course.add(answered(study, person, *course.next(), 0.0, count));
  }
  EXPECT_TRUE(course.uses_threshold());
  EXPECT_TRUE(course.threshold()->at_edge);
  EXPECT_TRUE(course.threshold()->above);
}

// Practice until 4 of the last 5 answers are correct, after two examples; 12 trials at most.
Study trained() {
  Study study = small_study();
  study.tasks = {study.tasks[3]};
  study.tasks[0].arms.resize(1);
  study.tasks[0].practice = 0;
  study.tasks[0].examples = 2;
  study.tasks[0].practice_until = PracticeCriterion{4, 5, 12};
  return study;
}

// Practice trials when the answers, examples too, are as in the text: C correct, i incorrect, s spoiled.
int practice_with(const std::string& answers, bool* met) {
  const Study study = trained();
  Course course(study, kCourseKey, 0);
  course.begin_session(1);
  int trials = 0;
  for (; course.next()->practice; ++trials) {
    const Trial trial = *course.next();
    EXPECT_EQ(trial.example, trials < 2);
    TrialRecord record = record_of(study, trial, 1, 1);
    const char answer = answers.at(static_cast<std::size_t>(trials));
    record.counted = (trial.level > 0.0) == (answer == 'C');
    if (answer == 's') record.spoiled = {"late"};
    course.add(record);
    *met = course.practice().met;
  }
  return trials;
}

TEST(Course, PracticeEndsWithItsCriterionOrItsLargestNumber) {
  bool met = false;
  EXPECT_EQ(practice_with("iiCCCCC", &met), 7);  // examples do not count
  EXPECT_TRUE(met);
  EXPECT_EQ(practice_with("CCiCiiCCCC", &met), 10);  // after 9 trials 3 of the last 5, with the next 4 of 5
  EXPECT_TRUE(met);
  EXPECT_EQ(practice_with("CCCsCCiC", &met), 8);  // spoiled ones do not count
  EXPECT_TRUE(met);
  EXPECT_EQ(practice_with("CCiiCiCiiCiC", &met), 12);
  EXPECT_FALSE(met);
}

TEST(Course, CatchTrialsOfOneForceAreEasyAndNoPartOfTheSensitivity) {
  Study study = small_study();
  study.tasks[2].catch_share = 0.5;
  Course course(study, kCourseKey, 0);
  course.begin_session(1);
  SimulatedPerson person = make_person("sr", 3, 0);
  double fixed = 0.0;
  int easy = 0;
  for (std::uint32_t count = 0; const auto next = course.next(); ++count) {
    if (study.tasks[next->task].name == "curve") {
      if (!next->catch_trial) fixed = next->level;
      if (next->catch_trial && fixed != 0.0) {
        EXPECT_NEAR(next->level, fixed + std::log10(3.0), 1e-12);
        ++easy;
      }
    }
    course.add(answered(study, person, *next, 0.0, count));
  }
  EXPECT_GE(easy, 2);
}

TEST(TaskOrders, OfALatinSquareHaveEachTaskAtEachPlaceAndAfterEachOther) {
  Study study = small_study();
  EXPECT_EQ(task_orders(study), (std::vector<std::vector<std::size_t>>{{0, 1, 2, 3, 4}}));
  study.latin_order = true;
  const std::vector<std::vector<std::size_t>> orders = task_orders(study);
  // curve, stiffness and hold move; an odd number of them needs six rows. Threshold and weak force stay
  // first.
  ASSERT_EQ(orders.size(), 6U);
  std::map<std::pair<std::size_t, std::size_t>, int> places;
  std::map<std::pair<std::size_t, std::size_t>, int> neighbours;
  for (const std::vector<std::size_t>& order : orders) {
    ASSERT_EQ(order.size(), 5U);
    EXPECT_EQ(order[0], 0U);
    EXPECT_EQ(order[1], 1U);
    for (std::size_t i = 2; i < 5; ++i) ++places[{i, order[i]}];
    for (std::size_t i = 3; i < 5; ++i) ++neighbours[{order[i - 1], order[i]}];
  }
  ASSERT_EQ(places.size(), 9U);
  for (const auto& [place, count] : places) EXPECT_EQ(count, 2);
  ASSERT_EQ(neighbours.size(), 6U);
  for (const auto& [pair, count] : neighbours) EXPECT_EQ(count, 2);
  EXPECT_NE(plan_sessions(study, 0)[0].parts[2].task, plan_sessions(study, 1)[0].parts[2].task);
}

}  // namespace
}  // namespace palpate::study
