// `palpate fit --needle`: its results, files and rejected arguments.
#include <cmath>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/scene.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A needle that meets 1 N at the puncture after 10 mm, then 0.4 N and friction; held, and drawn out.
void write_insertion(const Folder& folder, const std::string& name, double out_to_mm) {
  std::ofstream out(folder / name);
  out << "time_s,displacement_mm,force_N\n";
  double time = 0.0;
  const auto row = [&](double depth, double force) {
    const double noise = 2e-3 * std::sin(37.0 * time * time);
    out << time << ',' << depth << ',' << force + noise << '\n';
    time += 0.01;
  };
  for (double depth = -1.0; depth < 25.0; depth += 0.02) {
    const double pressed = std::max(0.0, depth);
    const double cut = 0.4 + 0.02 * (depth - 4.0) + 0.6 * std::exp(-std::max(0.0, depth - 10.0) / 0.04);
    row(depth, depth < 10.0 ? 0.01 * pressed * pressed : cut);
  }
  for (int i = 0; i < 500; ++i) row(25.0, 0.5 + 0.3 * std::exp(-i / 100.0));
  for (double depth = 25.0; depth > out_to_mm; depth -= 0.02) {
    const double turned = 0.5 - 0.9 * std::min(1.0, (25.0 - depth) / 8.0);
    row(depth, turned * std::min(1.0, std::max(0.0, depth + 1.0) / 15.0));
  }
}

TEST(FitNeedle, PrintsLayersWritesATissueThatInsertTakesAndTheReport) {
  const Folder folder;
  write_insertion(folder, "in.csv", -1.0);
  const Outcome outcome =
      run(folder, {"fit", "--needle", "in.csv", "--out", "t.toml", "--report", "page", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  EXPECT_EQ(answer["layers"], 1);
  EXPECT_LT(answer["repeats"][0]["nrmse"], 0.06);
  EXPECT_NEAR(answer["repeats"][0]["punctures"][0]["depth_mm"].get<double>(), 10.0, 0.3);
  EXPECT_NEAR(answer["tissue_layers"][0]["puncture_force_N"]["value"].get<double>(), 1.0, 0.1);
  EXPECT_EQ(answer["tissue_layers"][0]["cutting_force_N"]["interval_95"].size(), 2U);
  const model::TissueParameters tissue = scene::load_tissue(folder / "t.toml");
  ASSERT_EQ(tissue.layers.size(), 1U);
  EXPECT_NEAR(tissue.layers[0].puncture_force, 1.0, 0.1);
  EXPECT_THAT(text_of(folder / "page/report.html"), HasSubstr("Force over depth of in"));
  const Outcome inserted = run(folder, {"run", "--task", "insert", "--organ", "box", "--tissue", "t.toml",
                                        "--tool", "needle", "--offline", "--duration-s", "0.1"});
  EXPECT_EQ(inserted.exit_code, 0) << inserted.err;
}

TEST(FitNeedle, ARecordWithoutAWithdrawalIsShownButGivesNoTissue) {
  const Folder folder;
  write_insertion(folder, "in.csv", 24.0);
  const Outcome shown = run(folder, {"fit", "--needle", "in.csv"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("cutting force and friction are not determined apart"));
  const Outcome refused = run(folder, {"fit", "--needle", "in.csv", "--out", "t.toml"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--out t.toml: not written: in: the needle is not drawn out"));
}

TEST(FitNeedle, FlagsOfOtherFitsAreRefused) {
  const Folder folder;
  write_insertion(folder, "in.csv", -1.0);
  const Outcome relaxation = run(folder, {"fit", "--needle", "in.csv", "--relaxation"});
  EXPECT_EQ(relaxation.exit_code, 2);
  EXPECT_THAT(relaxation.err, HasSubstr("--relaxation: has no effect with --needle: leave it out"));
  const Outcome both = run(folder, {"fit", "--needle", "--map", "in.csv"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("--map and --needle: leave one out"));
}

}  // namespace
}  // namespace palpate::tests
