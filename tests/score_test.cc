// `palpate score` as users call it.
#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/builtin.h"
#include "palpate/mesh.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;

/// A scene with a stone hidden under the middle of a box, and a hand that presses there and marks the place.
void write_search(const Folder& folder) {
  const geometry::Bounds box = geometry::bounds(geometry::make_organ("box"));
  const Vec3 middle = box.middle();
  std::ofstream(folder / "s.toml") << "[scene]\ntask = \"palpate\"\n[organ]\nmesh = \"box\"\ntissue = "
                                      "\"liver\"\n[[organ.inclusion]]\npreset = "
                                      "\"stone\"\nvisible = false\n[tool]\nmesh = "
                                      "\"sphere:5\"\n[device]\nkind = \"scripted\"\npath = \"p.csv\"\n";
  std::ofstream path(folder / "p.csv");
  path << "time_s,x_m,y_m,z_m,buttons\n";
  const double touch = box.high.z() + 5e-3;  // the ball's centre
  for (const auto& [time, depth, buttons] :
       {std::tuple(0.0, -10e-3, 0), {1.0, 6e-3, 0}, {1.5, 6e-3, 1}, {1.6, 6e-3, 0}, {2.5, -10e-3, 0}}) {
    path << time << ',' << middle.x() << ',' << middle.y() << ',' << touch - depth << ',' << buttons << '\n';
  }
}

TEST(ScoreCommand, AMarkAboveAHiddenStoneFindsItInTheRunAndInItsRecording) {
  const Folder folder;
  write_search(folder);
  const Outcome played = run(folder, {"run", "s.toml", "--offline", "--record", "r.h5", "--json"});
  ASSERT_EQ(played.exit_code, 0) << played.err;
  const json of_the_run = json::parse(played.out)["score"];
  EXPECT_EQ(of_the_run["found"], 1);
  EXPECT_EQ(of_the_run["false"], 0);
  EXPECT_LT(of_the_run["error_mm"], 0.1);
  EXPECT_NEAR(of_the_run["time_s"].get<double>(), 1.5 - 10.0 / 16.0,
              2e-3);  // contact began after 10 of 16 mm

  const Outcome scored = run(folder, {"score", "r.h5", "--json", "--map", "felt.csv"});
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  EXPECT_EQ(json::parse(scored.out), of_the_run);
  std::ifstream map(folder / "felt.csv");
  std::string line;
  ASSERT_TRUE(std::getline(map, line));
  EXPECT_EQ(line, "x_mm,y_mm,z_mm,felt_factor,true_factor,depth_mm,force_N");
  double largest = 0.0;
  while (std::getline(map, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i < 4; ++i) std::getline(cells, cell, ',');
    if (!cell.empty()) largest = std::max(largest, std::stod(cell));
  }
  EXPECT_GT(largest, 1.1) << "the stone was felt";
  EXPECT_EQ(run(folder, {"replay", "r.h5", "--verify"}).exit_code, 0);
}

TEST(ScoreCommand, TheEpiduralEndsInItsTargetAndADeeperOneIsADuralPuncture) {
  const Folder folder;
  const std::string scene = std::string(PALPATE_EXAMPLES) + "/epidural.toml";
  const Outcome played = run(folder, {"run", scene, "--offline", "--record", "r.h5", "--json"});
  ASSERT_EQ(played.exit_code, 0) << played.err;
  const json score = json::parse(played.out)["score"];
  EXPECT_EQ(score["reached"], 1);
  EXPECT_EQ(score["forbidden"], json::array());
  EXPECT_EQ(score["crossed"].size(), 6U);
  EXPECT_EQ(score["crossed"][5], "epidural space");
  EXPECT_EQ(score["attempts"], 1);
  EXPECT_LT(score["overshoot_mm"], 5.0) << "the space is 5 mm thick";
  const Outcome scored = run(folder, {"score", "r.h5", "--json"});
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  EXPECT_EQ(json::parse(scored.out), score);
  const Outcome text = run(folder, {"score", "r.h5"});
  EXPECT_THAT(text.out, testing::HasSubstr("target reached      yes\n"));
  const Outcome map = run(folder, {"score", "r.h5", "--map", "m.csv"});
  EXPECT_EQ(map.exit_code, 2);
  EXPECT_THAT(map.err, testing::HasSubstr("--map: task insert has none: must be left out"));

  std::ofstream(folder / "deep.csv")
      << "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.1,0,1,0,0\n5,0,0,0.03,0,1,0,0\n";
  const Outcome deep = run(folder, {"run", scene, "--offline", "--device", "scripted:deep.csv", "--json"});
  ASSERT_EQ(deep.exit_code, 0) << deep.err;
  EXPECT_EQ(json::parse(deep.out)["score"]["forbidden"], json({"dura"}));
}

TEST(ScoreCommand, TheBiopsyReachesItsHiddenTargetForEverySeed) {
  const Folder folder;
  for (const char* seed : {"1", "2", "3"}) {
    const Outcome played = run(folder, {"run", std::string(PALPATE_EXAMPLES) + "/biopsy.toml", "--offline",
                                        "--seed", seed, "--json"});
    ASSERT_EQ(played.exit_code, 0) << played.err;
    const json score = json::parse(played.out)["score"];
    EXPECT_EQ(score["reached"], 1) << seed;
    EXPECT_EQ(score["closest_mm"], 0.0) << seed;
  }
}

TEST(ScoreCommand, RefusesWhatItCannotScoreOrWrite) {
  const Folder folder;
  EXPECT_EQ(run(folder, {"score", "no.h5"}).exit_code, 2);
  write_search(folder);
  ASSERT_EQ(run(folder, {"run", "s.toml", "--offline", "--record", "r.h5"}).exit_code, 0);
  const Outcome outcome = run(folder, {"score", "r.h5", "--map", "r.h5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("--map"));
}

}  // namespace
}  // namespace palpate::tests
