#include <cmath>
#include <cstddef>
#include <functional>
#include <string>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/test/rejected_file.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/identify.h"

#include "fit/identify/plausible_specimen.h"

namespace palpate::identify {
namespace {

using palpate::test::TemporaryFolder;
using testing::HasSubstr;

/// Ten valid rows, then `more`.
std::string rows(const std::string& more = "") {
  std::string text;
  for (int i = 0; i < 10; ++i) text += std::to_string(i) + ",0." + std::to_string(i) + "\n";
  return text + more;
}

const std::string kHeader = "displacement_mm,force_N\n";

std::string error_in(const std::string& content) {
  return palpate::test::rejection_of("curve.csv", content,
                                     [](const auto& file) { (void)read_specimens(file); });
}

std::vector<Specimen> read(const std::string& content) {
  const TemporaryFolder folder;
  return read_specimens(folder.write("curve.csv", content));
}

TEST(ReadSpecimens, TakesMillimetresAndNewtonsAndTheFilesName) {
  const std::vector<Specimen> all = read(kHeader + rows());
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].name, "curve");
  ASSERT_EQ(all[0].size(), 10U);
  EXPECT_TRUE(all[0].time.empty());
  EXPECT_DOUBLE_EQ(all[0].displacement[3], 3e-3);
  EXPECT_DOUBLE_EQ(all[0].force[3], 0.3);
}

TEST(ReadSpecimens, SortsRowsToTheirSpecimens) {
  std::string text = "force_N,specimen,time_s,displacement_mm\n";
  for (int i = 0; i < 10; ++i) {
    const std::string n = std::to_string(i);
    for (const char* cells : {"#,left,#,#\n", "0.#,right,#,#\n"}) {
      for (const char* c = cells; *c != '\0'; ++c) text += *c == '#' ? n : std::string(1, *c);
    }
  }
  const std::vector<Specimen> all = read(text);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].name, "left");
  EXPECT_EQ(all[1].name, "right");
  EXPECT_EQ(all[1].time[9], 9.0);
  EXPECT_DOUBLE_EQ(all[1].force[9], 0.9);
}

TEST(ReadSpecimens, WantsForcesAndFiniteNumbers) {
  EXPECT_EQ(error_in(kHeader + rows("10,nan\n")),
            "curve.csv:12: force_N = nan: must be a finite number up to 1e9");
  EXPECT_THAT(error_in("displacement_mm,time_s\n" + rows()), HasSubstr("force_N: missing"));
}

// A rig that stops at its force limit leaves rows of zeros.
TEST(ReadSpecimens, LeavesOutRowsOfZerosAfterOthersAndCountsThem) {
  const std::vector<Specimen> all = read(kHeader + rows("0,0\n0,0\n10,1.0\n0,0\n"));
  ASSERT_EQ(all[0].size(), 11U);
  EXPECT_DOUBLE_EQ(all[0].displacement[0], 0.0);  // the first row is a measurement
  EXPECT_DOUBLE_EQ(all[0].force[10], 1.0);
  EXPECT_EQ(all[0].empty_rows, 3U);
}

TEST(ReadSpecimens, LeavesOutRowsOfZerosInTimeToo) {
  std::string text = "time_s,displacement_mm,force_N\n";
  for (int i = 0; i < 12; ++i) text += fmt::format("{0},{0},0.{0}\n", i);
  const std::vector<Specimen> all = read(text + "0,0,0\n0,0,0\n");
  EXPECT_EQ(all[0].size(), 12U);
  EXPECT_EQ(all[0].empty_rows, 2U);
}

// 17 rows of loading and unloading; the unloading force is 40 % of the loading force. Hysteresis is not
// noise.
TEST(ReadSpecimens, TakesALoadingAndUnloadingCurveOfFewRows) {
  std::string text = "time_s,displacement_mm,force_N\n";
  for (int i = 0; i < 17; ++i) {
    const double depth = i < 9 ? i : 16 - i;
    text += fmt::format("{},{},{}\n", i, depth + 0.01, 0.1 * depth * (i < 9 ? 1.0 : 0.4));
  }
  EXPECT_EQ(read(text)[0].size(), 17U);
}

TEST(ReadSpecimens, SaysThatAForceThatFallsLateFalls) {
  std::string text = kHeader;
  for (int i = 0; i < 101; ++i)
    text += fmt::format("{},{}\n", 0.1 * i, i > 90 ? -0.1 * (i - 90) : 0.001 * (i % 3));
  EXPECT_THAT(error_in(text), HasSubstr("force_N falls as displacement_mm rises"));
}

TEST(ReadSpecimens, RefusesAForceThatDoesNotRiseOutOfItsNoise) {
  std::string text = kHeader;
  const int noise[] = {3, -2, 5, 0, -4, 4, -1, 2, -3, 4, -5, 5, 1, -2, 3};
  for (int i = 0; i < 15; ++i) text += fmt::format("{},{}\n", i, 1.0 + 1e-3 * noise[i]);
  EXPECT_EQ(error_in(text),
            "curve.csv: force_N does not rise out of its noise anywhere: the tool seems not to have touched");
}

TEST(ReadSpecimens, RefusesTimeThatDoesNotRise) {
  std::string text = "time_s,displacement_mm,force_N\n0,0,0\n1,1,1\n";
  EXPECT_EQ(error_in(text + "1,2,2\n"), "curve.csv:4: time_s = 1: must be later than the row before, 1");
  EXPECT_THAT(error_in(text + "0.5,2,2\n"), HasSubstr("curve.csv:4: time_s = 0.5"));
}

TEST(ReadSpecimens, RefusesTooFewRowsAndWhatNeverChanges) {
  EXPECT_THAT(error_in(kHeader + "1,1\n"), HasSubstr("has 1 row, must have at least 10"));
  std::string same_force = kHeader;
  std::string same_place = kHeader;
  for (int i = 0; i < 12; ++i) {
    same_force += std::to_string(i) + ",0.5\n";
    same_place += "3," + std::to_string(i) + "\n";
  }
  EXPECT_THAT(error_in(same_force), HasSubstr("force_N is 0.5 in every row"));
  EXPECT_THAT(error_in(same_place), HasSubstr("displacement_mm is 3 in every row"));
}

/// A press of 12 mm in 4 s with 10 rows a second, 0.12 (exp(0.25 d) - 1) N, in multiples of the columns'
/// units.
std::string press_in(double second, double millimetre, double newton, double begin = 0.0) {
  std::string text = "time_s,displacement_mm,force_N\n";
  for (int i = 0; i <= 40; ++i) {
    const double depth = 0.3 * i;
    text += fmt::format("{:.4f},{},{}\n", begin + 0.1 * second * i, millimetre * depth,
                        newton * 0.12 * std::expm1(0.25 * depth));
  }
  return text;
}

TEST(ReadSpecimens, NumbersInAnotherUnitThanTheirColumnAreRefusedWithTheUnit) {
  EXPECT_THAT(error_in(press_in(1, 1, 1e3)),
              HasSubstr("curve.csv: force_N changes by 2290.26 N, must be at most 1000 N: "
                        "is force_N in mN or gf? (it would be 2.29 or 22.5 N)"));
  EXPECT_THAT(error_in(press_in(1, 1e3, 1)),
              HasSubstr("displacement_mm changes by 12000 mm, must be at most 500 mm: is "
                        "displacement_mm in um? (it would be 12 mm)"));
  EXPECT_THAT(error_in(press_in(1, 1e-3, 1)), HasSubstr("is displacement_mm in m? (it would be 12 mm)"));
}

TEST(ReadSpecimens, TimesInAnotherUnitThanSecondsAreRefusedWithTheUnit) {
  EXPECT_THAT(error_in(press_in(1e6, 1, 1)),
              HasSubstr("the rows are 1e+05 s apart, displacement_mm changes by at most "
                        "3e-06 mm/s: is time_s in us? (the motion would reach 3 mm/s)"));
  EXPECT_THAT(
      error_in(press_in(1e3, 1, 1, 1636500000100.0)),
      HasSubstr("curve.csv: time_s = 1636500000100: must be in seconds: is time_s in ms since 1970?"));
}

TEST(TimeUnitQuestion, AsksWhereAPressIsSlowerOrFasterThanUsual) {
  const auto question = [](double second) {
    Specimen press = read(press_in(1, 1, 1)).front();
    for (double& time : press.time) time *= second;
    return time_unit_question(press);
  };
  EXPECT_EQ(question(1.0), "");
  EXPECT_EQ(
      question(1e3),
      "time_s: the rows are 100 s apart, displacement_mm changes by at most 0.003 mm/s: is time_s in ms? "
      "(the motion would reach 3 mm/s)");
  EXPECT_THAT(question(1.0 / 86400.0), HasSubstr(": is time_s in hours or days, as Excel counts?"));
}

TEST(ExchangeQuestion, AsksWhereTheForceRisesEverMoreSlowly) {
  const Specimen press = read(press_in(1, 1, 1)).front();
  Specimen exchanged = press;
  for (std::size_t i = 0; i < press.size(); ++i) {
    exchanged.displacement[i] = 1e-3 * press.force[i];  // mm and N
    exchanged.force[i] = 1e3 * press.displacement[i];
  }
  EXPECT_EQ(exchange_question(press), "");
  EXPECT_THAT(exchange_question(exchanged), HasSubstr("are the two columns exchanged"));
  Specimen line = press;
  for (std::size_t i = 0; i < press.size(); ++i) line.force[i] = 100.0 * press.displacement[i];
  EXPECT_EQ(exchange_question(line), "");
}

TEST(ReadSpecimens, UnixTimeIsCountedFromTheFirstRow) {
  const std::vector<Specimen> all = read(press_in(1, 1, 1, 1636500000.1));
  EXPECT_EQ(all[0].time.front(), 0.0);
  EXPECT_NEAR(all[0].time.back(), 4.0, 1e-6);
  EXPECT_EQ(read(press_in(1, 1, 1, 100.0))[0].time.front(), 100.0) << "as written";
}

TEST(ReadSpecimens, RefusesSignsTheOtherWayRound) {
  std::string falling = kHeader;
  std::string negative = kHeader;
  for (int i = 0; i < 12; ++i) {
    falling += std::to_string(i) + ",-" + std::to_string(i) + "\n";
    negative += "-" + std::to_string(i) + ",-" + std::to_string(i) + "\n";
  }
  EXPECT_THAT(error_in(falling), HasSubstr("force_N falls as displacement_mm rises"));
  EXPECT_THAT(error_in(negative), HasSubstr("displacement_mm is never above 0"));
}

TEST(Thinned, AveragesNeighboursInDisplacementWithoutTimes) {
  const Specimen few =
      thinned(Specimen{"a", {}, {3.0, 1.0, 2.0, 4.0, 5.0}, {30.0, 10.0, 20.0, 40.0, 50.0}}, 3);
  EXPECT_EQ(few.displacement, (std::vector<double>{1.5, 3.5, 5.0}));
  EXPECT_EQ(few.force, (std::vector<double>{15.0, 35.0, 50.0}));
}

TEST(Thinned, AveragesNeighboursInTime) {
  const Specimen few =
      thinned(Specimen{"a", {0.0, 1.0, 2.0, 3.0}, {0.0, 0.0, 4.0, 4.0}, {1.0, 2.0, 3.0, 4.0}}, 2);
  EXPECT_EQ(few.time, (std::vector<double>{0.5, 2.5}));
  EXPECT_EQ(few.force, (std::vector<double>{1.5, 3.5}));
}

TEST(Thinned, WithTimesAveragesNoRowsAcrossAStep) {
  const Specimen few = thinned(
      Specimen{"a", {0.0, 1.0, 2.0, 3.0, 4.0}, {0.0, 4.0, 4.0, 4.0, 4.0}, {1.0, 2.0, 3.0, 4.0, 5.0}}, 3);
  EXPECT_EQ(few.displacement, (std::vector<double>{0.0, 4.0, 4.0}));
  EXPECT_EQ(few.time, (std::vector<double>{0.0, 1.5, 3.5}));
}

}  // namespace
}  // namespace palpate::identify
