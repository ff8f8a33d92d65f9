#include "fit/report/sweep_figure.h"

#include <filesystem>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/scene_keys.h"
#include "io/system/test/temporary_folder.h"

namespace palpate::report {
namespace {

using palpate::test::TemporaryFolder;

/// Two runs with all quantities equal to `value`.
sweep::SweepResult sweep_of(double value) {
  sweep::SweepResult sweep;
  sweep.axes = {{"tissue.k1_N_per_m", scene::KeyType::kNumber, {"10", "20"}}};
  for (const std::string& setting : sweep.axes.front().values) {
    sweep::SweepRow& row = sweep.rows.emplace_back();
    row.settings = {setting};
    row.quantities.assign(session::kRunQuantities.size(), value);
    row.ended = "done";
  }
  return sweep;
}

TEST(StudyFigure, DrawsQuantitiesThatAreAllNegative) {
  const TemporaryFolder folder;
  EXPECT_EQ(draw_sweep(sweep_of(-2.0), folder.path() / "a.svg"), "");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "a.svg"));
}

TEST(StudyFigure, ReportsInOneLineWhyThereIsNone) {
  const TemporaryFolder folder;
  const std::string why =
      draw_sweep(sweep_of(std::numeric_limits<double>::quiet_NaN()), folder.path() / "a.svg");
  EXPECT_THAT(why, testing::HasSubstr("gnuplot"));
  EXPECT_THAT(why, testing::Not(testing::HasSubstr("\n")));
}

}  // namespace
}  // namespace palpate::report
