#include "science/experiment/verify.h"

#include <gtest/gtest.h>

#include "io/system/output_file.h"
#include "io/system/temporary.h"
#include "science/experiment/course.h"
#include "science/experiment/test/study_text.h"

namespace palpate::experiment {
namespace {

/// A prepared study in which the first participant had one block.
class Verify : public testing::Test {
 protected:
  void SetUp() override {
    write_output(folder_.path() / "s.toml", kStudyText);
    prepare_study(folder_.path() / "s.toml", folder_.path() / "study", 2);
    study_ = open_study(folder_.path() / "study");
    recording_ = study_.recording_of(study_.ids[0], 1, 2);
    write_output(recording_, "rows");
    log_block(recording_.filename().string());
  }
  void log_block(const std::string& recording) {
    LogWriter writer(study_.log_of(study_.ids[0]), study_.lock_hash);
    if (writer.opened().trials.empty()) {
      writer.append(EventRecord{"", "session", {{"session", "1"}}});
      writer.append(first_trial());
    }
    writer.append(EventRecord{"", "block", {{"session", "1"}, {"block", "2"}, {"recording", recording}}});
  }
  [[nodiscard]] TrialRecord first_trial() const {
    Course course(study_.study, read_sealed_key(study_), 0);
    course.begin_session(1);
    return record_of(study_.study, course.next().value(), 1, 2);
  }
  [[nodiscard]] std::string error(const CheckRecording& check = {}) const {
    return error_of([&] {
      VerifyCounts counts;
      for (const std::string& id : study_.ids)
        verify_participant(study_, read_sealed_key(study_), id, check, counts);
    });
  }

  ScratchFolder folder_{"palpate-verify"};
  StudyFolder study_;
  std::filesystem::path recording_;
};

TEST_F(Verify, CountsLogsTrialsAndRecordings) {
  VerifyCounts counts;
  std::filesystem::path checked;
  for (const std::string& id : study_.ids) {
    verify_participant(
        study_, read_sealed_key(study_), id, [&](const auto& file) { return checked = file, std::string(); },
        counts);
  }
  EXPECT_EQ(counts.logs, 2U);
  EXPECT_EQ(counts.trials, 1U);
  EXPECT_EQ(counts.recordings, 1U);
  EXPECT_EQ(counts.unfinished, 0U);
  write_output(study_.recording_of(study_.ids[0], 1, 3), "rows of a block that was cut off");
  verify_participant(study_, read_sealed_key(study_), study_.ids[0], {}, counts);
  EXPECT_EQ(counts.unfinished, 1U);
  EXPECT_EQ(checked, recording_);
}

TEST_F(Verify, NamesARecordingWithADefect) {
  EXPECT_EQ(error([](const auto&) { return "tick 3 differs"; }), recording_.string() + ": tick 3 differs");
}

TEST_F(Verify, RefusesATrialThatDoesNotFollowFromTheAnswers) {
  TrialRecord trial = first_trial();
  trial.level += 0.05;
  LogWriter writer(study_.log_of(study_.ids[1]), study_.lock_hash);
  writer.append(EventRecord{"", "session", {{"session", "1"}}});
  writer.append(trial);
  EXPECT_NE(error().find(study_.log_of(study_.ids[1]).string() + ": a trial of the log"), std::string::npos);
}

TEST_F(Verify, NamesAMissingRecording) {
  std::filesystem::remove(recording_);
  EXPECT_EQ(error(), study_.log_of(study_.ids[0]).string() + ": session 1, block 2: its recording " +
                         recording_.string() + " is missing");
}

TEST_F(Verify, RefusesARecordingOutsideTheFolder) {
  log_block("../lock.json");
  EXPECT_EQ(error(), study_.log_of(study_.ids[0]).string() +
                         ": session 1, block 2: recording = \"../lock.json\": must be the name of a file in "
                         "recordings");
}

}  // namespace
}  // namespace palpate::experiment
