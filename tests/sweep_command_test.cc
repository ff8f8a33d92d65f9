// `palpate sweep` as its users see it.
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A ball over the box, with the path that a scene has by itself.
void write_scene(const Folder& folder, const std::string& more = "") {
  std::ofstream(folder / "press.toml") << "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:3\"\n" << more;
}

Outcome sweep(const Folder& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"sweep", "press.toml", "--duration-s", "1.5", "--out", "d"});
  return run(folder, words);
}

TEST(SweepCommand, WritesItsTablesFigureAndRecordAndPrintsThem) {
  const Folder folder;
  write_scene(folder);
  const Outcome outcome = sweep(folder, {"--set", "tissue.k1=10:20:2", "--set", "path.speed=1,2", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  EXPECT_EQ(answer["runs"], 4);
  EXPECT_EQ(answer["results"][3]["path.speed"], 2);
  EXPECT_EQ(answer["results"][1]["tissue.k1_N_per_m"], 10);
  EXPECT_GT(answer["results"][1]["peak_tissue_force_N"], answer["results"][0]["peak_tissue_force_N"])
      << "at 1.5 s the slow one is not down yet";
  for (const char* name : {"results.csv", "results.h5", "results.svg", "results.jsonl"}) {
    EXPECT_FALSE(text_of(folder / (std::string("d/") + name)).empty()) << name;
  }
  const Outcome again = sweep(folder, {"--set", "tissue.k1=10:20:2", "--set", "path.speed=1,2"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.err, HasSubstr("4 of 4 runs were finished before"));
  EXPECT_THAT(again.out,
              HasSubstr("press: 4 runs over tissue.k1_N_per_m (10 to 20, 2 values) and path.speed"));
}

TEST(SweepCommand, EndsWithTwoWhenARunFailedAndWithThreeAfterAFault) {
  const Folder folder;
  write_scene(folder);
  const Outcome failed = sweep(folder, {"--set", "organ.tissue=liver,lost.toml"});
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_THAT(failed.err, HasSubstr("1 of 2 runs failed, the first with organ.tissue = lost.toml: "));
  fs::remove_all(folder / "d");
  write_scene(
      folder,
      "[device]\nkind = \"emulated\"\n[[device.fault]]\nkind = \"nan\"\ntime_s = 1\nduration_s = 0.1\n");
  const Outcome fault = sweep(folder, {"--set", "tissue.k1=10,20"});
  EXPECT_EQ(fault.exit_code, 3) << fault.err;
  EXPECT_THAT(fault.err, HasSubstr("2 of 2 runs latched a fault"));
}

TEST(SweepCommand, RefusesBadInputInOneLineAndWritesNothing) {
  const Folder folder;
  write_scene(folder);
  for (const auto& [words, want] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--set", "tissue.k3=1"}, "--set tissue.k3: a scene has no such key"},
           {{"--set", "path.speed=1", "--set", "path.speed=2"},
            "--set path.speed=2: path.speed is set twice"},
           {{"--set", "path.speed=0:1:3"}, "--set path.speed = 0: must be a number >= 0.01 and <= 100"},
           {{"--set", "path.speed=1", "--organ", "lost.stl", "--organ-unit", "mm"}, "lost.stl"}}) {
    const Outcome outcome = sweep(folder, words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(want));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(folder / "d"));
}

}  // namespace
}  // namespace palpate::tests
