#include "study/session/trial_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/session/simulate.h"
#include "study/session/test/simulated_log.h"
#include "study/session/test/small_study.h"

namespace palpate::study {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

Participant one_trial() {
  Participant person = new_participant(2);
  TrialRecord trial;
  trial.time = "2026-03-01T09:00:00.000Z";
  trial.session = 1;
  trial.block = 3;
  trial.task = "stiffness";
  trial.number = 7;
  trial.code = code_of(2, 2, 1, 3);
  trial.level = -0.5;
  trial.second = true;
  trial.answer = 1;
  trial.response_time = 0.75;
  trial.spoiled = {"band", "late"};
  trial.intervals[0] = {10, 20, 1.5, 1.25, 8e-3, 6e-3};
  person.log.trials.push_back(trial);
  return person;
}

TEST(TrialTable, ARowHasTheTrialInUnitsThatPeopleRead) {
  const Study study = test_study();
  const Participant person = one_trial();
  const std::vector<std::string> lines =
      lines_of(table_csv(study, std::vector<Participant>{person}, ArmNames(study, kTestKey, true)));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(
      lines[0],
      "participant,session,block,task,trial_number,time,practice,repetition,catch_trial,condition,level,"
      "stimulus,stimulus_unit,second,answer,correct,response_time_s,spoiled,rms_error_N,variation,"
      "observer,peak_force_1_N,mean_force_1_N,depth_1_mm,work_1_mJ,peak_force_2_N,mean_force_2_N,"
      "depth_2_mm,work_2_mJ,noise_sd_N,threshold_sd_N,onset_1_s,onset_2_s");
  // exp(-0.5) = 0.6065: the comparison, in the second interval, is softer; "first" is correct.
  EXPECT_EQ(lines[1],
            "P1002,1,3,stiffness,7,2026-03-01T09:00:00.000Z,0,0,0,constant,-0.5,0.6065,ratio,1,1,1,0.75,"
            "band;late,,,,1.5,1.25,8,6,0,0,0,0,,,,");
}

TEST(TrialTable, ConditionIsTheOwnCodeUntilUnblinding) {
  const Study study = test_study();
  const Participant person = one_trial();
  const std::string blind =
      table_csv(study, std::vector<Participant>{person}, ArmNames(study, kTestKey, false));
  EXPECT_EQ(fields_of(lines_of(blind)[1])[9], person.log.trials[0].code);
  for (const char* name : {"off", "constant", "paper"}) EXPECT_THAT(blind, Not(testing::HasSubstr(name)));
}

TEST(TrialTable, PeopleWhoWithdrewAreNotExported) {
  const Study study = test_study();
  Participant person = one_trial();
  person.log.events.push_back({"", "withdrawn", {}});
  const std::string table =
      table_csv(study, std::vector<Participant>{person}, ArmNames(study, kTestKey, true));
  EXPECT_EQ(lines_of(table).size(), 1U);
}

// Area under the ROC curve of scores for noise.
double area(const std::vector<std::pair<double, bool>>& scored) {
  double wins = 0.0;
  double pairs = 0.0;
  for (const auto& [a, noisy] : scored) {
    if (!noisy) continue;
    for (const auto& [b, other] : scored) {
      if (other) continue;
      pairs += 1.0;
      wins += a > b ? 1.0 : a == b ? 0.5 : 0.0;
    }
  }
  return wins / pairs;
}

// Codes are drawn independently for each person, so the conditions of half of the people predict nothing
// about the other half. The predictor is the share of noise behind each value of a column, or its number.
TEST(TrialTable, BlindTableDoesNotPredictTheCondition) {
  const Study study = test_study();
  constexpr std::uint32_t kPeople = 1334;  // three trials each; 2,001 are predicted
  std::vector<Participant> people;
  for (std::uint32_t number = 0; number < kPeople; ++number) {
    people.push_back(new_participant(number));
    Random random(19, number, 0);
    add_stiffness(people.back(), study, 1, {0.2, 0.2, 0.2}, random);
    std::rotate(people.back().log.trials.begin(), people.back().log.trials.begin() + number % 3,
                people.back().log.trials.end());
  }
  const std::vector<std::string> blind = lines_of(table_csv(study, people, ArmNames(study, kTestKey, false)));
  const std::vector<std::string> open = lines_of(table_csv(study, people, ArmNames(study, kTestKey, true)));
  const std::vector<std::string> header = fields_of(blind[0]);
  for (const std::string column : {"condition", "second", "answer"}) {
    const auto index =
        static_cast<std::size_t>(std::find(header.begin(), header.end(), column) - header.begin());
    std::map<std::string, std::pair<double, double>> learned;  // noise, all
    std::vector<std::pair<double, bool>> scored;
    for (std::size_t i = 1; i < blind.size(); ++i) {
      const std::string value = fields_of(blind[i])[index];
      const bool noisy = fields_of(open[i])[9] != "off";
      auto& [noise, all] = learned[value];
      if (i <= blind.size() / 2) {
        noise += noisy ? 1.0 : 0.0;
        all += 1.0;
      } else {
        scored.emplace_back(noise / std::max(all, 1.0), noisy);
      }
    }
    EXPECT_GE(scored.size(), 2000U);
    EXPECT_NEAR(area(scored), 0.5, 0.05) << column;
  }
}

TEST(TrialTable, NoiseAndItsThresholdAreShownWhereTheyDoNotRevealTheCondition) {
  const Study study = small_study();
  Participant person{0, simulate_trials(study, kTestKey, 0, make_person("sr", study.seed, 0))};
  person.log.trials.back().intervals[0].from_tick = 1500;
  person.renderings = renderings_of(study, kTestKey, person, 1000.0);
  ASSERT_EQ(person.renderings.size(), person.log.trials.size());
  double threshold = 0.0;
  for (const bool unblinded : {false, true}) {
    const ArmNames names(study, kTestKey, unblinded);
    for (const TrialRecord& trial : person.log.trials) {
      const std::vector<std::string> row = trial_row(study, person, trial, names);
      const std::string& noise = row[row.size() - 4];
      const std::string& own = row[row.size() - 3];
      if (trial.task == "threshold") {
        EXPECT_NEAR(std::stod(noise), std::min(0.1, std::pow(10.0, trial.level)), 1e-4);
        EXPECT_EQ(own, "");
      } else if (trial.task == "stiffness") {
        threshold = std::stod(own);
        EXPECT_EQ(noise.empty(), !unblinded);
        if (!unblinded) continue;
        // The arms are off with 0, constant and paper with 0.6.
        const double share = row[9] == "off" ? 0.0 : 0.6;
        EXPECT_NEAR(std::stod(noise), share * threshold, 1e-5 * threshold);
      }
    }
    EXPECT_EQ(trial_row(study, person, person.log.trials.back(), names).end()[-2], "1.5");
  }
  EXPECT_NEAR(std::log10(threshold / make_person("sr", study.seed, 0).noise_threshold), 0.0, 0.3);
}

}  // namespace
}  // namespace palpate::study
