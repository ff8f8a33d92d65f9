// Recordings of a study that is still blind, at the commands that users call.
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/record/recorder.h"
#include "io/system/sha256.h"
#include "palpate/recording.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// The folder of a study with one blind recording, recordings/b.h5.
struct BlindStudy {
  explicit BlindStudy(double spoil = 0.0) {
    const Outcome made = run(folder, {"run", "--offline", "--duration-s", "0.7", "--record", "open.h5"});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    const record::Recording recorded = record::read_recording(folder / "open.h5");
    fs::create_directory(folder / "recordings");
    record::Recorder recorder(folder / "recordings/b.h5", recorded.scene, true, {},
                              {"pilot", sha256("the proof")});
    recorder.on_start(1);
    for (haptics::TickRow row : recorded.rows) {
      row.noise_force += spoil;
      recorder.on_row(row);
    }
    recorder.finish({});
    fs::remove(folder / "open.h5");
    std::ofstream(folder / "s.toml") << "[organ]\nmesh = \"gallbladder\"\n[tool]\nmesh = \"sphere:3\"\n"
                                        "[device]\nkind = \"replay\"\npath = \"recordings/b.h5\"\n";
  }
  [[nodiscard]] std::vector<std::string> recordings() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder / "recordings")) {
      all.push_back(entry.path().filename().string());
    }
    return all;
  }

  Folder folder;
};

const std::vector<std::vector<std::string>> kShowing = {
    {"export", "recordings/b.h5", "--csv", "b.csv"},
    {"view", "recordings/b.h5", "--screenshot", "b.png", "--size", "64x48"},
    {"score", "recordings/b.h5"},
    {"run", "s.toml", "--offline"},
    {"run", "--offline", "--device", "replay:recordings/b.h5", "--report", "page"},
};

TEST(BlindCommands, EveryCommandThatShowsAForceRefusesWithTheReasonAndWritesNothing) {
  const BlindStudy study;
  for (const std::vector<std::string>& words : kShowing) {
    const Outcome outcome = run(study.folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << words[0];
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("recordings/b.h5: belongs to the study pilot"),
                                   HasSubstr("palpate study unblind"), HasSubstr("--break-blind")));
    EXPECT_EQ(outcome.out, "") << words[0];
  }
  EXPECT_THAT(study.folder.names(), ElementsAre("recordings", "s.toml"));
  EXPECT_THAT(study.recordings(), ElementsAre("b.h5"));
}

TEST(BlindCommands, TheFileOfTheUnblindedStudyOpensThem) {
  const BlindStudy study;
  std::ofstream(study.folder / "unblinded.json") << "{\"proof\":\"the proof\"}\n";
  for (const std::vector<std::string>& words : kShowing) {
    if (words[0] == "score") continue;  // the scene hides nothing
    const bool reports = words.back() == "page";
    const Outcome outcome =
        run(study.folder, words, reports ? kNoPictures : std::map<std::string, std::string>{});
    EXPECT_EQ(outcome.exit_code, 0) << words[0] << ": " << outcome.err;
  }
}

TEST(BlindCommands, ACopyOfARecordingBesideAForgedFileIsAsBlind) {
  const BlindStudy study;
  const Folder other;
  fs::copy(study.folder / "recordings", other / "recordings");
  std::ofstream(other / "unblinded.json") << "{}\n";
  const Outcome outcome = run(other, {"export", "recordings/b.h5", "--csv", "b.csv"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("recordings/b.h5: belongs to the study pilot"));
}

TEST(BlindCommands, BreakBlindOpensThemAndKeepsANoteOfTheCommand) {
  const BlindStudy study;
  for (const std::size_t i : {0U, 1U}) {
    std::vector<std::string> words = kShowing[i];
    words.emplace_back("--break-blind");
    const Outcome outcome = run(study.folder, words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  EXPECT_THAT(run(study.folder, {"score", "recordings/b.h5", "--break-blind"}).err, Not(HasSubstr("blind")));
  const std::string log = text_of(study.folder / "recordings/blind-broken.jsonl");
  EXPECT_EQ(lines(log), 3U);
  for (const char* command : {"palpate export", "palpate view", "palpate score"}) {
    EXPECT_THAT(log, HasSubstr("\"event\":\"break-blind\",\"file\":\"b.h5\",\"command\":\"" +
                               std::string(command) + "\"}\n"));
  }
  EXPECT_EQ(run(study.folder, kShowing[0]).exit_code, 2) << "once is not for ever";
}

TEST(BlindCommands, ReplayAndRepairWorkAndPrintNoForce) {
  const BlindStudy same;
  const Outcome replayed = run(same.folder, {"replay", "recordings/b.h5", "--verify"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  const Outcome repaired = run(same.folder, {"repair", "recordings/b.h5"});
  EXPECT_EQ(repaired.exit_code, 0) << repaired.err;
  const BlindStudy other(0.25);
  const Outcome differs = run(other.folder, {"replay", "recordings/b.h5", "--verify"});
  EXPECT_EQ(differs.exit_code, 4);
  EXPECT_THAT(differs.out, HasSubstr("first: tick 0, hand 0, noise_force_N\n"));
}

}  // namespace
}  // namespace palpate::tests
