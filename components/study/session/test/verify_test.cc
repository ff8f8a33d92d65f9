#include "study/session/verify.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/system/output_file.h"
#include "io/system/temporary.h"

#include "study/session/compare_recording.h"
#include "study/session/course.h"
#include "study/session/run_session.h"
#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kTasks = R"(
[study]
name = "tiny"
scene = "box"
seed = 3
[[condition]]
name = "off"
share = 0.0
[[condition]]
name = "constant"
share = 0.6
[[task]]
name = "threshold"
kind = "noise-threshold"
force_band_N = [0.5, 1.5]
sigma_mN = { from = 1.0, to = 100.0, per_decade = 20 }
trials = 4
sets_share_of = "threshold"
[[task]]
name = "weak"
kind = "force-detection"
force_mN = { from = 5, to = 500 }
trials = 2
[[task]]
name = "stiffness"
kind = "stiffness"
standard_k1_N_per_m = 18.0
ratio = { least = 1.02, largest = 3.3, steps = 14 }
depth_mm = 6.0
conditions = ["off", "constant"]
trials = 1
[[task]]
name = "lump"
kind = "inclusion"
ratio = { least = 1.1, largest = 8.0, steps = 15 }
radius_mm = 3.0
depth_mm = 5.0
search_s = 6
conditions = ["off", "constant"]
trials = 1
[[task]]
name = "hold"
kind = "force-control"
target_N = [1.0]
repeats = 1
conditions = ["off", "constant"]
)";

/// A study in which an observer had all blocks of the first participant; each test has a copy of it.
class Verify : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    whole_ = std::make_unique<ScratchFolder>("palpate-verify");
    const fs::path file = whole_->path() / "tiny.toml";
    write_output(file, kTasks);
    prepare_study(file, whole_->path() / "study", 2);
    StudyFolder study = open_study(whole_->path() / "study");
    mark_simulated(study);
    SessionOptions options;
    options.participant = study.ids[0];
    options.observer = "ideal";
    run_session(study, study.key, options);
  }
  static void TearDownTestSuite() { whole_.reset(); }
  void SetUp() override {
    fs::copy(whole_->path() / "study", folder_.path() / "study", fs::copy_options::recursive);
    fs::permissions(folder_.path() / "study" / "sealed.json", fs::perms(0600));
    study_ = open_study(folder_.path() / "study");
    log_ = study_.log_of(study_.ids[0]);
    recording_ = study_.recording_of(study_.ids[0], 1, 1);
  }

  [[nodiscard]] std::string error(const CheckRecording& check = {}) const {
    return error_of([&] {
      VerifyCounts counts;
      const StudyFolder study = open_study(study_.folder);
      for (const std::string& id : study.ids) verify_participant(study, id, check, counts);
    });
  }
  static std::string passes(const record::Recording& /*recording*/) { return ""; }
  /// Appends an event to the log, as a session does.
  void append(const EventRecord& event) { LogWriter(log_, study_.log_key(study_.ids[0])).append(event); }

  /// The trials of the log's first block, and its recording.
  [[nodiscard]] std::vector<ReplayedTrial> trials_of_block(int block) const {
    std::vector<ReplayedTrial> trials;
    Course(study_.study, study_.key, 0)
        .replay(study_.read(study_.ids[0]), [&](const Trial& planned, const TrialRecord& logged) {
          if (logged.block == block) trials.push_back({planned, logged});
        });
    return trials;
  }
  [[nodiscard]] record::Recording recording_of(int block) const {
    return record::read_recording(study_.recording_of(study_.ids[0], 1, block), {}, record::Blind::kAllow);
  }

  static std::unique_ptr<ScratchFolder> whole_;
  ScratchFolder folder_{"palpate-verify"};
  StudyFolder study_;
  fs::path log_;
  fs::path recording_;
};

std::unique_ptr<ScratchFolder> Verify::whole_;

TEST_F(Verify, CountsLogsTrialsAndRecordings) {
  VerifyCounts counts;
  int checked = 0;
  for (const std::string& id : study_.ids) {
    verify_participant(
        study_, id, [&](const auto&) { return ++checked, std::string(); }, counts);
  }
  EXPECT_EQ(counts.logs, 2U);
  EXPECT_GE(counts.trials, 4U + 2U + 2U + 2U + 2U);
  EXPECT_EQ(counts.recordings, 5U);
  EXPECT_EQ(counts.unfinished, 0U);
  EXPECT_EQ(checked, 5);
  write_output(study_.recording_of(study_.ids[0], 1, 7), "rows of a block that was cut off");
  verify_participant(study_, study_.ids[0], {}, counts);
  EXPECT_EQ(counts.unfinished, 1U);
}

TEST_F(Verify, NamesARecordingWithADefect) {
  EXPECT_EQ(error([](const auto&) { return "tick 3 differs"; }), recording_.string() + ": tick 3 differs");
}

TEST_F(Verify, NoticesRemovedLinesAndARemovedLog) {
  EXPECT_EQ(error(), "no error");
  const std::string bytes = bytes_of(log_);
  std::size_t end = bytes.size();
  for (int removed = 1; removed <= 5; ++removed) {
    end = bytes.rfind('\n', end - 2) + 1;
    write_output(log_, bytes.substr(0, end));
    EXPECT_THAT(error(), HasSubstr(": lines at its end were removed")) << removed;
  }
  fs::remove(log_);
  EXPECT_THAT(error(), HasSubstr(": has 0 lines, must have "));
}

TEST_F(Verify, NoticesAnEmptiedObserverAndAChangedResponseTime) {
  const std::string bytes = bytes_of(log_);
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"\"observer\":\"ideal\"", "\"observer\":\"\""},
                                                        {"\"response_time_s\":", "\"response_time_s\":1"}}) {
    std::string changed = bytes;
    changed.replace(changed.find(from), from.size(), to);
    write_output(log_, changed);
    EXPECT_THAT(error(), HasSubstr("was changed: its mac does not fit"));
  }
}

TEST_F(Verify, NoticesAChangedByteOfARecording) {
  std::string bytes = bytes_of(recording_);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_output(recording_, bytes);
  EXPECT_EQ(error(passes), recording_.string() +
                               ": was changed after the block: its SHA-256 is another one than in the log");
  EXPECT_EQ(error(), "no error") << "without a check of the recordings";
}

TEST_F(Verify, RefusesATrialThatDoesNotFollowFromTheAnswers) {
  TrialRecord trial = study_.read(study_.ids[0]).trials.front();
  trial.level += 0.05;
  LogWriter writer(study_.log_of(study_.ids[1]), study_.log_key(study_.ids[1]));
  writer.append(EventRecord{"", "session", {{"session", "1"}}});
  writer.append(trial);
  EXPECT_THAT(error(), HasSubstr(study_.log_of(study_.ids[1]).string() + ": a trial of the log"));
}

TEST_F(Verify, NamesAMissingRecording) {
  fs::remove(recording_);
  EXPECT_EQ(error(),
            log_.string() + ": session 1, block 1: its recording " + recording_.string() + " is missing");
}

TEST_F(Verify, AFifoInPlaceOfARecordingIsNotAMissingOne) {
  fs::remove(recording_);
  ASSERT_EQ(::mkfifo(recording_.c_str(), 0600), 0);
  EXPECT_EQ(error(), recording_.string() + ": is a FIFO, must be a palpate recording");
}

TEST_F(Verify, NamesALineThatWasAddedToTheHeads) {
  EXPECT_TRUE(verify_folder(study_).empty());
  std::ofstream(study_.folder / "heads.txt", std::ios::app) << "rubbish";
  EXPECT_EQ(error_of([&] { static_cast<void>(verify_folder(study_)); }),
            (study_.folder / "heads.txt").string() +
                ":4: was added: the file must end with the line of the last participant, 3");
}

TEST_F(Verify, NamesFilesBesideTheRecordings) {
  const std::string id = study_.ids[0];
  for (const std::string& name : {id + "-s2-b01.h5", id + "-s1-b1.h5", std::string("Q-s1-b01.h5")}) {
    write_output(study_.folder / "recordings" / name, "");
  }
  EXPECT_THAT(verify_folder(study_),
              testing::UnorderedElementsAre("recordings/" + id + "-s1-b1.h5", "recordings/Q-s1-b01.h5"));
}

TEST_F(Verify, ALogOrMarkThatIsALinkToNothingIsNotAbsent) {
  const auto error_of_link = [&](const fs::path& file) {
    fs::remove(file);
    fs::create_symlink("nowhere", file);
    const std::string found = error();
    fs::remove(file);
    return found;
  };
  for (const fs::path& file : {study_.folder / "unblinded.json", study_.log_of(study_.ids[1])}) {
    EXPECT_EQ(error_of_link(file),
              file.string() + ": is a link that leads to nothing, must be a file or absent");
  }
}

TEST_F(Verify, AnUnblindingRemovesWhatKilledCommandsLeft) {
  const std::string log = "participants/." + study_.ids[0] + ".jsonl.a2b3c4";
  for (const std::string& name : {std::string(".unblinded.json.a2b3c4"), log, std::string(".notes.backup")}) {
    write_output(study_.folder / name, "");
  }
  EXPECT_THAT(verify_folder(study_), testing::ElementsAre(".notes.backup", ".unblinded.json.a2b3c4", log));
  unblind_study(study_, "done", true);
  EXPECT_THAT(verify_folder(study_), testing::ElementsAre(".notes.backup"));
}

TEST_F(Verify, AFileInPlaceOfAFolderIsNamed) {
  fs::remove_all(study_.folder / "participants");
  write_output(study_.folder / "participants", "");
  EXPECT_EQ(error(), (study_.folder / "participants").string() + ": is no folder, must be one");
}

TEST_F(Verify, ARecordingThatCannotBeLookedAtIsAnError) {
  fs::remove(recording_);
  fs::create_symlink(recording_.filename(), recording_);
  EXPECT_EQ(error(), recording_.string() + ": cannot be looked at: Too many levels of symbolic links");
}

TEST_F(Verify, RefusesARecordingOutsideTheFolder) {
  append(EventRecord{"", "block", {{"session", "1"}, {"block", "2"}, {"recording", "../lock.json"}}});
  EXPECT_EQ(error(), log_.string() +
                         ": session 1, block 2: recording = \"../lock.json\": must be the name of a "
                         "file in recordings");
}

// Blocks: 1 threshold, 2 weak, 3 stiffness, 4 lump, 5 hold.
TEST_F(Verify, EachKindOfTrialIsConsistentWithItsRecording) {
  for (int block = 1; block <= 5; ++block) {
    EXPECT_EQ(compare_with_recording(study_.study, trials_of_block(block), recording_of(block)), "") << block;
  }
}

TEST_F(Verify, ARemovedMovedOrAddedTrialIsNotInTheRecording) {
  const record::Recording recording = recording_of(1);
  const std::vector<ReplayedTrial> trials = trials_of_block(1);
  std::vector<ReplayedTrial> changed = trials;
  changed.erase(changed.begin() + 1);
  EXPECT_THAT(compare_with_recording(study_.study, changed, recording),
              HasSubstr("must have a stimulus at tick"));
  changed = trials;
  std::swap(changed[0], changed[1]);
  EXPECT_THAT(compare_with_recording(study_.study, changed, recording),
              HasSubstr("must have a stimulus at tick"));
  changed = trials;
  changed.push_back(changed.back());
  EXPECT_THAT(compare_with_recording(study_.study, changed, recording),
              HasSubstr("begins before the interval"));
  changed = trials;
  changed.resize(changed.size() - 2);
  EXPECT_THAT(compare_with_recording(study_.study, changed, recording),
              HasSubstr("which no trial of the log has"));
}

TEST_F(Verify, ChangedTicksOrCuesDoNotFollowFromTheRows) {
  const auto defect = [&](int block, const std::function<void(TrialRecord&)>& change) {
    std::vector<ReplayedTrial> trials = trials_of_block(block);
    for (ReplayedTrial& trial : trials) {
      if (!trial.logged.spoiled.empty()) continue;
      change(trial.logged);
      break;
    }
    return compare_with_recording(study_.study, trials, recording_of(block));
  };
  EXPECT_THAT(defect(1, [](TrialRecord& trial) { trial.intervals[0].peak_force *= 0.5; }),
              HasSubstr("do not follow"));
  EXPECT_THAT(defect(1, [](TrialRecord& trial) { ++trial.intervals[1].to_tick; }),
              HasSubstr("do not follow"));
  EXPECT_THAT(defect(1, [](TrialRecord& trial) { trial.intervals[0].from_tick += 9; }),
              HasSubstr("must have a stimulus at tick"));
  EXPECT_THAT(defect(1,
                     [](TrialRecord& trial) {
                       trial.observer.clear();
                       trial.response_time = 1e6;
                     }),
              HasSubstr("answered after the end of the recording"));
  EXPECT_THAT(defect(5, [](TrialRecord& trial) { trial.rms_error *= 0.5; }), HasSubstr("do not follow"));
}

TEST_F(Verify, AnotherCommandedNoiseForceOrStiffnessIsNamed) {
  const auto defect = [&](int block, const std::function<void(Trial&)>& change) {
    std::vector<ReplayedTrial> trials = trials_of_block(block);
    for (ReplayedTrial& trial : trials) {
      if (trial.logged.spoiled.empty()) change(trial.planned);
    }
    return compare_with_recording(study_.study, trials, recording_of(block));
  };
  EXPECT_THAT(defect(1, [](Trial& trial) { trial.noise *= 1.01; }), HasSubstr("another noise than planned"));
  EXPECT_THAT(defect(1, [](Trial& trial) { trial.noise = 0.0; }), HasSubstr("has noise, must have none"));
  EXPECT_THAT(defect(2, [](Trial& trial) { trial.level += 0.01; }), HasSubstr("another commanded force"));
  EXPECT_THAT(defect(3, [](Trial& trial) { trial.level += 0.01; }), HasSubstr("another stiffness"));
  EXPECT_THAT(defect(4, [](Trial& trial) { trial.level += 0.01; }),
              HasSubstr("inclusion of another stiffness"));
}

}  // namespace
}  // namespace palpate::study
