// `palpate fit`: its results, files and rejected arguments.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/scene.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using testing::HasSubstr;

using nlohmann::json;
using ::testing::Contains;
using ::testing::DoubleNear;

/// 40 points to 10 mm of a spring with 20 N/m, which becomes 200 N/m at 5 mm.
void write_curve(const Folder& folder, const std::string& name) {
  std::ofstream out(folder / name);
  out << "displacement_mm,force_N\n";
  for (int i = 1; i <= 40; ++i) {
    const double depth = 0.25 * i;
    out << depth << ',' << 0.02 * std::min(depth, 5.0) + 0.2 * std::max(depth - 5.0, 0.0) << '\n';
  }
}

TEST(FitCommand, PrintsTheFieldsWritesTheTissueAndTheReport) {
  const Folder folder;
  write_curve(folder, "a.csv");
  const Outcome outcome = run(folder, {"fit", "a.csv", "--law", "layered", "--out", "a.toml", "--report",
                                       "page", "--bootstrap", "2", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  const json& specimen = answer["specimens"][0];
  EXPECT_EQ(specimen["name"], "a");
  EXPECT_EQ(specimen["law"], "layered");
  EXPECT_EQ(specimen["layers"], 6);
  EXPECT_EQ(specimen["points"], 40);
  EXPECT_LT(specimen["nrmse"], 1e-3);
  EXPECT_NEAR(specimen["parameters"]["k1_N_per_m"], 20.0, 0.5);
  EXPECT_NEAR(specimen["parameters"]["limit_mm"], 5.0, 0.1);
  EXPECT_TRUE(specimen["parameters"]["relaxation"].empty());
  for (const char* name : {"k1_N_per_m", "beta", "q", "limit_mm", "offset_mm", "offset_N"}) {
    EXPECT_EQ(specimen["interval_95"][name].size(), 2U) << name;
    EXPECT_EQ(specimen["bootstrap_95"][name].size(), 2U) << name;
  }
  EXPECT_EQ(answer["pooled"]["parameters"]["beta"], specimen["parameters"]["beta"]);
  EXPECT_EQ(scene::load_tissue(folder / "a.toml").name, "a");
  EXPECT_NE(text_of(folder / "page/report.html").find("95 % interval"), std::string::npos);
}

TEST(FitCommand, SweepsAParameterIntoJsonCsvAndReport) {
  const Folder folder;
  write_curve(folder, "a.csv");
  const Outcome outcome = run(folder, {"fit", "a.csv", "--sweep", "limit_mm=4:8:5", "--sweep-csv", "s.csv",
                                       "--report", "page", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json sweep = json::parse(outcome.out)["sweeps"][0];
  EXPECT_EQ(sweep["specimen"], "a");
  EXPECT_EQ(sweep["parameter"], "limit_mm");
  EXPECT_NEAR(sweep["best"], 5.0, 0.1);
  EXPECT_FALSE(sweep["open_below"]);
  EXPECT_FALSE(sweep["open_above"]);
  std::vector<double> values;
  for (const json& point : sweep["points"]) values.push_back(point["value"].get<double>());
  EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
  for (int i = 0; i < 5; ++i)
    EXPECT_THAT(values, Contains(DoubleNear(4.0 * std::pow(2.0, 0.25 * i), 1e-9))) << "asked for";
  EXPECT_THAT(values, Contains(DoubleNear(sweep["best"].get<double>(), 1e-9))) << "the fit's own";
  const json& last = sweep["points"].back();
  EXPECT_NEAR(last["value"], 8.0, 1e-9);
  EXPECT_NEAR(last["parameters"]["limit_mm"], 8.0, 1e-9);
  EXPECT_GT(last["nrmse"], sweep["best_nrmse"]);
  EXPECT_FALSE(last["within_95"]);
  EXPECT_GT(last["deviance"], 0.0);
  const std::string csv = text_of(folder / "s.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "specimen,parameter,value,nrmse,deviance,within_95,k1_N_per_m,beta,q,limit_mm");
  EXPECT_EQ(lines(csv), 1 + values.size());
  EXPECT_NE(text_of(folder / "page/report.html").find("Sweeps"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "page/sweep-1.svg"));
}

TEST(FitCommand, SaysNothingOfItsLibrariesErrorsFarFromTheBest) {
  const Folder folder;
  std::ofstream bent(folder / "bent.csv");  // two springs, 20 and then 100 N/m
  bent << "displacement_mm,force_N\n";
  for (int i = 0; i <= 40; ++i) {
    const double mm = 0.25 * i;
    bent << mm << ',' << 1e-3 * (20.0 * std::min(mm, 5.0) + 100.0 * std::max(mm - 5.0, 0.0)) << '\n';
  }
  bent.close();
  const Outcome outcome =
      run(folder, {"fit", "bent.csv", "--law", "smooth", "--sweep", "beta=0.001:100:41", "--json"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
}

/// A map of 5 x 5 probes 8 mm apart; above the lump at the middle the force is twice as large.
std::string small_map() {
  std::string text = "probe,x_mm,y_mm,z_mm,depth_mm,force_N\n";
  for (int probe = 0; probe < 25; ++probe) {
    for (int step = 1; step <= 6; ++step) {
      const double depth = 0.5 * step;
      const double x = 8.0 * (probe % 5 - 2);
      const double y = 8.0 * (probe / 5 - 2);
      const double force = 0.03 * std::pow(depth, 1.5) * (1.0 + std::exp(-(x * x + y * y) / 40.0));
      text += std::to_string(probe) + ',' + std::to_string(x) + ',' + std::to_string(y) + ",0," +
              std::to_string(depth) + ',' + std::to_string(force) + '\n';
    }
  }
  return text;
}

TEST(FitCommand, FindsTheLumpOfAMapAndWritesItForAScene) {
  const Folder folder;
  std::ofstream(folder / "map.csv") << small_map();
  const Outcome outcome = run(folder, {"fit", "--map", "map.csv", "--radius-mm", "5", "--json", "--out",
                                       "lumps.toml", "--stiffness-map", "stiffness.csv"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json fit = json::parse(outcome.out);
  ASSERT_GE(fit["inclusions"].size(), 1U);
  EXPECT_NEAR(fit["inclusions"][0]["x_mm"]["value"].get<double>(), 0.0, 2.0);
  EXPECT_NEAR(fit["inclusions"][0]["y_mm"]["value"].get<double>(), 0.0, 2.0);
  std::ifstream scene(folder / "lumps.toml");
  const std::string text((std::istreambuf_iterator<char>(scene)), {});
  EXPECT_NE(text.find("[[organ.inclusion]]"), std::string::npos);
  std::ifstream map(folder / "stiffness.csv");
  std::string header;
  std::getline(map, header);
  EXPECT_EQ(header, "x_mm,y_mm,z_mm,factor");
}

/// 9 x 9 probes on the top face z = 0, `step` mm apart from (first, first), of tissue whose stiffness grows
/// along x.
std::string sloped_map(double first, double step) {
  std::string text = "probe,x_mm,y_mm,z_mm,nx,ny,nz,depth_mm,force_N\n";
  for (int probe = 0; probe < 81; ++probe) {
    const double x = first + step * (probe % 9);
    const double y = first + step * (probe / 9);
    for (int row = 0; row <= 5; ++row) {
      const double depth = 0.4 * row;
      const double factor = std::exp(0.7 * std::sin(0.3 * x) * std::cos(0.25 * y));
      text += std::to_string(probe) + ',' + std::to_string(x) + ',' + std::to_string(y) + ",0,0,0,1," +
              std::to_string(depth) + ',' + std::to_string(0.1 * factor * std::pow(depth + 0.2, 1.4)) + '\n';
    }
  }
  return text;
}

TEST(FitCommand, WhatAMapsFitWritesPredictsProbesBetweenThoseThatWereFitted) {
  const Folder folder;
  std::ofstream(folder / "map.csv") << sloped_map(-12.0, 3.0);
  std::ofstream(folder / "new.csv") << sloped_map(-10.5, 2.5);
  const Outcome fitted = run(folder, {"fit", "--map", "map.csv", "--radius-mm", "3", "--json",
                                      "--max-inclusions", "1", "--out", "lumps.toml"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"lumps-stiffness.csv", "lumps-tissue.toml",
                                                      "lumps.toml", "map.csv", "new.csv"}));
  const json held = json::parse(fitted.out)["held_out"];
  EXPECT_EQ(held["held_out_probes"], 40);
  EXPECT_LT(held["error"]["map"].get<double>(), held["error"]["tissue"].get<double>());
  const Outcome good = run(folder, {"validate", "--map", "new.csv", "--scene", "lumps.toml", "--json"});
  ASSERT_EQ(good.exit_code, 0) << good.err;
  const json map = json::parse(good.out)["map"];
  EXPECT_EQ(map["probes"], 81);
  EXPECT_LT(map["nrmse"].get<double>(), 0.04);
  EXPECT_EQ(map["probes_outside"], 0);
  EXPECT_EQ(run(folder, {"validate", "--map", "new.csv", "--scene", "lumps.toml", "--max-nrmse", "0.0001"})
                .exit_code,
            4);
}

TEST(FitCommand, ChecksNewProbesAsThoseOfTheFit) {
  const Folder folder;
  std::ofstream(folder / "map.csv") << sloped_map(-12.0, 3.0);
  std::string loops = "probe,x_mm,y_mm,z_mm,depth_mm,force_N\n";
  std::string pulling = loops;
  std::string deeper = loops;
  for (int probe = 0; probe < 9; ++probe) {
    const std::string place = std::to_string(probe) + ',' + std::to_string(3 * probe - 12) + ",0,0,";
    const auto add = [&place](std::string& to, double depth, double force) {
      to += place + std::to_string(depth) + ',' + std::to_string(force) + '\n';
    };
    const double factor = std::exp(0.7 * std::sin(0.3 * (3 * probe - 12)));
    for (int row = 0; row <= 20; ++row) {
      const double depth = 0.1 * row;
      const double force = 0.1 * factor * std::pow(depth + 0.2, 1.4);
      add(loops, depth, force);
      add(pulling, depth, force - 0.2);
      add(deeper, 2.0 * depth, force);
    }
    for (int row = 19; row >= 0; --row) add(loops, 0.1 * row, 0.0);
  }
  std::ofstream(folder / "loops.csv") << loops;
  std::ofstream(folder / "pulling.csv") << pulling;
  std::ofstream(folder / "deeper.csv") << deeper;
  ASSERT_EQ(run(folder, {"fit", "--map", "map.csv", "--radius-mm", "3", "--max-inclusions", "0", "--out",
                         "lumps.toml"})
                .exit_code,
            0);
  const auto validated = [&folder](const std::string& file) {
    return run(folder, {"validate", "--map", file, "--scene", "lumps.toml"});
  };
  const Outcome looped = validated("loops.csv");
  EXPECT_EQ(looped.exit_code, 0) << looped.err;
  EXPECT_THAT(looped.out, HasSubstr("9 probes, 189 rows"));
  EXPECT_THAT(looped.out, HasSubstr("180 rows are left out, of each probe the last whole loading stays"));
  const Outcome refused = validated("pulling.csv");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("no tissue pulls, so tare the sensor"));
  EXPECT_THAT(validated("deeper.csv").out, HasSubstr("90 rows are deeper than the fitted ones"));
}

TEST(FitCommand, ProbesInAnotherFrameAndFlagsWithoutEffectAreRefusedWithAMap) {
  const Folder folder;
  std::ofstream(folder / "map.csv") << small_map();
  std::ofstream(folder / "far.csv") << sloped_map(300.0, 3.0);
  ASSERT_EQ(run(folder, {"fit", "--map", "map.csv", "--radius-mm", "5", "--out", "lumps.toml"}).exit_code, 0);
  const auto refused = [&folder](std::vector<std::string> words, const std::string& why) {
    words.insert(words.begin(), "validate");
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
  };
  refused({"--map", "far.csv", "--scene", "lumps.toml"}, "must be in the frame of the fitted map");
  refused({"--map", "map.csv"}, "--scene: missing");
  refused({"--map", "map.csv", "--scene", "lumps.toml", "--tissue", "liver"},
          "--tissue: has no effect with --map");
  refused({"map.csv", "--tissue", "liver", "--scene", "lumps.toml"}, "--scene lumps.toml: needs --map");
  refused({"map.csv"}, "--tissue is required");
}

TEST(FitCommand, TheSceneOfAMapRunsOnAnOrganOfItsFrame) {
  const Folder folder;
  std::ofstream(folder / "map.csv") << small_map();
  ASSERT_EQ(run(folder, {"fit", "--map", "map.csv", "--radius-mm", "5", "--out", "lumps.toml"}).exit_code, 0);
  std::ofstream box(folder / "box.off");  // 60 x 60 x 40 mm, its top at z = 0
  box << "OFF\n8 12 0\n";
  for (int i = 0; i < 8; ++i)
    box << (i & 1 ? 30 : -30) << ' ' << (i & 2 ? 30 : -30) << ' ' << (i & 4 ? 0 : -40) << '\n';
  box << "3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 "
         "5\n3 3 7 5\n";
  box.close();
  const Outcome ran =
      run(folder, {"run", "lumps.toml", "--organ", "box.off", "--organ-unit", "mm", "--offline"});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
}

TEST(FitCommand, AMapNeedsTheBallsRadius) {
  const Folder folder;
  std::ofstream(folder / "map.csv") << small_map();
  const Outcome missing = run(folder, {"fit", "--map", "map.csv"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.err.find("--radius-mm: missing"), std::string::npos) << missing.err;
  EXPECT_EQ(run(folder, {"fit", "map.csv", "--radius-mm", "5"}).exit_code, 2);
}

TEST(FitCommand, AFlagWithoutEffectIsRefusedWithAndWithoutAMap) {
  const Folder folder;
  std::ofstream(folder / "map.csv") << small_map();
  write_curve(folder, "a.csv");
  const std::vector<std::vector<std::string>> for_curves = {
      {"--law", "smooth"}, {"--direction", "pull"}, {"--relaxation"}, {"--rate-Hz", "500"},
      {"--t1-us", "2"},    {"--bootstrap", "9"},    {"--seed", "2"},  {"--report", "page"},
      {"--sweep", "q"},    {"--sweep-csv", "q.csv"}};
  for (const std::vector<std::string>& flag : for_curves) {
    std::vector<std::string> words = {"fit", "--map", "map.csv", "--radius-mm", "5", "--out", "a.toml"};
    words.insert(words.end(), flag.begin(), flag.end());
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << flag.front();
    EXPECT_NE(outcome.err.find(flag.front() + ": has no effect with --map: leave it out"), std::string::npos)
        << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "a.toml"));
  }
  const Outcome without = run(folder, {"fit", "a.csv", "--max-inclusions", "2"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_NE(without.err.find("--max-inclusions: needs --map"), std::string::npos) << without.err;
}

// A bump that no law has: the fit leaves more than a fifth of the range of force.
TEST(FitCommand, WritesNoTissueFromAPoorFit) {
  const Folder folder;
  std::ofstream bump(folder / "bump.csv");
  bump << "displacement_mm,force_N\n";
  for (int i = 0; i < 30; ++i) bump << i << ',' << (i >= 15 && i < 20 ? 1.0 : 0.0) << '\n';
  bump.close();
  const Outcome outcome = run(folder, {"fit", "bump.csv", "--out", "bump.toml", "--report", "page"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--out bump.toml: not written: the fit of specimen bump has an error of"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(folder.names(), std::vector<std::string>{"bump.csv"});
  EXPECT_EQ(run(folder, {"fit", "bump.csv"}).exit_code, 0);
}

TEST(FitCommand, RefusesBadInputInOneLineAndWritesNothing) {
  const Folder folder;
  write_curve(folder, "a.csv");
  std::ofstream(folder / "bad.csv") << "displacement_mm,force_N\n1,nan\n";
  const std::vector<std::vector<std::string>> all = {
      {"fit", "a.csv", "bad.csv", "--out", "a.toml"},
      {"fit", "a.csv", "--law", "hertz", "--out", "a.toml"},
      {"fit", "a.csv", "--direction", "up", "--out", "a.toml"},
      {"fit", "a.csv", "--relaxation", "--out", "a.toml"},
      {"fit", "a.csv", "--bootstrap", "-1", "--out", "a.toml"},
      {"fit", "a.csv", "--sweep", "k=1:2", "--out", "a.toml"},
      {"fit", "a.csv", "--sweep", "q=1:0.5", "--out", "a.toml"},
      {"fit", "a.csv", "--sweep-csv", "s.csv", "--out", "a.toml"},
      {"fit", "none.csv", "--out", "a.toml"}};
  for (const std::vector<std::string>& words : all) {
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "a.toml"));
  }
}

}  // namespace
}  // namespace palpate::tests
