// `palpate generate` as users call it.
#include <algorithm>
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

Outcome generate(const Folder& folder, const std::vector<std::string>& more) {
  std::vector<std::string> words = {"generate", "--organ", "box", "--steps", "20"};
  if (std::find(more.begin(), more.end(), "--episodes") == more.end())
    words.insert(words.end(), {"--episodes", "2"});
  words.insert(words.end(), more.begin(), more.end());
  return run(folder, words);
}

TEST(GenerateCommand, WritesAFileOverAnOldOneAndPrintsASummary) {
  const Folder folder;
  std::ofstream(folder / "e.npz") << "old";
  const Outcome outcome = generate(folder, {"--out", "e.npz", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  EXPECT_EQ(answer["steps"], 40);
  EXPECT_EQ(answer["mean_reward"], -1.0);  // 20 steps of at most 0.5 mm do not cross the 10 mm of air
  EXPECT_THAT(text_of(folder / "e.npz").substr(0, 60), HasSubstr("observations.npy"));
  const Outcome words = generate(folder, {"--out", "e.h5", "--task", "hold", "--policy", "random"});
  EXPECT_THAT(words.out, HasSubstr("e.h5: 2 episodes of hold, 40 steps, mean reward of a step -1"));
}

TEST(GenerateCommand, WritesItsFileIntoAFolderThatItCreates) {
  const Folder folder;
  for (int time = 0; time < 2; ++time) {  // the second time it exists
    const Outcome outcome = generate(folder, {"--out", "runs/one"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("runs/one/episodes.h5: 2 episodes"));
    EXPECT_EQ(text_of(folder / "runs/one/episodes.h5").substr(1, 3), "HDF");
  }
}

TEST(GenerateCommand, RefusesBadInputInOneLineAndWritesNothing) {
  const Folder folder;
  for (const auto& [words, want] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--out", "e.csv"}, "e.csv: must end in .h5 (HDF5) or .npz (NumPy)"},
           {{"--out", "no/e.h5"}, "--out no/e.h5: "},
           {{"--out", "/proc/e"}, "/proc/e/episodes.h5: cannot be written: No such file or directory"},
           {{"--out", "runs", "--episodes", "0"}, "episodes = 0: must be 1 to 10000000"},
           {{"--out", "e.h5", "--task", "pull"}, "task: pull is not press, hold, search or insert"},
           {{"--out", "e.h5", "--policy", "best"}, "policy: best is not random or scripted"},
           {{"--out", "e.h5", "--episodes", "0"}, "episodes = 0: must be 1 to 10000000"},
           {{"--out", "e.h5", "--ticks", "1001"}, "ticks = 1001: must be 1 to 1000"},
           {{"--out", "e.h5", "--stiffness-factor", "2:1"}, "stiffness_factor = 2 to 1: must be ascending"},
           {{"--out", "e.h5", "--stiffness-factor", "1:x"}, "--stiffness-factor x: must be"},
           {{"--out", "e.h5", "--noise-gain-N-m", "0:1"}, "gain_N_m"},
           {{"--out", "e.h5", "--tissue", "lost.toml"}, "lost.toml"}}) {
    const Outcome outcome = generate(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << want;
    EXPECT_THAT(outcome.err, HasSubstr(want));
    EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(GenerateCommand, DoesNotOverwriteAFileOfItsScene) {
  const Folder folder;
  const std::string scene = "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:3\"\n";
  std::ofstream(folder / "press.h5") << scene;
  const Outcome outcome = run(folder, {"generate", "press.h5", "--out", "press.h5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--out"));
  EXPECT_EQ(text_of(folder / "press.h5"), scene);
}

}  // namespace
}  // namespace palpate::tests
