#include <deque>
#include <string>

#include <gtest/gtest.h>

#include "io/system/output_file.h"
#include "io/system/sha256.h"
#include "io/system/temporary.h"

#include "study/session/session_questions.h"
#include "study/session/test/small_study.h"

namespace palpate::study {
namespace {

/// Screens whose answers to questions are given in advance.
class GivenAnswers final : public SessionScreens {
 public:
  void show(const ScreenContent& /*content*/) override {}
  std::optional<ScreenInput> take_input() override { return std::nullopt; }
  std::string take_note() override { return ""; }
  std::optional<std::size_t> ask(const Question& question) override {
    asked.push_back(question.text);
    const std::size_t answer = answers.front();
    answers.pop_front();
    return answer;
  }
  std::optional<bool> audible_trial(bool /*second*/, const std::function<void(bool)>& /*noise*/) override {
    return std::nullopt;
  }

  std::deque<std::size_t> answers;
  std::vector<std::string> asked;
};

class Consent : public testing::Test {
 protected:
  Consent() {
    write_output(scratch_.path() / "consent.md", "I may stop at any time.");
    study_.folder = scratch_.path();
    study_.study = small_study();
    study_.study.consent_file = (scratch_.path() / "consent.md").string();
    study_.study.ask = {"hand"};
    options_.screens = &screens_;
  }

  // A new session, as after the program was started again.
  bool consents(std::deque<std::size_t> answers) {
    screens_.answers = std::move(answers);
    screens_.asked.clear();
    LogWriter log(scratch_.path() / "P.jsonl", {"first", "key"});
    return SessionQuestions(study_, options_, 0, log).consent_and_bands();
  }

  ScratchFolder scratch_{"palpate-consent"};
  StudyFolder study_;
  SessionOptions options_;
  GivenAnswers screens_;
};

TEST_F(Consent, NobodyWhoRefusedGoesOnWithoutConsent) {
  constexpr std::size_t kAgree = 0;
  constexpr std::size_t kRefuse = 1;
  EXPECT_FALSE(consents({kRefuse}));
  EXPECT_FALSE(consents({kRefuse})) << "asked a second time";
  EXPECT_TRUE(consents({kAgree, 1}));
  EXPECT_TRUE(consents({})) << "asked although consent is given";
  const ParticipantLog log = read_log(scratch_.path() / "P.jsonl", {"first", "key"});
  ASSERT_EQ(log.events.size(), 4U);
  EXPECT_EQ(log.events[2].value("answer"), "yes");
  EXPECT_EQ(log.events[2].value("hash"), sha256("I may stop at any time."));
  EXPECT_EQ(log.events[3].value("hand"), "right");
}

}  // namespace
}  // namespace palpate::study
