// `palpate sweep` as users call it.
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

/// Writes a scene with a ball above the box and the default path.
void write_scene(const Folder& folder, const std::string& more = "") {
  std::ofstream(folder / "press.toml") << "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:3\"\n" << more;
}

Outcome sweep(const Folder& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"sweep", "press.toml", "--out", "d"});
  if (std::find(words.begin(), words.end(), "--duration-s") == words.end())
    words.insert(words.end(), {"--duration-s", "1.5"});
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
  EXPECT_THAT(again.err, HasSubstr("4 of 4 runs were finished in an earlier sweep"));
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
           {{"--set", "path.speed=1", "--organ", "lost.stl", "--organ-unit", "mm"}, "lost.stl"},
           {{"--set", "path.speed=1", "--duration-s", "-1"}, "--duration-s = -1: must be > 0"},
           {{"--set", "path.speed=1", "--device", "mouse"}, "device mouse: a sweep needs"},
           {{"--set", "path.speed=0.1:1:1000", "--set", "tissue.k1=1:2:1000"},
            "--set: more than 100000 runs"}}) {
    const Outcome outcome = sweep(folder, words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(want));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(folder / "d"));
}

TEST(SweepCommand, AFlagMayNotReplaceASweptKey) {
  const Folder folder;
  write_scene(folder);
  std::ofstream(folder / "up.csv") << "time_s,x_m,y_m,z_m\n0,0,0,0.1\n1,0,0,0.1\n";
  for (const auto& [setting, flag] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"scene.task=press", {"--task", "press"}},
           {"organ.mesh=box", {"--organ", "box"}},
           {"organ.unit=mm", {"--organ", "box"}},
           {"organ.unit=mm", {"--organ-unit", "mm"}},
           {"organ.motion.phase=0,0.5", {"--organ-motion", "breathing"}},
           {"organ.tissue=liver,heart", {"--tissue", "liver"}},
           {"tool.tip_radius=1,2", {"--tool", "sphere:3"}},
           {"tool.unit=mm", {"--tool-unit", "mm"}},
           {"device.kind=scripted", {"--device", "emulated"}},
           {"device.path=up.csv", {"--device", "scripted"}},
           {"scene.rate_Hz=1000,2000", {"--rate-Hz", "1000"}},
           {"scene.seed=1,2", {"--seed", "1"}},
           {"noise.gain=0.1,0.2", {"--no-noise"}},
           {"device.fit=true,false", {"--fit-device"}}}) {
    std::vector<std::string> words = {"--set", setting};
    words.insert(words.end(), flag.begin(), flag.end());
    const Outcome outcome = sweep(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << setting;
    EXPECT_THAT(outcome.err, HasSubstr(": " + flag.front() + " sets it in every run")) << setting;
    EXPECT_THAT(outcome.err, HasSubstr("--set " + setting.substr(0, setting.find_first_of("=")))) << setting;
  }
  EXPECT_EQ(sweep(folder, {"--set", "tissue.k1=10,20", "--tissue", "liver"}).exit_code, 0);
}

TEST(SweepCommand, DoesNotOverwriteAFileThatItSweepsOver) {
  const Folder folder;
  write_scene(folder);
  const std::string path = "time_s,x_m,y_m,z_m\n0,0,0,0.1\n1,0,0,0.1\n";
  fs::create_directory(folder / "d");
  std::ofstream(folder / "up.csv") << path;
  std::ofstream(folder / "d/results.csv") << path;
  const Outcome outcome = sweep(folder, {"--set", "device.path=up.csv,d/results.csv"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--set device.path"));
  EXPECT_EQ(text_of(folder / "d/results.csv"), path);
}

TEST(SweepCommand, ItsJsonHasWholeNumbersTruthsAndNulls) {
  const Folder folder;
  write_scene(folder);
  const Outcome outcome =
      sweep(folder, {"--set", "scene.seed=9007199254740993", "--set", "noise.enabled=false", "--set",
                     "organ.tissue=liver,lost.toml", "--json"});
  for (const char* text : {"\"run\": 0,", "\"scene.seed\": 9007199254740993,", "\"noise.enabled\": false,",
                           "\"missed_contact\": false,", "\"faults\": 0,", "\"missed_contact\": null,",
                           "\"faults\": null,", "\"fault\": null,"}) {
    EXPECT_THAT(outcome.out, HasSubstr(text));
  }
}

TEST(SweepCommand, ReportsARecordThatCannotBeWrittenAnyMore) {
  const Folder folder;
  write_scene(folder);
  // 1024 bytes, enough for one or two runs of the record
  const std::string command =
      "cd '" + folder.path().string() + "' && trap '' XFSZ && ulimit -f 2 && '" + PALPATE_PROGRAM +
      "' sweep press.toml --duration-s 0.1 --set tissue.k1=10:20:5 --out d 2> err > out";
  EXPECT_NE(std::system(command.c_str()), 0);
  EXPECT_THAT(text_of(folder / "err"),
              HasSubstr("results.jsonl: cannot be written any more: File too large"));
}

}  // namespace
}  // namespace palpate::tests
