#include "study/session/bids.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/system/temporary.h"
#include "palpate/error.h"

#include "study/session/test/simulated_log.h"
#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class Bids : public testing::Test {
 protected:
  Bids() {
    study_.ask = {"age_band"};
    study_.approval = "PLACEHOLDER";
    study_.tasks[2].name = "stiff-ness";
    for (std::uint32_t number = 0; number < 2; ++number) {
      people_.push_back(new_participant(number));
      Random random(23, number, 0);
      add_stiffness(people_.back(), study_, 2, {0.2, 0.2, 0.2}, random);
      people_.back().log.events.push_back({"", "answers", {{"age_band", "30-39"}}});
      people_.back().log.events.push_back({"", "block", {{"session", "1"}, {"recording", "a.h5"}}});
    }
    people_[1].log.events.push_back({"", "withdrawn", {}});
    people_[0].log.trials.back().repeat = true;
    fs::create_directories(scratch_.path() / "recordings");
    std::ofstream(scratch_.path() / "recordings/a.h5") << "rows";
  }

  fs::path write(bool unblinded, const std::string& name) {
    const ArmNames names(study_, kTestKey, unblinded);
    write_bids({study_, people_, names, scratch_.path() / "recordings", "abc", false},
               scratch_.path() / name);
    return scratch_.path() / name;
  }

  const ScratchFolder scratch_{"palpate-bids-"};
  Study study_ = test_study();
  std::vector<Participant> people_;
};

TEST_F(Bids, FilesAreNamedByPersonSessionTaskAndRun) {
  const fs::path folder = write(true, "bids");
  const fs::path beh = folder / "sub-P1000/ses-1/beh";
  const std::string main = bytes_of(beh / "sub-P1000_ses-1_task-stiffness_run-1_beh.tsv");
  EXPECT_EQ(std::count(main.begin(), main.end(), '\n'), 1 + 5);
  EXPECT_THAT(main, HasSubstr("\tconstant\t"));
  EXPECT_TRUE(fs::exists(beh / "sub-P1000_ses-1_task-stiffness_run-2_beh.tsv"));
  const auto json = nlohmann::json::parse(bytes_of(beh / "sub-P1000_ses-1_task-stiffness_run-1_beh.json"));
  EXPECT_EQ(json["TaskName"], "stiff-ness");
  EXPECT_EQ(json["response_time"]["Units"], "s");
  EXPECT_TRUE(json["condition"]["Levels"].contains("paper"));
  const auto description = nlohmann::json::parse(bytes_of(folder / "dataset_description.json"));
  EXPECT_EQ(description["EthicsApprovals"][0], "PLACEHOLDER");
  EXPECT_EQ(bytes_of(folder / "participants.tsv"),
            "participant_id\tage_band\tsimulated\nsub-P1000\t30-39\tno\n");
  EXPECT_FALSE(fs::exists(folder / "sub-P1001"));  // withdrew
  EXPECT_EQ(bytes_of(folder / "sourcedata/sub-P1000/ses-1/a.h5"), "rows");
}

TEST_F(Bids, BlindFolderHasNoConditionAndNoRecording) {
  const fs::path folder = write(false, "blind");
  EXPECT_FALSE(fs::exists(folder / "sourcedata"));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    for (const char* name : {"constant", "paper", "\tc1\t", "\tc2\t", "\tc3\t"}) {
      EXPECT_THAT(bytes_of(entry.path()), Not(HasSubstr(name))) << entry.path();
    }
  }
}

TEST_F(Bids, FolderWithFilesIsNotOverwritten) {
  const fs::path folder = write(false, "twice");
  EXPECT_THROW(write(false, "twice"), InputError);
}

TEST_F(Bids, TasksThatDifferInPunctuationHaveTwoNames) {
  study_.tasks[0].name = "stiffness";
  Random random(24, 0, 0);
  add_trials(
      people_[0], study_, 0, 1, {-2.0}, [](std::size_t, double, double) { return 1.0; }, random);
  const fs::path beh = write(false, "names") / "sub-P1000/ses-1/beh";
  EXPECT_TRUE(fs::exists(beh / "sub-P1000_ses-1_task-stiffness_run-1_beh.tsv"));
  EXPECT_TRUE(fs::exists(beh / "sub-P1000_ses-1_task-stiffness2_run-1_beh.tsv"));
}

}  // namespace
}  // namespace palpate::study
