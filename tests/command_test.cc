// The commands that print numbers, and a fault in a run of the program.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/scene.h"

#include "tests/broken_hand.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;

/// The tissue whose values docs/model.md computes by hand.
const char* const kHandWorked = R"([tissue]
name = "hand"
k1_N_per_m = 18.0
beta = 1.6
q = 0.7
rest_length_mm = 10.0
max_length_mm = 15.0
min_length_mm = 5.0
t1_us = 10.0
)";

json model(const Folder& folder, const std::string& rate, const std::string& flag,
           const std::string& values) {
  std::ofstream(folder / "hand.toml") << kHandWorked;
  const Outcome outcome = run(folder, {"model", "--tissue", "hand.toml", "--direction", "press", "--rate-Hz",
                                       rate, flag, values, "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return json::parse(outcome.out);
}

TEST(ModelCommand, GivesTheFiguresWorkedByHand) {
  const Folder folder;
  const json forces = model(folder, "1000", "--force-N", "0.05,0.5");
  EXPECT_EQ(forces["layers_allowed"], 5);
  EXPECT_NEAR(forces["results"][0]["depth_mm"], 2.777778, 1e-6);
  EXPECT_EQ(forces["results"][0]["cutoff_layer"], 1);
  EXPECT_NEAR(forces["results"][1]["depth_mm"], 8.048016, 1e-6);
  EXPECT_EQ(forces["results"][1]["layer_deformation_mm"].size(), 2U);
  EXPECT_EQ(model(folder, "4000", "--depth-mm", "1")["layers_allowed"], 4);
}

// The tissue above with one layer per piece. smooth_law_test.cc in src/core/model/test computes it by hand.
TEST(ModelCommand, ComputesTheSmoothLawWhenAskedFor) {
  const Folder folder;
  std::ofstream(folder / "hand.toml") << kHandWorked;
  const Outcome outcome = run(folder, {"model", "--tissue", "hand.toml", "--law", "smooth", "--rate-Hz",
                                       "25000", "--depth-mm", "4", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  EXPECT_EQ(answer["law"], "smooth");
  EXPECT_NEAR(answer["results"][0]["force_N"], 0.0657020, 1e-7);
  EXPECT_EQ(answer["results"][0]["cutoff_layer"], 1);
}

TEST(ModelCommand, RefusesWhatIsNoForceInOneLine) {
  const Folder folder;
  for (const char* value : {"-1", "nan", "inf", "1,,2", "1x", ""}) {
    const Outcome outcome = run(folder, {"model", "--tissue", "heart", "--direction", "pull", "--rate-Hz",
                                         "1000", "--force-N", value});
    EXPECT_EQ(outcome.exit_code, 2) << value;
    EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(NoiseCommand, PrintsTheSameSamplesForTheSameSeedWithTheStatedSpread) {
  const Folder folder;
  const std::vector<std::string> words{"noise", "--gain-N-m", "5e-5",  "--threshold-mm", "5", "--distance-mm",
                                       "5",     "--samples",  "20000", "--seed",         "7"};
  const Outcome outcome = run(folder, words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(lines(outcome.out), 20000U);
  EXPECT_EQ(run(folder, words).out, outcome.out);
  double sum_of_squares = 0.0;
  std::istringstream values(outcome.out);
  for (double value = 0.0; values >> value;) sum_of_squares += value * value;
  EXPECT_NEAR(std::sqrt(sum_of_squares / 20000.0), 5e-3, 1e-4);  // K/(d + d0); four standard errors
}

TEST(RunCommand, ABrokenSampleLatchesZeroForceAndExitsThreeWithTheCauseRecorded) {
  const Folder folder;
  record_broken_hand(folder / "broken.h5", 200, 100);
  const Outcome outcome =
      run(folder, {"run", "--device", "replay:broken.h5", "--offline", "--headless", "--record", "run.h5"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  ASSERT_EQ(run(folder, {"export", "run.h5", "--csv", "run.csv"}).exit_code, 0);
  const record::Recording recording = record::read_recording(folder / "run.h5");
  ASSERT_EQ(recording.rows.size(), 200U);  // the run continued to its end
  for (const haptics::TickRow& row : recording.rows) {
    EXPECT_EQ(row.fault != 0, row.tick >= 100) << row.tick;
    if (row.tick >= 110) {
      EXPECT_EQ(row.force[0], 0.0);
      EXPECT_EQ(row.force[1], 0.0);
      EXPECT_EQ(row.force[2], 0.0);
    }
  }
  EXPECT_NE(text_of(folder / "run.csv").find("not-finite"), std::string::npos);
}

/// Messages of a run about the cache, and the number of cached files.
struct CacheUse {
  std::string words;
  std::size_t files = 0;
};

CacheUse run_with_cache(const Folder& folder, const std::string& setting,
                        std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"run",      "--organ",   "ball",         "--tool",
                                    "sphere:3", "--offline", "--duration-s", "0.01"};
  words.insert(words.end(), more.begin(), more.end());
  const Outcome outcome =
      run(folder, words,
          {{"PALPATE_CACHE", setting}, {"XDG_CACHE_HOME", folder / "cache"}, {"PALPATE_LOG", "debug"}});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  std::error_code absent;
  return {outcome.err, static_cast<std::size_t>(
                           std::distance(fs::directory_iterator(folder / "cache/palpate", absent), {}))};
}

TEST(OrganCache, ServesTheSecondRunUnlessItIsTurnedOff) {
  const Folder folder;
  EXPECT_EQ(run_with_cache(folder, "off").files, 0U);
  EXPECT_EQ(run_with_cache(folder, "on", {"--no-cache"}).files, 0U);
  const CacheUse first = run_with_cache(folder, "on");
  EXPECT_EQ(first.files, 1U);
  EXPECT_NE(first.words.find("does not have this organ"), std::string::npos) << first.words;
  const CacheUse second = run_with_cache(folder, "on");
  EXPECT_EQ(second.files, 1U);
  EXPECT_NE(second.words.find("taken from the cache"), std::string::npos) << second.words;
  EXPECT_EQ(run_with_cache(folder, "on", {"--no-cache"}).words.find("cache"), std::string::npos);
}

}  // namespace
}  // namespace palpate::tests
