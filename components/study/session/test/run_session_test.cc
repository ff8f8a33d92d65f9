#include "study/session/run_session.h"

#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "io/system/output_file.h"
#include "io/system/temporary.h"
#include "palpate/recording.h"

#include "study/session/simulate.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTinyStudy = R"(
[study]
name = "tiny"
scene = "gallbladder"
seed = 3
sessions = 1
[breaks]
every_trials = 12
[[condition]]
name = "off"
share = 0.0
[[condition]]
name = "constant"
share = 0.6
profile = "constant"
[[task]]
name = "threshold"
kind = "noise-threshold"
force_band_N = [0.5, 1.5]
sigma_mN = { from = 1.0, to = 100.0, per_decade = 20 }
trials = 16
sets_share_of = "threshold"
[[task]]
name = "stiffness"
kind = "stiffness"
standard_k1_N_per_m = 18.0
ratio = { least = 1.02, largest = 3.3, steps = 14 }
depth_mm = 6.0
conditions = ["off", "constant"]
trials = 3
[[task]]
name = "lump"
kind = "inclusion"
ratio = { least = 1.1, largest = 8.0, steps = 15 }
radius_mm = 3.0
depth_mm = 5.0
search_s = 6
conditions = ["off", "constant"]
trials = 2
[[task]]
name = "hold"
kind = "force-control"
target_N = [1.0]
repeats = 1
conditions = ["off", "constant"]
)";

class RunSession : public testing::Test {
 protected:
  RunSession() {
    const fs::path file = scratch_.path() / "tiny.toml";
    write_output(file, kTinyStudy);
    prepare_study(file, scratch_.path() / "study", 2);
    study_ = open_study(scratch_.path() / "study");
    mark_simulated(study_);
    key_ = study_.key;
  }

  ScratchFolder scratch_{"palpate-run-session"};
  StudyFolder study_;
  SealedKey key_ = 0;
};

TEST_F(RunSession, AnObserversSessionIsLoggedRecordedAndReplaysBitForBit) {
  SessionOptions options;
  options.participant = study_.ids[0];
  options.observer = "sr";
  const SessionOutcome outcome = run_session(study_, key_, options);
  EXPECT_TRUE(outcome.complete);
  EXPECT_EQ(outcome.fault, 0U);
  const ParticipantLog log = study_.read(options.participant);
  std::set<std::string> reasons;
  int finished = 0;
  for (const TrialRecord& trial : log.trials) {
    for (const std::string& reason : trial.spoiled) reasons.insert(reason);
    finished += trial.spoiled.empty() && !trial.practice ? 1 : 0;
  }
  EXPECT_EQ(finished, 16 + 6 + 4 + 2) << testing::PrintToString(reasons);
  int blocks = 0;
  for (const EventRecord& event : log.events) {
    if (event.event != "block") continue;
    ++blocks;
    const fs::path file = study_.folder / "recordings" / event.value("recording");
    const record::Recording recording = record::read_recording(file, {}, record::Blind::kAllow);
    EXPECT_EQ(record::replay(recording).rows_different, 0U) << file;
  }
  EXPECT_EQ(blocks, outcome.blocks);
  EXPECT_GE(blocks, 5);  // 16 threshold trials make two, and each task has its own
}

// What a person at the force would have felt: depths reached, the comparison's force by its ratio.
TEST_F(RunSession, TheCuesOfAStiffnessTrialFollowFromTheRatio) {
  SessionOptions options;
  options.participant = study_.ids[1];
  options.observer = "ideal";
  run_session(study_, key_, options);
  int seen = 0;
  for (const TrialRecord& trial : study_.read(options.participant).trials) {
    if (trial.task != "stiffness" || !trial.spoiled.empty()) continue;
    ++seen;
    const auto stiffness = [&](std::size_t i) {
      return trial.intervals[i].peak_force / trial.intervals[i].depth;
    };
    const std::size_t comparison = trial.second ? 1 : 0;
    EXPECT_GE(trial.intervals[0].depth, 6e-3);
    // The law's force at a depth is proportional to k1; depths and speeds of two presses differ a little.
    EXPECT_NEAR(std::log(stiffness(comparison) / stiffness(1 - comparison)), trial.level, 0.12);
  }
  EXPECT_GE(seen, 6);
}

TEST_F(RunSession, SimulatedLogsDependOnFolderKeyAndObserverAlone) {
  const std::string log = simulate_log(study_, key_, 0, "sr");
  EXPECT_EQ(simulate_log(study_, key_, 0, "sr"), log);
  EXPECT_NE(simulate_log(study_, key_, 1, "sr"), log);
  keep_log(study_, study_.ids[0], log);
  EXPECT_EQ(study_.read(study_.ids[0]).trials.size(), 16U + 6U + 4U + 2U);
}

}  // namespace
}  // namespace palpate::study
