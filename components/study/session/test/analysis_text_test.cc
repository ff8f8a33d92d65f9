#include "study/session/analysis_text.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "study/session/test/forbidden_words.h"
#include "study/session/test/simulated_log.h"
#include "study/session/trial_table.h"

namespace palpate::study {
namespace {

using testing::HasSubstr;
using testing::Not;

// Six people with all tasks.
std::vector<Participant> people_of(const Study& study) {
  std::vector<Participant> people;
  for (std::uint32_t number = 0; number < 6; ++number) {
    Random random(31, number, 0);
    people.push_back(new_participant(number));
    add_trials(
        people.back(), study, 0, 30, {-2.2, -2.0, -1.8}, [](std::size_t, double, double) { return 0.8; },
        random);
    add_trials(
        people.back(), study, 1, 12, {-1.5}, [](std::size_t, double, double) { return 0.7; }, random);
    add_stiffness(people.back(), study, 60, {0.2, 0.12, 0.2}, random);
    people.back().log.events.push_back({"", "consent", {{"answer", "yes"}}});
  }
  return people;
}

TEST(AnalysisText, BlindTextAndJsonNameNoCondition) {
  const Study study = test_study();
  const StudyAnalysis blind = analyse(study, people_of(study), kTestKey, false);
  for (const std::string& text : {analysis_text(study, blind), analysis_json(study, blind)}) {
    for (const char* name : {"off", "constant", "paper", "rimary\": true", "inverted"}) {
      EXPECT_THAT(text, Not(HasSubstr(name)));
    }
  }
  EXPECT_THAT(analysis_text(study, blind), HasSubstr("stiffness, C against A, JND: x "));
}

TEST(AnalysisText, BlindJsonHasNobodysResultsByArm) {
  const Study study = test_study();
  const auto of_first_person = [&](bool unblinded) {
    const StudyAnalysis analysis = analyse(study, people_of(study), kTestKey, unblinded);
    return nlohmann::json::parse(analysis_json(study, analysis))["people"][0]["tasks"];
  };
  const auto blind = of_first_person(false);
  const auto open = of_first_person(true);
  ASSERT_EQ(blind.size(), study.tasks.size());
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    EXPECT_EQ(blind[task].contains("conditions"), study.tasks[task].arms.size() == 1)
        << study.tasks[task].name;
    EXPECT_TRUE(open[task].contains("conditions")) << study.tasks[task].name;
  }
}

TEST(AnalysisText, UnblindedTextHasThePrimaryContrastFirst) {
  const Study study = test_study();
  const StudyAnalysis open = analyse(study, people_of(study), kTestKey, true);
  const std::string text = analysis_text(study, open);
  EXPECT_THAT(text, HasSubstr("UNBLINDED\n6 people, 0 withdrawn, 0 excluded from the main analysis\nPrimary "
                              "analysis\n  stiffness, constant - off, JND: x 0."));
  EXPECT_THAT(text, HasSubstr("smallest effect that this study finds with power 0.8: x 0."));
  const auto json = nlohmann::json::parse(analysis_json(study, open));
  EXPECT_EQ(json["contrasts"][0]["contrast"], "constant - off");
  EXPECT_EQ(json["contrasts"][0]["primary"], true);
  EXPECT_EQ(json["curves"][0]["d_prime"].size(), 6U);
  EXPECT_EQ(json["people"].size(), 6U);
  EXPECT_EQ(json["consented"], 6);
  EXPECT_EQ(json["people"][0]["tasks"][2]["conditions"][1]["condition"], "constant");
}

TEST(AnalysisText, EffectsOfLogarithmsAreRatios) {
  Contrast contrast;
  contrast.measure = "ln_jnd";
  contrast.alternative = "less";
  Effect effect{24, -0.162519, -0.3, 0.0, 0.02, false, 0.2};
  EXPECT_EQ(effect_text(contrast, effect),
            "x 0.85 (95 % 0.74 to 1.00), 24 people, p = 0.020 (one-sided, less)");
  EXPECT_EQ(smallest_effect_text(contrast, effect),
            "smallest effect that this study finds with power 0.8: x 0.82");
  effect.open = true;
  EXPECT_THAT(effect_text(contrast, effect), HasSubstr("1.00 or wider)"));
  EXPECT_THAT(smallest_effect_text(contrast, effect), HasSubstr("too few"));
  effect.open = false;
  contrast.measure = "d_prime";
  contrast.alternative = "two-sided";
  EXPECT_EQ(effect_text(contrast, effect), "-0.16 (95 % -0.30 to +0.00), 24 people, p = 0.020");
  EXPECT_EQ(smallest_effect_text(contrast, effect),
            "smallest effect that this study finds with power 0.8: -0.20 or +0.20");
}

TEST(AnalysisText, WhoIsMissingIsCountedByArmAfterUnblindingAlone) {
  StudyAnalysis analysis;
  analysis.unblinded = true;
  analysis.tasks = {{{"off", "constant"}, {}}};
  Contrast contrast;
  contrast.condition = 1;
  contrast.measure = "ln_threshold";
  Effect effect;
  EXPECT_EQ(missing_text(analysis, contrast, effect), "");
  effect.missing = {1, 1, 0, 10, 2, std::log(0.9), std::log(1.5)};
  EXPECT_EQ(missing_text(analysis, contrast, effect),
            "left out with too few trials: 1 person (constant 1, off 0); worst case x 0.90 to x 1.50; "
            "thresholds at the edge of the stimuli: 12 (constant 10, off 2); their answers count");
  analysis.unblinded = false;
  EXPECT_EQ(missing_text(analysis, contrast, effect),
            "left out with too few trials: 1 person; worst case x 0.90 to x 1.50; thresholds at the edge of "
            "the stimuli: 12; their answers count");
}

TEST(AnalysisText, NoTextOrTableChoosesALevelAfterwards) {
  const Study study = test_study();
  const std::vector<Participant> people = people_of(study);
  for (const bool unblinded : {false, true}) {
    const StudyAnalysis analysis = analyse(study, people, kTestKey, unblinded);
    for (const char* words : kForbiddenWords) {
      EXPECT_THAT(analysis_text(study, analysis), Not(HasSubstr(words)));
      EXPECT_THAT(analysis_json(study, analysis), Not(HasSubstr(words)));
      EXPECT_THAT(table_csv(study, people, ArmNames(study, kTestKey, unblinded)), Not(HasSubstr(words)));
      for (const TrialColumn& column : trial_columns())
        EXPECT_THAT(column.description, Not(HasSubstr(words)));
    }
  }
}

}  // namespace
}  // namespace palpate::study
