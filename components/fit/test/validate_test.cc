// `palpate validate` as users call it.
#include <algorithm>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/scene.h"
#include "palpate/surface.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;

/// Writes 31 points of the built-in gallbladder's law to 7.5 mm: 18 N/m in its first layer of 8 mm.
void write_validation_curve(const Folder& folder, const std::string& name, double factor) {
  std::ofstream out(folder / name);
  out << "displacement_mm,force_N\n";
  for (int i = 0; i <= 30; ++i) out << 0.25 * i << ',' << factor * 0.018 * 0.25 * i << '\n';
}

/// Writes u(r) for falloff ratios, under a ball of 5 mm at depths of 1 and 4 mm.
void write_profiles(const Folder& folder, const std::string& name, const model::FalloffRatios& reach) {
  std::ofstream out(folder / name);
  out << "depth_mm,r_mm,u_mm\n";
  for (const double depth : {1.0, 4.0}) {
    const deform::DisplacementProfile profile(reach, depth * 1e-3, 5e-3, 5e-3);
    for (int i = 0; i <= 60; ++i)
      out << depth << ',' << 0.5 * i << ',' << profile.at(0.5e-3 * i) * 1e3 << '\n';
  }
}

TEST(ValidateCommand, FindsNoErrorInTheTissuesOwnForces) {
  const Folder folder;
  write_validation_curve(folder, "own.csv", 1.0);
  const Outcome outcome =
      run(folder, {"validate", "own.csv", "--tissue", "gallbladder", "--max-nrmse", "1e-6", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json set = json::parse(outcome.out)["sets"][0];
  EXPECT_EQ(set["name"], "own");
  EXPECT_EQ(set["unit"], "N");
  EXPECT_LT(set["rms"], 1e-6);
  EXPECT_LT(set["nrmse"], 1e-5);
  EXPECT_EQ(set["within_jnd"], 1.0);
  EXPECT_EQ(set["extrapolated_points"], 0);
}

// The tool touched at 0.2 mm and the sensor has an offset of 3 mN. With 0.018 N/mm the force is 0.6 mN too
// large everywhere beyond the first 0.2 mm of contact.
TEST(ValidateCommand, TellsTheErrorWithTheZerosAsGivenAndAsFitted) {
  const Folder folder;
  {
    std::ofstream out(folder / "off.csv");
    out << "displacement_mm,force_N\n";
    for (int i = 0; i <= 30; ++i)
      out << 0.25 * i << ',' << 0.003 + 0.018 * std::max(0.0, 0.25 * i - 0.2) << '\n';
  }
  const std::vector<std::string> words = {"validate", "off.csv", "--tissue", "gallbladder", "--json"};
  const auto set_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return json::parse(run(folder, all).out)["sets"][0];
  };
  const json given = set_of({});
  EXPECT_EQ(given["zeros"], "given");
  EXPECT_NEAR(given["max"], 0.003, 1e-9);
  EXPECT_EQ(given["zeros_given"]["nrmse"], given["nrmse"]);
  EXPECT_NEAR(given["zeros_fitted"]["first_contact_mm"], 0.2, 1e-3);
  EXPECT_NEAR(given["zeros_fitted"]["offset_N"], 0.003, 1e-5);
  EXPECT_FALSE(given["zeros_fitted"]["at_limit"]);
  const json fitted = set_of({"--zeros", "fitted"});
  EXPECT_EQ(fitted["zeros"], "fitted");
  EXPECT_LT(fitted["nrmse"], 1e-4);
  EXPECT_EQ(fitted["zeros_given"], given["zeros_given"]);
  const json stated = set_of({"--first-contact-mm", "0.2", "--offset-N", "0.003"});
  EXPECT_LT(stated["nrmse"], 1e-5);
  EXPECT_EQ(stated["zeros_given"]["first_contact_mm"], 0.2);
}

// Forces are 10 % too small, so the largest error is 0.1 x 0.018 x 7.5 N.
TEST(ValidateCommand, EndsWithFourWhenAGoalIsMissed) {
  const Folder folder;
  write_validation_curve(folder, "weak.csv", 0.9);
  const std::vector<std::string> words = {"validate", "weak.csv", "--tissue", "gallbladder", "--json"};
  EXPECT_EQ(run(folder, words).exit_code, 0);
  for (const auto& [flag, goal] : {std::pair{"--max-nrmse", "0.05"}, std::pair{"--max-error-N", "0.0134"}}) {
    std::vector<std::string> held = words;
    held.insert(held.end(), {flag, goal});
    const Outcome outcome = run(folder, held);
    EXPECT_EQ(outcome.exit_code, 4) << flag;
    const json answer = json::parse(outcome.out);
    EXPECT_EQ(answer["missed"].size(), 1U);
    EXPECT_NEAR(answer["sets"][0]["max"], 0.0135, 1e-9);
  }
}

TEST(ValidateCommand, ComparesWithTheLawsOfOthersAndSaysWhatEachCosts) {
  const Folder folder;
  write_validation_curve(folder, "own.csv", 1.0);
  const Outcome outcome = run(folder, {"validate", "own.csv", "--tissue", "gallbladder", "--against",
                                       "hertz,linear,exponential,mass-spring", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json set = json::parse(outcome.out)["sets"][0];
  EXPECT_GT(set["evaluation_ns"], 0.0);
  ASSERT_EQ(set["against"].size(), 4U);
  EXPECT_EQ(set["against"][1]["name"], "linear");
  EXPECT_LT(set["against"][1]["nrmse"], 1e-5);
  EXPECT_GT(set["against"][0]["nrmse"], 0.02);
  for (const json& rival : set["against"]) EXPECT_GT(rival["evaluation_ns"], 0.0);
}

TEST(ValidateCommand, FitsTheReachToProfilesAndWritesTissueAndReport) {
  const Folder folder;
  write_profiles(folder, "side.csv", {0.9, 0.5, 1.7, 0.6});
  const Outcome outcome = run(
      folder, {"validate", "--profile", "side.csv", "--tissue", "gallbladder", "--tip-radius-mm", "5",
               "--fit-reach", "--out", "found.toml", "--report", "page", "--max-nrmse", "0.005", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  EXPECT_EQ(answer["sets"].size(), 2U);
  EXPECT_EQ(answer["sets"][1]["depth_mm"], 4.0);
  EXPECT_NEAR(answer["reach"]["contact_ratio"], 0.9, 0.02);
  EXPECT_NEAR(scene::load_tissue(folder / "found.toml").reach.contact_ratio, 0.9, 0.02);
  EXPECT_NEAR(answer["reach"]["depth_exponent"], 0.5, 0.02);
  EXPECT_FALSE(answer["reach"]["depth_exponent_kept"]);
  EXPECT_EQ(answer["reach"]["at_limit"].size(), 5U);
  EXPECT_EQ(scene::load_tissue(folder / "found.toml").reach.depth_exponent,
            answer["reach"]["depth_exponent"]);
  const std::string page = text_of(folder / "page/report.html");
  EXPECT_NE(page.find("side at 4 mm"), std::string::npos);
  EXPECT_NE(page.find("data:image/svg+xml"), std::string::npos);
}

TEST(ValidateCommand, SaysThatOneDepthLeavesTheExponentAsItWas) {
  const Folder folder;
  write_profiles(folder, "side.csv", {0.9, 0.5, 1.7, 0.6});
  std::string text = text_of(folder / "side.csv");
  std::ofstream(folder / "one.csv") << text.substr(0, text.find("\n4,") + 1);
  const std::vector<std::string> words = {"validate", "--profile",       "one.csv", "--tissue",
                                          "liver",    "--tip-radius-mm", "5",       "--fit-reach"};
  EXPECT_NE(run(folder, words)
                .out.find("depth_exponent = 0.5, from the tissue: to determine it, measure at "
                          "depths that differ more\n"),
            std::string::npos);
}

// 0.09 N presses the gallbladder's first layer of 18 N/m by 5 mm.
TEST(ValidateCommand, TakesTheDepthFromTheLoad) {
  const Folder folder;
  std::ofstream(folder / "side.csv") << "r_mm,u_mm\n0,5\n1,4.8\n3,3\n9,1\n20,0.3\n";
  const Outcome outcome = run(folder, {"validate", "--profile", "side.csv", "--tissue", "gallbladder",
                                       "--tip-radius-mm", "5", "--force-N", "0.09", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NEAR(json::parse(outcome.out)["sets"][0]["depth_mm"], 5.0, 1e-9);
}

TEST(ValidateCommand, SaysWhichSurfaceUnderTheBallItCompared) {
  const Folder folder;
  std::ofstream(folder / "side.csv") << "r_mm,u_mm\n0,10\n1,9.8\n3,6\n9,1\n58,0\n";
  std::vector<std::string> call = {"validate",        "--profile", "side.csv",   "--tissue", "gallbladder",
                                   "--tip-radius-mm", "5",         "--depth-mm", "10"};
  EXPECT_THAT(run(folder, call).out, testing::Not(testing::HasSubstr("as drawn")));
  call.emplace_back("--as-drawn");
  EXPECT_THAT(run(folder, call).out, testing::HasSubstr("at 10 mm, as drawn on a flat surface: RMS"));
  call.insert(call.end(), {"--surface-radius-mm", "3"});
  EXPECT_THAT(run(folder, call).out, testing::HasSubstr("as drawn on a surface of 3 mm radius: RMS"));
  call.emplace_back("--json");
  const json set = json::parse(run(folder, call).out)["sets"][0];
  EXPECT_EQ(set["surface_radius_mm"], 3.0);
  EXPECT_LT(set["max"], 4.0);  // was 6.2, when the last point, on the far side, followed the ball upwards
}

TEST(ValidateCommand, RefusesBadInputInOneLineAndWritesNothing) {
  const Folder folder;
  write_validation_curve(folder, "own.csv", 1.0);
  std::ofstream(folder / "side.csv") << "r_mm,u_mm\n0,5\n1,4.8\n3,3\n9,1\n20,0.3\n";
  std::ofstream(folder / "back.csv") << "time_s,displacement_mm,force_N\n1,0,0\n0,1,1\n";
  const std::vector<std::vector<std::string>> all = {
      {},
      {"back.csv"},
      {"own.csv", "--against", "cubic"},
      {"own.csv", "--max-nrmse", "-1"},
      {"own.csv", "--law", "hertz"},
      {"own.csv", "--fit-reach"},
      {"own.csv", "--out", "a.toml"},
      {"own.csv", "--depth-mm", "5"},
      {"own.csv", "--zeros", "maybe"},
      {"own.csv", "--as-drawn"},
      {"--profile", "side.csv", "--tip-radius-mm", "5", "--depth-mm", "5", "--surface-radius-mm", "20"},
      {"--profile", "side.csv", "--tip-radius-mm", "5", "--depth-mm", "5", "--as-drawn", "--direction",
       "pull"},
      {"own.csv", "--zeros", "fitted", "--offset-N", "0"},
      {"--profile", "side.csv", "--tip-radius-mm", "5", "--depth-mm", "5", "--zeros", "fitted"},
      {"--profile", "side.csv", "--depth-mm", "5"},
      {"--profile", "side.csv", "--tip-radius-mm", "5"},
      {"--profile", "side.csv", "--tip-radius-mm", "5", "--depth-mm", "1"},
      {"--profile", "side.csv", "--tip-radius-mm", "5", "--depth-mm", "5,6"},
      {"--profile", "side.csv", "--tip-radius-mm", "5", "--force-N", "1e6"},
      {"--profile", "own.csv", "--tip-radius-mm", "5", "--depth-mm", "5"}};
  for (const std::vector<std::string>& more : all) {
    std::vector<std::string> words = {"validate", "--tissue", "gallbladder", "--report", "page"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out << testing::PrintToString(more);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "page"));
  }
}

}  // namespace
}  // namespace palpate::tests
