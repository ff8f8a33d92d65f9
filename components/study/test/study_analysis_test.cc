// `palpate study power`, `analyse`, `unblind` and `export` as users call them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/system/sha256.h"

#include "study/session/test/forbidden_words.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// A study of two tasks with the arms sham-arm and steady-arm.
void write_study(const Folder& folder) {
  std::ofstream(folder / "s.toml")
      << "[study]\nname = \"small\"\nscene = \"box\"\n[[condition]]\nname = \"sham-arm\"\nshare = 0.0\n"
         "[[condition]]\nname = \"steady-arm\"\nshare = 0.6\nprofile = \"constant\"\n"
         "[[task]]\nname = \"threshold\"\nkind = \"noise-threshold\"\n"
         "sigma_mN = { from = 1.0, to = 100.0, per_decade = 20 }\ntrials = 12\nsets_share_of = "
         "\"threshold\"\n"
         "[[task]]\nname = \"stiffness\"\nkind = \"stiffness\"\ndepth_mm = 8.0\n"
         "ratio = { least = 1.02, largest = 3.3, steps = 14 }\n"
         "conditions = [\"sham-arm\", \"steady-arm\"]\ntrials = 20\n"
         "[analysis]\nprimary = { task = \"stiffness\", contrast = \"steady-arm - sham-arm\", "
         "measure = \"ln_jnd\" }\n";
}

/// A folder "study" with three simulated people.
void simulate(const Folder& folder) {
  write_study(folder);
  const Outcome made = run(folder, {"study", "prepare", "s.toml", "study", "--participants", "3"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Outcome done = run(folder, {"study", "simulate", "study", "--observer", "ideal"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
}

TEST(StudyAnalyseCommand, IsBlindUntilTheStudyIsUnblinded) {
  const Folder folder;
  simulate(folder);
  const Outcome blind = run(folder, {"study", "analyse", "study", "--report", "blind"});
  ASSERT_EQ(blind.exit_code, 0) << blind.err;
  EXPECT_THAT(blind.out, HasSubstr("stiffness, B against A, JND: x "));
  EXPECT_THAT(blind.err, HasSubstr("report: blind/report.html"));
  const Outcome unblinded = run(folder, {"study", "unblind", "study", "--why", "all done"});
  EXPECT_EQ(unblinded.exit_code, 0) << unblinded.err;
  const Outcome again = run(folder, {"study", "unblind", "study", "--why", "once more"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("all done"));
  const Outcome open = run(folder, {"study", "analyse", "study", "--json", "--report", "open"});
  const json found = json::parse(open.out);
  EXPECT_EQ(found["unblinded"], true);
  EXPECT_EQ(found["contrasts"][0]["contrast"], "steady-arm - sham-arm");
  EXPECT_EQ(found["people"].size(), 3U);
  for (const std::string& text : {blind.out, text_of(folder / "blind/report.html")}) {
    EXPECT_THAT(text, Not(HasSubstr("sham-arm")));
    EXPECT_THAT(text, Not(HasSubstr("steady-arm")));
  }
  for (const char* words : study::kForbiddenWords) {
    EXPECT_THAT(text_of(folder / "open/report.html") + open.out, Not(HasSubstr(words)));
  }
}

TEST(StudyAnalyseCommand, NeitherOverwritesAReportNorAnalysesAnEmptyStudy) {
  const Folder folder;
  write_study(folder);
  ASSERT_EQ(run(folder, {"study", "prepare", "s.toml", "study", "--participants", "2"}).exit_code, 0);
  const Outcome empty = run(folder, {"study", "analyse", "study"});
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err, HasSubstr("study: no participant has a trial yet"));
  fs::create_directories(folder / "out");
  std::ofstream(folder / "out/report.html") << "mine";
  const Outcome over = run(folder, {"study", "analyse", "study", "--report", "out"});
  EXPECT_EQ(over.exit_code, 2);
  EXPECT_THAT(over.err, HasSubstr("--report out/report.html: exists and is not overwritten"));
  EXPECT_EQ(text_of(folder / "out/report.html"), "mine");
}

TEST(StudyExportCommand, WritesATableOrABidsFolderOnce) {
  const Folder folder;
  simulate(folder);
  EXPECT_EQ(run(folder, {"study", "export", "study"}).exit_code, 2);
  EXPECT_EQ(run(folder, {"study", "export", "study", "--csv", "a.csv", "--bids", "b"}).exit_code, 2);
  ASSERT_EQ(run(folder, {"study", "export", "study", "--csv", "a.csv"}).exit_code, 0);
  const std::string table = text_of(folder / "a.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 3 * (12 + 2 * 20));
  EXPECT_THAT(table, HasSubstr(",c2,"));
  EXPECT_THAT(table, Not(HasSubstr("-arm")));
  const Outcome over = run(folder, {"study", "export", "study", "--csv", "a.csv"});
  EXPECT_EQ(over.exit_code, 2);
  EXPECT_THAT(over.err, HasSubstr("--csv a.csv: exists and is not overwritten"));
  ASSERT_EQ(run(folder, {"study", "export", "study", "--bids", "b"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "b/participants.tsv"));
  EXPECT_EQ(run(folder, {"study", "export", "study", "--bids", "b"}).exit_code, 2);
}

TEST(StudyExportCommand, APreregistrationHasTestsExclusionsPeopleAndHashesBeforeAnybodyAnswers) {
  const Folder folder;
  write_study(folder);
  ASSERT_EQ(run(folder, {"study", "prepare", "s.toml", "study", "--participants", "2"}).exit_code, 0);
  ASSERT_EQ(run(folder, {"study", "export", "study", "--preregistration", "r.md"}).exit_code, 0);
  const std::string text = text_of(folder / "r.md");
  EXPECT_THAT(text, HasSubstr("- Primary: ln_jnd in task stiffness, steady-arm - sham-arm, "));
  EXPECT_THAT(text, HasSubstr("2 people, fixed when the study was prepared."));
  EXPECT_THAT(
      text,
      HasSubstr("- fewer than 70 % of the catch trials correct\n- more than 10 % of the trials spoiled"));
  EXPECT_THAT(text, HasSubstr("- study.toml " + sha256(text_of(folder / "study/study.toml")) + "\n"));
  EXPECT_THAT(text, HasSubstr("- lock.json " + sha256(text_of(folder / "study/lock.json")) + "\n"));
  EXPECT_EQ(run(folder, {"study", "export", "study", "--preregistration", "r.md"}).exit_code, 2);
}

TEST(StudyExportCommand, APreregistrationHasTheOrderOfTasksAndWhatIsMeasuredAgain) {
  const Folder folder;
  const std::string file = PALPATE_EXAMPLES "/study/touch-noise.toml";
  ASSERT_EQ(run(folder, {"study", "prepare", file, "study", "--participants", "1"}).exit_code, 0);
  ASSERT_EQ(run(folder, {"study", "export", "study", "--preregistration", "r.md"}).exit_code, 0);
  const std::string text = text_of(folder / "r.md");
  EXPECT_THAT(text, HasSubstr("Measured again at the start of each session"));
  EXPECT_THAT(text, HasSubstr("in the orders of a Williams square"));
  EXPECT_THAT(text, Not(HasSubstr("Own level")));
}

TEST(StudyPowerCommand, PrintsATableAndRefusesUnknownEffects) {
  const Folder folder;
  write_study(folder);
  const Outcome text = run(folder, {"study", "power", "s.toml", "--participants", "3,4", "--groups", "2"});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("jnd=0.85: JND in stiffness, steady-arm - sham-arm, "));
  EXPECT_THAT(text.out, HasSubstr("-sided test at 5 %"));
  EXPECT_THAT(text.out, HasSubstr("No pooled effect size"));
  const Outcome wrong = run(folder, {"study", "power", "s.toml", "--effect", "jnd"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--effect `jnd`: must be jnd=RATIO or sr=NOISE"));
  const Outcome curve = run(folder, {"study", "power", "s.toml", "--effect", "sr=0.4"});
  EXPECT_EQ(curve.exit_code, 2);
  EXPECT_THAT(curve.err, HasSubstr("needs analysis.inverted_u"));
}

}  // namespace
}  // namespace palpate::tests
