// `palpate study check`, `prepare`, `status` and `verify` as users call them.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "study/session/folder.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kExample = PALPATE_EXAMPLES "/study/touch-noise.toml";

/// A study of one task, and the folder "study" for two participants.
void prepare(const Folder& folder) {
  std::ofstream(folder / "s.toml")
      << "[study]\nname = \"small\"\nscene = \"box\"\n[[task]]\nname = \"weak\"\n"
         "kind = \"force-detection\"\nforce_mN = { from = 5, to = 500 }\n"
         "trials = 4\npractice = 1\n";
  const Outcome outcome = run(folder, {"study", "prepare", "s.toml", "study", "--participants", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST(StudyCheckCommand, ShowsThePlanAndForcesOfTheExample) {
  const Folder folder;
  const Outcome text = run(folder, {"study", "check", kExample});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("hold 1-45, stiffness 1-33, threshold again 40\n"));
  EXPECT_THAT(text.out, HasSubstr("largest force 4.6 N, of task hold; limit 6 N of the study\n"));
  EXPECT_THAT(text.out, HasSubstr("hint: task lump: the noise is faded out for 0.5 s after every 3 s\n"));
  EXPECT_THAT(text.out, HasSubstr("hint: palpate study power "));
  EXPECT_THAT(text.out, testing::Not(HasSubstr("missing")));
  const Outcome outcome = run(folder, {"study", "check", kExample, "--json"});
  const json found = json::parse(outcome.out);
  EXPECT_EQ(found["sessions"].size(), 4U);
  EXPECT_EQ(found["tasks"][4]["name"], "lump");
  EXPECT_EQ(found["tasks"][4]["practice"], 26);
  EXPECT_NEAR(found["largest_force_N"].get<double>(), 4.6, 1e-9);
  EXPECT_EQ(found["max_force_N"], 6.0);
}

TEST(StudyCheckCommand, CountsThePracticeThatACriterionNeedsAtLeastAndSaysHowMuchItMayAdd) {
  const Folder folder;  // 8 of 10, at most 30
  const char* const file = PALPATE_EXAMPLES "/study/one-session.toml";
  const json found = json::parse(run(folder, {"study", "check", file, "--json"}).out);
  EXPECT_EQ(found["tasks"][1]["practice"], 10);
  EXPECT_THAT(found["hints"].dump(), HasSubstr("practice until 8 of 10 are correct may take 20 trials, "));
}

TEST(StudyCheckCommand, NamesAMaskThatIsHardlyLouderThanTheMotors) {
  const Folder folder;
  std::string text = text_of(PALPATE_EXAMPLES "/study/one-session.toml");
  EXPECT_THAT(run(folder, {"study", "check", PALPATE_EXAMPLES "/study/one-session.toml"}).out,
              HasSubstr("hint: no [sound] mask_dBA and motors_dBA"));
  const std::string level = "level_dB = -20";
  text.replace(text.find(level), level.size(), "mask_dBA = 60\nmotors_dBA = 55");
  text.replace(text.find("consent_file"), 0, "# ");
  std::ofstream(folder / "s.toml") << text << "[markers]\nto = [\"tcp:localhost:5678\"]\n";
  const Outcome outcome = run(folder, {"study", "check", "s.toml"});
  EXPECT_THAT(outcome.out, HasSubstr("mask 60 dB(A), motors 55 dB(A) at the ears, as the lab measured\n"));
  EXPECT_THAT(outcome.out, HasSubstr("markers to tcp:localhost:5678\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("hint: sound: the mask is 5 dB louder than the motors, better 10 or more"));
  const Outcome offline = run(folder, {"study", "run", "nowhere", "--participant", "P", "--observer", "sr",
                                       "--markers", "tcp:localhost:5678"});
  EXPECT_EQ(offline.exit_code, 2);
  EXPECT_THAT(offline.err, HasSubstr("--markers: a session that --observer runs offline has no times"));
}

TEST(StudyCheckCommand, RefusesTheExampleInTwoSessions) {
  const Folder folder;
  std::string text = text_of(kExample);
  const std::string sessions = "sessions = 4";
  text.replace(text.find(sessions), sessions.size(), "sessions = 2");
  std::ofstream(folder / "two.toml") << text;
  const Outcome outcome = run(folder, {"study", "check", "two.toml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("two.toml: study.sessions = 2: the tasks need 4 sessions of at most 60 min"));
}

TEST(StudyCheckCommand, RefusesAKeyThatDoesNotExist) {
  const Folder folder;
  std::string text = text_of(kExample);
  const std::string key = "pedal-left";
  text.replace(text.find(key), key.size(), "pedal-middle");
  std::ofstream(folder / "keys.toml") << text;
  const Outcome outcome = run(folder, {"study", "check", "keys.toml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("keys.toml: response.first = \"pedal-middle\": no such key; keys are a to z"));
}

TEST(StudyCheckCommand, NamesAMissingConsentFileAndTooStiffTissue) {
  const Folder folder;
  std::string text = text_of(kExample);
  const std::string stiffness = "standard_k1_N_per_m = 18.0";
  text.replace(text.find(stiffness), stiffness.size(), "standard_k1_N_per_m = 300");
  std::ofstream(folder / "s.toml") << text;
  const Outcome outcome = run(folder, {"study", "check", "s.toml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out,
              testing::ContainsRegex(
                  "missing: task stiffness: its largest force is [0-9.]+ N, must be at most 6 N, "
                  "safety.max_force_N of scene and study: lower depth_mm, ratio or standard_k1_N_per_m\n"));
  EXPECT_THAT(outcome.out, HasSubstr("missing: ethics.consent_file: there is no file consent-en.md\n"));
}

TEST(StudyCheckCommand, HoldsForcesToTheLowerLimitOfAScene) {
  const Folder folder;
  std::string text = text_of(kExample);
  const std::string scene = "scene = \"gallbladder\"";
  text.replace(text.find(scene), scene.size(), "scene = \"weak.toml\"");
  std::ofstream(folder / "s.toml") << text;
  std::ofstream(folder / "weak.toml")
      << "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:5\"\n[safety]\nmax_force_N = 4\n";
  const Outcome outcome = run(folder, {"study", "check", "s.toml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, HasSubstr("limit 4 N of the scene\n"));
  EXPECT_THAT(outcome.out, HasSubstr("missing: task hold: its largest force is 4.6 N, must be at most 4 N, "
                                     "safety.max_force_N of scene and study\n"));
}

TEST(StudyPrepareCommand, PrintsTheIdsAndTheNextCommands) {
  const Folder folder;
  prepare(folder);
  const std::vector<std::string> ids = study::open_study(folder / "study").ids;
  const Outcome again = run(folder, {"study", "prepare", "s.toml", "study", "--participants", "2"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("study: is in use, must be a new or an empty folder"));
  const Outcome other = run(folder, {"study", "prepare", "s.toml", "other", "--participants", "1"});
  const std::string id = study::open_study(folder / "other").ids.at(0);
  EXPECT_EQ(other.out, "other: 1 participant of study small\n" + id +
                           "\n\nNext:\n  palpate study run other --participant " + id +
                           "\n  palpate study status other\n");
  EXPECT_EQ(run(folder, {"study", "prepare", "s.toml", "third", "--participants", "9999999999"}).exit_code,
            2);
}

TEST(StudyStatusCommand, CountsSessionsTrialsAndCutLines) {
  const Folder folder;
  prepare(folder);
  const study::StudyFolder study = study::open_study(folder / "study");
  {
    study::LogWriter writer(study.log_of(study.ids[0]), study.log_key(study.ids[0]));
    study::TrialRecord trial;
    trial.time = "2026-03-01T10:00:00.000Z";
    writer.append(trial);
    trial.spoiled = {"band"};
    writer.append(trial);
    trial.practice = true;
    writer.append(trial);
    writer.append(study::EventRecord{"2026-03-01T10:01:00.000Z", "session-end", {{"session", "1"}}});
    writer.append(study::EventRecord{"2026-03-01T10:02:00.000Z", "withdrawn", {}});
  }
  std::ofstream(study.log_of(study.ids[0]), std::ios::app) << "{\"n\":";
  const Outcome outcome = run(folder, {"study", "status", "study", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json found = json::parse(outcome.out);
  EXPECT_EQ(found["trials"], 4);
  EXPECT_EQ(found["participants"][0], json({{"id", study.ids[0]},
                                            {"sessions", 1},
                                            {"planned_sessions", 1},
                                            {"trials", 1},
                                            {"planned_trials", 4},
                                            {"spoiled", 1},
                                            {"withdrawn", true},
                                            {"deleted", false},
                                            {"last", "2026-03-01T10:02:00.000Z"},
                                            {"cut_lines", 1}}));
  EXPECT_EQ(found["participants"][1]["last"], "");
  EXPECT_THAT(run(folder, {"study", "status", "study"}).out,
              HasSubstr(study.ids[0] +
                        "         1/1          1/4        1     1  2026-03-01T10:02:00.000Z  withdrawn\n"));
}

TEST(StudyVerifyCommand, SaysWhatItCheckedAndNamesAChangedLineOrRecording) {
  const Folder folder;
  prepare(folder);
  const study::StudyFolder study = study::open_study(folder / "study");
  const std::string id = study.ids[1];
  ASSERT_EQ(run(folder, {"study", "run", "study", "--participant", id, "--observer", "ideal"}).exit_code, 0);
  const std::string log = study.log_of(id).string();
  const std::string recording = study.recording_of(id, 1, 1).string();
  const Outcome outcome = run(folder, {"study", "verify", "study", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out)["recordings"], 1);
  EXPECT_EQ(json::parse(outcome.out)["checked"].size(), 6U);
  const Outcome text = run(folder, {"study", "verify", "study"});
  EXPECT_THAT(text.out, HasSubstr("1 recording are consistent with the sealed key and with each other\n"));
  EXPECT_THAT(text.out, HasSubstr("checked: each trial follows from the answers before it\n"));
  EXPECT_THAT(text.out, Not(HasSubstr("as they were written")));

  std::ofstream(recording) << "no recording";
  const Outcome logs = run(folder, {"study", "verify", "study", "--logs-only"});
  EXPECT_EQ(logs.exit_code, 0);
  EXPECT_THAT(logs.out, HasSubstr("not checked: the content of the recordings\n"));
  const Outcome broken = run(folder, {"study", "verify", "study"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.err,
              HasSubstr(fs::path(recording).filename().string() + ": was changed after the block"));

  std::string lines_of_log = text_of(log);
  lines_of_log.replace(lines_of_log.find("\"ideal\""), 7, "\"\"");
  std::ofstream(log) << lines_of_log;
  for (const char* command : {"verify", "status", "analyse"}) {
    const Outcome changed = run(folder, {"study", command, "study"});
    EXPECT_EQ(changed.exit_code, 2) << command;
    EXPECT_THAT(changed.err, HasSubstr(fs::path(log).filename().string() + ":1: was changed"));
  }
}

// A cycle of links, whose error a privileged user gets, too.
TEST(StudyVerifyCommand, ParticipantsThatCannotBeLookedAtAreNotNobody) {
  const Folder folder;
  prepare(folder);
  fs::remove(folder / "study/participants");
  fs::create_symlink("participants", folder / "study/participants");
  for (const char* command : {"verify", "status"}) {
    const Outcome outcome = run(folder, {"study", command, "study"});
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_THAT(outcome.err, HasSubstr(": cannot be looked at: Too many levels of symbolic links"));
  }
}

TEST(StudyUnblindCommand, SaysWhomItEndsAndNeedsEarlyForIt) {
  const Folder folder;
  prepare(folder);
  const Outcome refused = run(folder, {"study", "unblind", "study", "--why", "done"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(lines(refused.err), 1U);
  EXPECT_THAT(refused.err, HasSubstr("study: 2 of 2 participants are not finished ("));
  EXPECT_FALSE(study::open_study(folder / "study").unblinded());
  const Outcome early = run(folder, {"study", "unblind", "study", "--why", "no money", "--early"});
  EXPECT_EQ(early.exit_code, 0) << early.err;
  EXPECT_THAT(early.err, HasSubstr("ended early: 2 participants cannot be run any more: "));
  EXPECT_TRUE(study::open_study(folder / "study").unblinded());
}

TEST(StudyUnblindCommand, SucceedsThoughStandardOutputTakesNothing) {
  const Folder folder;
  prepare(folder);
  for (const char* command : {"simulate study", "unblind study --why done"}) {
    const std::string line =
        "cd " + folder.path().string() + " && " PALPATE_PROGRAM " study " + command + " > /dev/full 2> err";
    EXPECT_EQ(std::system(line.c_str()), 0) << command;  // NOLINT(concurrency-mt-unsafe): one thread
  }
  EXPECT_TRUE(study::open_study(folder / "study").unblinded());
  EXPECT_THAT(text_of(folder / "err"), HasSubstr("small: unblinded once and for ever"));
}

TEST(StudyDeleteCommand, ListsFilesAsksAndIsNamedByEveryLaterCommand) {
  const Folder folder;
  prepare(folder);
  ASSERT_EQ(run(folder, {"study", "simulate", "study", "--observer", "ideal"}).exit_code, 0);
  const study::StudyFolder study = study::open_study(folder / "study");
  const std::string id = study.ids[0];
  std::ofstream(study.recording_of(id, 1, 1)) << "rows";
  std::ofstream(folder / "study/trials.csv") << "an export";
  const auto typed = [&](const std::string& line) {
    const std::string command = "cd " + folder.path().string() + " && printf '%s' '" + line +
                                "' | " PALPATE_PROGRAM " study delete study --participant " + id +
                                " --why asked > out.txt 2> err.txt";
    return std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe): one thread
  };
  for (const char* line : {"", "y"}) {
    EXPECT_NE(typed(line), 0);
    EXPECT_THAT(text_of(folder / "err.txt"),
                HasSubstr("study: nothing was deleted; type " + id + ", or give --yes"));
    EXPECT_FALSE(study.read(id).trials.empty());
  }
  const std::string plan = text_of(folder / "out.txt");
  EXPECT_THAT(plan, testing::StartsWith("2 files with data of " + id + ":\n  participants/" + id +
                                        ".jsonl\n  recordings/" + id + "-s1-b01.h5\n"));
  EXPECT_THAT(plan, HasSubstr("Nobody else gets number 1 of 2"));
  EXPECT_THAT(plan, HasSubstr("cannot delete earlier exports (CSV, BIDS)"));
  EXPECT_THAT(
      plan,
      HasSubstr("\ntrials.csv is not a file of the study: look yourself whether it holds data of " + id));
  EXPECT_EQ(typed(id), 0) << text_of(folder / "err.txt");
  EXPECT_THAT(text_of(folder / "err.txt"), HasSubstr("1 person's data deleted on request (" + id));

  const std::vector<std::string> confirmed = {"study", "delete", "study", "--participant",
                                              id,      "--why",  "asked", "--yes"};
  EXPECT_EQ(run(folder, confirmed).exit_code, 0) << "again";
  EXPECT_THAT(run(folder, {"study", "verify", "study"}).out, HasSubstr("1 person's data deleted on request"));
  EXPECT_EQ(json::parse(run(folder, {"study", "verify", "study", "--json"}).out)["deleted"], 1);
  EXPECT_THAT(run(folder, {"study", "status", "study"}).out, HasSubstr("data deleted on request: asked\n"));
  EXPECT_THAT(run(folder, {"study", "analyse", "study", "--report", "out"}).out,
              HasSubstr("1 person's data deleted on request"));
  EXPECT_THAT(text_of(folder / "out/report.html"), HasSubstr("1 person&#39;s data deleted on request"));
  EXPECT_EQ(json::parse(run(folder, {"study", "analyse", "study", "--json"}).out)["deleted"][0]["id"], id);
  EXPECT_THAT(run(folder, {"study", "export", "study", "--csv", "t.csv"}).err,
              HasSubstr("1 person's data deleted on request"));
  EXPECT_THAT(text_of(folder / "t.csv"), Not(HasSubstr(id)));
  ASSERT_EQ(run(folder, {"study", "export", "study", "--bids", "bids"}).exit_code, 0);
  EXPECT_THAT(text_of(folder / "bids/README"), HasSubstr("1 person's data deleted on request"));
  const Outcome rerun = run(folder, {"study", "run", "study", "--participant", id, "--observer", "ideal"});
  EXPECT_EQ(rerun.exit_code, 2);
  EXPECT_THAT(rerun.err, HasSubstr("the data of " + id + " were deleted on 2"));
}

TEST(StudyVerifyCommand, NamesFilesThatAreNoPartOfTheStudy) {
  const Folder folder;
  prepare(folder);
  const std::string id = study::open_study(folder / "study").ids[0];
  for (const std::string& name :
       {id + "-status.txt", "participants/" + id + ".cut", std::string(".unblinded.json.abcdef"),
        std::string("participants/P.jsonl"), std::string("notes.txt")}) {
    std::ofstream(folder / ("study/" + name)) << "x\n";
  }
  const Outcome text = run(folder, {"study", "verify", "study"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, testing::EndsWith(
                            "no part of the study: .unblinded.json.abcdef, left by a killed command\n"
                            "no part of the study: notes.txt\nno part of the study: participants/P.jsonl\n"));
  EXPECT_EQ(json::parse(run(folder, {"study", "verify", "study", "--json"}).out)["foreign"].size(), 3U);
  EXPECT_EQ(run(folder, {"study", "run", "study", "--participant", id, "--observer", "ideal"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder / "study/.unblinded.json.abcdef"));
  EXPECT_TRUE(fs::exists(folder / "study/notes.txt"));
}

}  // namespace
}  // namespace palpate::tests
