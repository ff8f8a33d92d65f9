#include "study/report/study_report.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

#include "study/session/test/forbidden_words.h"
#include "study/session/test/simulated_log.h"
#include "study/session/test/study_text.h"

namespace palpate::report {
namespace {

using palpate::test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;
using namespace palpate::study;  // NOLINT: the test's study and people

// Arms whose names are no words of the report.
constexpr const char* kNames[] = {"sham-arm", "steady-arm", "nearby-arm"};

class StudyReport : public testing::Test {
 protected:
  StudyReport() {
    study_.study = test_study();
    for (const std::size_t task : {std::size_t{2}, std::size_t{3}}) {
      for (std::size_t arm = 0; arm < 3; ++arm) study_.study.tasks[task].arms[arm].name = kNames[arm];
    }
    study_.study.primary->condition = kNames[1];
    study_.study.primary->reference = kNames[0];
    study_.folder = folder_.path();
    study_.lock_hash = "0123abcd";
    study_.ids = {"a", "b", "c", "d", "e", "f"};
    std::ofstream(folder_.path() / "study.toml") << "name = \"registered-text\"\n";
    study_.unblinding = Unblinding{"2026-03-01T09:00:00.000Z", "all done", {}};
    for (std::uint32_t number = 0; number < 6; ++number) people_.push_back(person_of(number));
    people_[3].log.trials[0].spoiled = {"band"};
    for (std::size_t i = 0; i < 40; ++i) people_[2].log.trials[i].spoiled = {"late"};
  }

  [[nodiscard]] Participant person_of(std::uint32_t number) const {
    Random random(41, number, 0);
    Participant person = new_participant(number);
    add_trials(
        person, study_.study, 0, 40, {-2.2, -2.0, -1.8, -1.6},
        [](std::size_t, double level, double) { return 0.5 + 0.5 / (1.0 + std::exp(-9.0 * (level + 2.0))); },
        random);
    add_trials(
        person, study_.study, 1, 12, {-1.5}, [](std::size_t, double, double) { return 0.7; }, random);
    add_stiffness(person, study_.study, 60, {0.2, 0.18, 0.2}, random);
    for (TrialRecord& trial : person.log.trials) {
      for (IntervalCues& cues : trial.intervals) cues.peak_force = 1.0 + 0.1 * random.uniform();
    }
    person.log.events.push_back({"", "audible", {{"trials", "20"}, {"correct", "11"}}});
    return person;
  }

  std::string page_of(bool unblinded) {
    const StudyAnalysis analysis = study::analyse(study_.study, people_, kTestKey, unblinded);
    const std::filesystem::path page = write_study_report(
        study_, analysis, folder_.path() / (unblinded ? "open" : "blind"), "palpate study");
    return study::bytes_of(page);
  }

  const TemporaryFolder folder_;
  StudyFolder study_;
  std::vector<Participant> people_;
};

TEST_F(StudyReport, BlindReportNamesNoConditionAndNoPrimaryContrast) {
  const std::string page = page_of(false);
  EXPECT_THAT(page, HasSubstr("<strong>BLIND.</strong>"));
  EXPECT_THAT(page, HasSubstr("B against A"));
  EXPECT_THAT(page, HasSubstr("0123abcd"));
  EXPECT_THAT(page, HasSubstr("Shown after unblinding: beside the log"));
  for (const char* name : kNames) EXPECT_THAT(page, Not(HasSubstr(name)));
  for (const char* text : {"registered-text", "(primary)", "Primary analysis", "one-sided p", "meant 0.6"}) {
    EXPECT_THAT(page, Not(HasSubstr(text)));
  }
  // The figures of a blind report are drawn without names too.
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "blind")) {
    const std::string text = study::bytes_of(entry.path());
    for (const char* name : kNames) EXPECT_THAT(text, Not(HasSubstr(name))) << entry.path();
  }
}

TEST_F(StudyReport, TheMedianOfTwoPeopleIsTheMiddleBetweenThem) {
  people_.resize(2);
  StudyAnalysis analysis = study::analyse(study_.study, people_, kTestKey, true);
  analysis.people[0].minutes = 40.0;
  analysis.people[1].minutes = 30.0;
  const std::filesystem::path page =
      write_study_report(study_, analysis, folder_.path() / "two", "palpate study");
  EXPECT_THAT(study::bytes_of(page), HasSubstr("35 (30 to 40) min"));
}

TEST_F(StudyReport, UnblindedReportShowsPrimaryResultAndRegistration) {
  const std::string page = page_of(true);
  for (const char* text : {"UNBLINDED.", "all done", "registered-text", "0123abcd", "stiffness (primary)",
                           "steady-arm - sham-arm", "Smallest effect that this study finds with power 0.8",
                           "Both one-sided tests must reject", "meant 0.6", "0 of 6 people heard the noise",
                           "Results that would contradict the hypothesis",
                           "40 of 292 trials spoiled, more than 10 %", "band 1", "The audibility"}) {
    if (std::string(text) == "The audibility") {
      EXPECT_THAT(page, Not(HasSubstr(text)));
    } else {
      EXPECT_THAT(page, HasSubstr(text));
    }
  }
  EXPECT_THAT(page, Not(HasSubstr("SIMULATED")));
  for (const char* file : {"effects.svg", "curve-1.svg", "people-0.svg", "people-2.svg"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "open" / file)) << file;
  }
}

TEST_F(StudyReport, AFifoInPlaceOfAFileOfTheStudyIsRefusedWithoutWaiting) {
  std::filesystem::remove(folder_.path() / "study.toml");
  ASSERT_EQ(mkfifo((folder_.path() / "study.toml").c_str(), 0600), 0);
  EXPECT_THAT([&] { (void)page_of(true); },
              ThrowsMessage<InputError>(HasSubstr("study.toml: is a FIFO, must be a text file")));
}

TEST_F(StudyReport, NoReportChoosesALevelAfterwards) {
  study_.simulated = true;
  for (const bool unblinded : {false, true}) {
    const std::string page = page_of(unblinded);
    EXPECT_THAT(page, HasSubstr("SIMULATED"));
    for (const char* words : kForbiddenWords) EXPECT_THAT(page, Not(HasSubstr(words)));
  }
}

}  // namespace
}  // namespace palpate::report
