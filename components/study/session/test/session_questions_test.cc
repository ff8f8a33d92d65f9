#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/output_file.h"
#include "io/system/sha256.h"
#include "io/system/temporary.h"
#include "palpate/error.h"

#include "study/session/run_session.h"

namespace palpate::study {
namespace {

using testing::ElementsAre;

constexpr const char* kAskingStudy = R"(
[study]
name = "asking"
scene = "box"
[ethics]
consent_file = "consent.md"
approval = "PLACEHOLDER, no committee and no number"
[participants]
ask = ["age_band", "hand"]
[[task]]
name = "weak"
kind = "force-detection"
force_mN = { from = 5, to = 500 }
trials = 4
)";

/// Gives prepared answers. After the last one, the participant holds the withdraw key, or the experimenter
/// stops the session.
class ScriptedScreens final : public SessionScreens {
 public:
  explicit ScriptedScreens(std::deque<std::size_t> answers, ScreenInput last = ScreenInput::kWithdraw)
      : answers_(std::move(answers)), last_(last) {}

  void show(const ScreenContent& /*content*/) override {}
  std::optional<ScreenInput> take_input() override { return std::exchange(input_, std::nullopt); }
  std::string take_note() override { return {}; }
  std::optional<std::size_t> ask(const Question& question) override {
    asked.push_back(question.text);
    if (answers_.empty()) {
      input_ = last_;
      return std::nullopt;
    }
    const std::size_t answer = answers_.front();
    answers_.pop_front();
    return answer;
  }
  std::optional<bool> audible_trial(const AudibleTrial& /*trial*/,
                                    const std::function<void(bool)>& /*noise*/) override {
    return std::nullopt;
  }

  std::vector<std::string> asked;

 private:
  std::deque<std::size_t> answers_;
  ScreenInput last_;
  std::optional<ScreenInput> input_;
};

class SessionQuestionsTest : public testing::Test {
 protected:
  SessionQuestionsTest() {
    const std::filesystem::path file = scratch_.path() / "asking.toml";
    write_output(file, kAskingStudy);
    write_output(scratch_.path() / "consent.md", "Do you agree?");
    prepare_study(file, scratch_.path() / "study", 2);
    study_ = open_study(scratch_.path() / "study");
  }

  SessionOutcome run(ScriptedScreens& screens) {
    SessionOptions options;
    options.participant = study_.ids[0];
    options.device = "emulated";
    options.screens = &screens;
    return run_session(study_, study_.key, options);
  }
  /// Values of the first event with this name.
  std::vector<std::string> values_of(const std::string& name) {
    std::vector<std::string> values;
    for (const EventRecord& event : study_.read(study_.ids[0]).events) {
      if (event.event != name) continue;
      for (const auto& [key, value] : event.values) values.push_back(key + "=" + value);
      break;
    }
    return values;
  }

  ScratchFolder scratch_{"palpate-session-questions"};
  StudyFolder study_;
};

TEST_F(SessionQuestionsTest, TheConsentTextOfTheFolderIsAskedFirst) {
  ScriptedScreens screens({1});  // does not agree
  const SessionOutcome outcome = run(screens);
  EXPECT_THAT(screens.asked, ElementsAre("Do you agree?"));
  EXPECT_EQ(values_of("consent").front(), "answer=no");
  EXPECT_EQ(outcome.blocks, 0);
  EXPECT_FALSE(outcome.complete);
}

TEST_F(SessionQuestionsTest, NobodyWhoRefusedGoesOnWithoutConsent) {
  ScriptedScreens first({1});
  run(first);
  ScriptedScreens second({1});
  const SessionOutcome outcome = run(second);
  EXPECT_THAT(second.asked, ElementsAre("Do you agree?"));
  EXPECT_EQ(outcome.blocks, 0);
}

TEST_F(SessionQuestionsTest, ConsentAndBandsAreAskedUntilTheyAreGivenAndThenNeverAgain) {
  ScriptedScreens agrees({0}, ScreenInput::kStop);
  run(agrees);
  EXPECT_THAT(agrees.asked, ElementsAre("Do you agree?", "Your age?"));
  EXPECT_THAT(values_of("consent"), ElementsAre("answer=yes", "hash=" + sha256("Do you agree?")));
  ScriptedScreens answers({0, 1}, ScreenInput::kStop);
  run(answers);
  EXPECT_THAT(answers.asked, ElementsAre("Your age?", "Your dominant hand?", testing::_));
  EXPECT_THAT(values_of("answers"), ElementsAre("age_band=18-29", "hand=right"));
  ScriptedScreens again({}, ScreenInput::kStop);
  run(again);
  EXPECT_EQ(again.asked.size(), 1U) << "the instructions alone";
}

TEST_F(SessionQuestionsTest, NobodyTakesPartInAStudyWithoutAConsentText) {
  study_.study.consent_file.clear();
  ScriptedScreens screens({});
  EXPECT_THROW(run(screens), InputError);
}

TEST_F(SessionQuestionsTest, NobodyTakesPartInAStudyWithoutAnApproval) {
  for (const char* approval : {"", "  "}) {
    study_.study.approval = approval;
    ScriptedScreens screens({});
    try {
      run(screens);
      ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(
          error.what(),
          testing::HasSubstr("ethics.approval: is missing, must be the ethics committee and the number"));
    }
    EXPECT_TRUE(screens.asked.empty());
  }
}

TEST_F(SessionQuestionsTest, AParticipantWhoWithdrawsDuringAQuestionHasWithdrawn) {
  ScriptedScreens screens({0, 2});
  const SessionOutcome outcome = run(screens);
  EXPECT_THAT(screens.asked, ElementsAre("Do you agree?", "Your age?", "Your dominant hand?",
                                         testing::StartsWith("The session is over. Thank you!")));
  EXPECT_TRUE(outcome.withdrawn);
  EXPECT_TRUE(study_.read(study_.ids[0]).withdrawn());
  EXPECT_EQ(outcome.blocks, 0);
}

}  // namespace
}  // namespace palpate::study
