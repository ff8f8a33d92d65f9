// What a map of probes must be, and what is said of one that is odd.
#include "fit/identify/map_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

constexpr double kCheckedBall = 3e-3;  // m, radius

/// 16 probes, 3 mm apart on a plane, pressed 4 mm deep in 21 rows, with the force 0.02 N/mm^2 x depth^2.
std::vector<MapRow> checked_map() {
  std::vector<MapRow> rows;
  for (int probe = 0; probe < 16; ++probe) {
    for (int step = 0; step <= 20; ++step) {
      const double mm = 0.2 * step;
      rows.push_back({probe, Vec3(3e-3 * (probe % 4), 3e-3 * (probe / 4), 0.0), Vec3::UnitZ(), 1e-3 * mm,
                      0.02 * mm * mm});
    }
  }
  return rows;
}

/// The map after a change of each row.
std::vector<MapRow> changed_map(const std::function<void(MapRow&)>& change) {
  std::vector<MapRow> rows = checked_map();
  for (MapRow& row : rows) change(row);
  return rows;
}

std::vector<std::string> doubts_of(std::vector<MapRow> rows, double radius = kCheckedBall) {
  return check_map(rows, radius);
}

void expect_refused(std::vector<MapRow> rows, const std::string& why, double radius = kCheckedBall) {
  EXPECT_THAT([&] { (void)check_map(rows, radius); }, ThrowsMessage<InputError>(HasSubstr(why)));
}

TEST(CheckMap, LeavesAUsualMapAsItIs) {
  std::vector<MapRow> rows = checked_map();
  EXPECT_THAT(check_map(rows, kCheckedBall), IsEmpty());
  EXPECT_EQ(rows.size(), 16U * 21U);
}

TEST(CheckMap, RefusesARadiusInMetresThatNoBallHas) {
  expect_refused(checked_map(), "--radius-mm 3000: must be within 0.001 and 1000: is it in mm?", 3.0);
}

TEST(CheckMap, RefusesAProbeAtSeveralPlaces) {
  std::vector<MapRow> rows = checked_map();
  rows[25].point.x() += 6e-3;  // of probe 1
  expect_refused(rows, "probe 1: its rows are 6 mm apart");
}

TEST(CheckMap, RefusesForcesBelowZeroBeforeContact) {
  expect_refused(changed_map([](MapRow& row) { row.force -= 0.1; }), "the probes read -0.1 N at depth 0");
}

TEST(CheckMap, RefusesAForceThatNeverRises) {
  expect_refused(changed_map([](MapRow& row) { row.force = 0.01 * std::sin(1e6 * row.depth); }),
                 "force_N does not rise out of its noise with depth_mm");
}

TEST(CheckMap, SaysThatASensorMayNotBeTared) {
  EXPECT_THAT(doubts_of(changed_map([](MapRow& row) { row.force += 0.1; })),
              ElementsAre(HasSubstr("the probes read 0.1 N at depth 0, 31 % of the range of force")));
}

TEST(CheckMap, SaysThatASensorMayNotBeTaredFromTwoPercentOfTheRange) {
  EXPECT_THAT(doubts_of(changed_map([](MapRow& row) { row.force += 0.01; })),
              ElementsAre(HasSubstr("the probes read 0.01 N at depth 0, 3 % of the range of force")));
  EXPECT_THAT(doubts_of(changed_map([](MapRow& row) { row.force -= 0.01; })),
              ElementsAre(HasSubstr("the probes read -0.01 N at depth 0, and no tissue pulls")));
}

TEST(CheckMap, SaysThatDepthsCountFromAboveTheTissue) {
  const auto rows = changed_map([](MapRow& row) {
    const double mm = std::max(0.0, 1e3 * row.depth - 2.0);
    row.force = 0.02 * mm * mm;
  });
  EXPECT_THAT(doubts_of(rows), Contains(HasSubstr("count depth_mm from contact")));
}

TEST(CheckMap, AsksForTheUnitOfPlacesThatLieTooNearEachOther) {
  EXPECT_THAT(doubts_of(changed_map([](MapRow& row) { row.point *= 1e-3; })),
              ElementsAre(HasSubstr("all probes lie within 0.0127")));
}

TEST(CheckMap, AsksForTheUnitOfForces) {
  EXPECT_THAT(doubts_of(changed_map([](MapRow& row) { row.force *= 1e-3; })),
              ElementsAre(HasSubstr("force_N changes by 0.00032 N")));
}

TEST(CheckMap, KeepsTheLastLoadingOfEachProbeAndCountsTheOtherRows) {
  std::vector<MapRow> rows;
  for (int probe = 0; probe < 16; ++probe) {
    const std::vector<MapRow> all = checked_map();
    const std::vector<MapRow> loading(all.begin() + 21 * probe, all.begin() + 21 * (probe + 1));
    rows.insert(rows.end(), loading.begin(), loading.end());
    for (auto row = loading.rbegin() + 1; row != loading.rend(); ++row) {
      rows.push_back(*row);
      rows.back().force *= 0.5;  // unloading
    }
  }
  EXPECT_THAT(check_map(rows, kCheckedBall),
              ElementsAre(HasSubstr("depth_mm decreases within probes: 320 rows are "
                                    "left out")));
  ASSERT_EQ(rows.size(), 16U * 21U);
  for (const MapRow& row : rows) EXPECT_NEAR(row.force, 0.02e6 * row.depth * row.depth, 1e-9);
}

}  // namespace
}  // namespace palpate::identify
