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
