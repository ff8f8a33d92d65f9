#include "palpate/tool_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

const double kHalfRoot = std::sqrt(0.5);

PathRow row(double time, const Vec3& position, double gripper = 0.0) {
  PathRow r;
  r.time = time;
  r.position = position;
  r.gripper = gripper;
  return r;
}

std::string path_error_in(const std::string& content) {
  const TemporaryFolder folder;
  const auto file = folder.write("way.csv", content);
  const std::string message = error_of([&] { (void)read_tool_path(file); });
  EXPECT_TRUE(message.starts_with(file.string())) << message;
  return message.starts_with(folder.path().string()) ? message.substr(folder.path().string().size() + 1)
                                                     : message;
}

TEST(ToolPath, InterpolatesPositionAndGripperLinearly) {
  const ToolPath path({row(1.0, {0.0, 1.0, 2.0}, 1.0), row(3.0, {4.0, 1.0, -2.0}, 0.0)});
  const PathRow quarter = path.at(1.5);
  EXPECT_EQ(quarter.time, 1.5);
  EXPECT_DOUBLE_EQ(quarter.position.x(), 1.0);
  EXPECT_DOUBLE_EQ(quarter.position.y(), 1.0);
  EXPECT_DOUBLE_EQ(quarter.position.z(), 1.0);
  EXPECT_DOUBLE_EQ(quarter.gripper, 0.75);
}

/// Random rows at uneven times.
ToolPath random_cubic(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> between(-1.0, 1.0);
  std::vector<PathRow> rows;
  double time = 0.0;
  for (int i = 0; i < 12; ++i) {
    rows.push_back(row(time, {between(random), between(random), i < 6 ? 0.1 * i : 0.5}));
    time += 0.02 + 0.01 * between(random);
  }
  return ToolPath(rows, false, PathInterpolation::kCubic);
}

TEST(ToolPath, ACubicMeetsItsRowsAndStaysBetweenNeighbours) {
  constexpr double kRounding = 1e-12;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const ToolPath path = random_cubic(seed);
    const std::vector<PathRow>& rows = path.rows();
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
      EXPECT_LT((path.at(rows[i].time).position - rows[i].position).norm(), kRounding);
      for (const double u : {0.1, 0.3, 0.5, 0.7, 0.9}) {
        const Vec3 between = path.at(rows[i].time + u * (rows[i + 1].time - rows[i].time)).position;
        for (int axis = 0; axis < 3; ++axis) {
          const auto [low, high] = std::minmax(rows[i].position[axis], rows[i + 1].position[axis]);
          EXPECT_GE(between[axis], low - kRounding) << seed;
          EXPECT_LE(between[axis], high + kRounding) << seed;
        }
      }
    }
  }
}

TEST(ToolPath, ACubicsVelocityIsContinuousAndItsPositionsDerivative) {
  constexpr double kStep = 1e-7;  // s
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const ToolPath path = random_cubic(seed);
    for (double time = -0.01; time < path.end_time() + 0.01; time += 0.0007) {
      const Vec3 slope = (path.at(time + kStep).position - path.at(time - kStep).position) / (2.0 * kStep);
      EXPECT_LT((path.velocity_at(time) - slope).norm(), 1e-3) << time;
    }
    for (const PathRow& at : path.rows()) {
      const Vec3 step = path.velocity_at(at.time + 1e-9) - path.velocity_at(at.time - 1e-9);
      EXPECT_LT(step.norm(), 1e-3) << at.time;
    }
  }
}

// The path starts and ends at rest, so only the inner segments are straight.
TEST(ToolPath, ACubicAtConstantSpeedIsTheStraightLine) {
  std::vector<PathRow> rows;
  for (int i = 0; i < 6; ++i) rows.push_back(row(0.1 * i, Vec3(1.0, -2.0, 3.0) * i));
  const ToolPath cubic(rows, false, PathInterpolation::kCubic);
  const ToolPath linear(rows);
  for (const double time : {0.1, 0.137, 0.2, 0.299, 0.35}) {
    EXPECT_LT((cubic.at(time).position - linear.at(time).position).norm(), 1e-12) << time;
  }
}

TEST(ToolPath, SlerpsTheRotationAtConstantSpeed) {
  PathRow turned = row(2.0, Vec3::Zero());
  turned.orientation = Quat(kHalfRoot, 0.0, 0.0, kHalfRoot);  // 90 degrees about z
  const ToolPath path({row(0.0, Vec3::Zero()), turned});
  const Quat third = path.at(2.0 / 3.0).orientation;  // 30 degrees
  EXPECT_NEAR(third.w(), std::cos(std::acos(-1.0) / 12.0), 1e-12);
  EXPECT_NEAR(third.z(), std::sin(std::acos(-1.0) / 12.0), 1e-12);
}

TEST(ToolPath, FindsTheRowOfEvenAndUnevenTimesAlike) {
  for (const bool even : {true, false}) {
    std::vector<PathRow> rows;
    for (int i = 0; i < 200; ++i) {
      const double time =
          even ? 0.3 + 0.005 * i : 0.3 + 0.1 * std::sqrt(static_cast<double>(i)) + 1e-4 * i * i;
      rows.push_back(row(time, {static_cast<double>(i), 0.0, 0.0}));
    }
    const ToolPath path(rows);
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
      EXPECT_EQ(path.at(rows[i].time).position.x(), static_cast<double>(i));
      const double middle = 0.5 * (rows[i].time + rows[i + 1].time);
      EXPECT_NEAR(path.at(middle).position.x(), static_cast<double>(i) + 0.5, 1e-9);
    }
  }
}

TEST(ToolPath, FindsTheRowWhereTimesLieNearerThanNumbersCanTell) {
  const ToolPath path(
      {row(-4e-320, {1.0, 0.0, 0.0}), row(0.0, {2.0, 0.0, 0.0}), row(4e-320, {3.0, 0.0, 0.0})});
  EXPECT_EQ(path.at(0.0).position.x(), 2.0);
  EXPECT_EQ(path.at(2e-320).position.x(), 2.5);
}

TEST(ToolPath, LongerThanANumberCanTellIsRefused) {
  EXPECT_THAT(error_of([] {
                ToolPath({row(-1.7e308, Vec3::Zero()), row(1.7e308, Vec3::Zero())});
              }),
              HasSubstr("time_s = -1.7e+308 to 1.7e+308: the path's length must be a finite number"));
}

TEST(ToolPath, HoldsBeforeTheFirstAndAfterTheLastRow) {
  const ToolPath path({row(1.0, {1.0, 0.0, 0.0}, 1.0), row(2.0, {2.0, 0.0, 0.0}, 0.0)});
  for (const double time : {-5.0, 0.0, 1.0}) EXPECT_EQ(path.at(time).position.x(), 1.0);
  for (const double time : {2.0, 2.5, 1e9}) EXPECT_EQ(path.at(time).position.x(), 2.0);
  EXPECT_EQ(path.at(0.5).gripper, 1.0);
  EXPECT_EQ(path.at(9.0).gripper, 0.0);
  EXPECT_EQ(path.end_time(), 2.0);
}

TEST(ToolPath, GivesEveryRowExactlyAtItsOwnTime) {
  std::vector<PathRow> rows;
  for (int i = 0; i < 50; ++i) {
    rows.push_back(row(0.1 * i, {0.3 * i, -0.7 * i, std::sqrt(i)}, (i % 7) / 6.0));
    rows.back().orientation = Quat(1.0, 0.1 * i, 0.2, -0.05 * i).normalized();
  }
  const ToolPath path(rows);
  for (const PathRow& want : rows) {
    const PathRow got = path.at(want.time);
    EXPECT_EQ(got.position, want.position);
    EXPECT_EQ(got.orientation.coeffs(), want.orientation.coeffs());
    EXPECT_EQ(got.gripper, want.gripper);
  }
}

TEST(ToolPath, OneRowHoldsForEver) {
  const ToolPath path({row(0.0, {1.0, 2.0, 3.0})});
  EXPECT_EQ(path.at(-1.0).position, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(path.at(1.0).position, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(path.velocity_at(0.0), Vec3(0.0, 0.0, 0.0));
}

TEST(ToolPath, VelocityIsTheSlopeOfThePieceAndZeroOutside) {
  const ToolPath path({row(0.0, {0.0, 0.0, 0.0}), row(2.0, {1.0, 0.0, 0.0}), row(3.0, {1.0, 0.0, -4.0})});
  EXPECT_EQ(path.velocity_at(-0.1), Vec3(0.0, 0.0, 0.0));
  EXPECT_EQ(path.velocity_at(1.0), Vec3(0.5, 0.0, 0.0));
  EXPECT_EQ(path.velocity_at(2.0), Vec3(0.0, 0.0, -4.0));
  EXPECT_EQ(path.velocity_at(3.0), Vec3(0.0, 0.0, 0.0));
}

TEST(ToolPath, RefusesNoRowsAndTimesThatDoNotRise) {
  EXPECT_THAT(error_of([] { (void)ToolPath({}); }), HasSubstr("at least one row"));
  EXPECT_THAT(error_of([] {
                (void)ToolPath({row(1.0, Vec3::Zero()), row(1.0, Vec3::Zero())});
              }),
              HasSubstr("time_s = 1: must be later"));
  EXPECT_THAT(
      error_of([] {
        (void)ToolPath({row(1.0, Vec3::Zero()), row(std::numeric_limits<double>::quiet_NaN(), Vec3::Zero())});
      }),
      HasSubstr("time_s = nan"));
}

TEST(ReadToolPath, ReadsColumnsByNameInAnyOrder) {
  const TemporaryFolder folder;
  const ToolPath path = read_tool_path(folder.write(
      "way.csv",
      "gripper,z_m, x_m "
      ",y_m,time_s,qz,qy,qx,qw\r\n1,0.3,0.1,0.2,0,0,0,0,2\r\n0.5,-3e-1,0.1,+0.2,1.5,1,0,0,1\r\n\r\n\n"));
  ASSERT_EQ(path.rows().size(), 2U);
  EXPECT_TRUE(path.has_gripper());
  const PathRow& first = path.rows()[0];
  EXPECT_EQ(first.time, 0.0);
  EXPECT_EQ(first.position, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(first.orientation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(first.gripper, 1.0);
  const PathRow& second = path.rows()[1];
  EXPECT_EQ(second.time, 1.5);
  EXPECT_EQ(second.position.z(), -0.3);
  EXPECT_DOUBLE_EQ(second.orientation.w(), kHalfRoot);
  EXPECT_DOUBLE_EQ(second.orientation.z(), kHalfRoot);
  EXPECT_EQ(second.gripper, 0.5);
}

TEST(ReadToolPath, DefaultsToUprightAndClosed) {
  const TemporaryFolder folder;
  const ToolPath path = read_tool_path(folder.write("way.csv", "time_s,x_m,y_m,z_m\n0,1,2,3"));
  EXPECT_FALSE(path.has_gripper());
  EXPECT_EQ(path.rows()[0].gripper, 0.0);
  EXPECT_EQ(path.rows()[0].orientation.w(), 1.0);
}

TEST(ReadToolPath, RefusesBadHeaders) {
  EXPECT_EQ(path_error_in("time_s,x_m,y_m\n"),
            "way.csv:1: z_m: missing, the header must name time_s, x_m, y_m and z_m");
  EXPECT_EQ(path_error_in("time_s,x_m,y_m,z_m,qw,qx,qz\n"),
            "way.csv:1: qy: missing, must be all of qw, qx, qy, qz or none");
}

TEST(ReadToolPath, RefusesBadNumbersWithLineColumnAndValue) {
  EXPECT_EQ(path_error_in("time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,1e999,0\n"),
            "way.csv:3: y_m = 1e999: must be a finite number");
}

TEST(ReadToolPath, RefusesAPathLongerThanANumberCanTell) {
  EXPECT_EQ(
      path_error_in("time_s,x_m,y_m,z_m\n-1.7e308,0,0,0\n1.7e308,0,0,0\n"),
      "way.csv:3: time_s = 1.7e+308: the path's length must be a finite number, it begins at -1.7e+308");
}

TEST(ReadToolPath, RefusesTimeThatRunsBackwardsOrStandsStill) {
  const std::string start = "time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0\n";
  EXPECT_EQ(path_error_in(start + "0.5,0,0,0\n"),
            "way.csv:4: time_s = 0.5: must be later than the row before, 1");
  EXPECT_EQ(path_error_in(start + "1,0,0,0\n"),
            "way.csv:4: time_s = 1: must be later than the row before, 1");
}

TEST(ReadToolPath, RefusesGripperAndRotationOutOfRange) {
  EXPECT_EQ(path_error_in("time_s,x_m,y_m,z_m,gripper\n0,0,0,0,1.1\n"),
            "way.csv:2: gripper = 1.1: must be 0 (closed) to 1 (open)");
  EXPECT_EQ(path_error_in("time_s,x_m,y_m,z_m,gripper\n0,0,0,0,-0.1\n"),
            "way.csv:2: gripper = -0.1: must be 0 (closed) to 1 (open)");
  EXPECT_EQ(path_error_in("time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,0,0,0,0\n"),
            "way.csv:2: qw,qx,qy,qz = 0,0,0,0: must be a rotation, not of length 0");
}

/// A robot's log of 4 s with ten rows a second: down by 20 mm at 10 mm/s, then at rest.
std::string log_with_times(double begin, double second) {
  std::string text = "time_s,x_m,y_m,z_m\n";
  for (int i = 0; i <= 40; ++i) {
    text += fmt::format("{:.3f},0,0,{:.4f}\n", begin + 0.1 * second * i, 0.06 - 0.001 * std::min(i, 20));
  }
  return text;
}

TEST(ReadToolPath, ALogThatCountsFromElsewhereBeginsAtItsFirstRowAndIsRemarkedOnce) {
  const TemporaryFolder folder;
  const ToolPath plain = read_tool_path(folder.write("plain.csv", log_with_times(0.0, 1.0)));
  for (const double begin : {1636500000.1, 100.0, -3.0}) {
    std::vector<std::string> remarks;
    const auto file = folder.write("log.csv", log_with_times(begin, 1.0));
    const ToolPath path = read_tool_path(file, PathInterpolation::kLinear, &remarks);
    EXPECT_EQ(path.rows().front().time, 0.0);
    EXPECT_NEAR(path.end_time(), 4.0, 1e-6);
    for (const double time : {0.0, 0.55, 1.95, 3.0}) {
      EXPECT_LT((path.at(time).position - plain.at(time).position).norm(), 1e-8) << begin;
    }
    ASSERT_EQ(remarks.size(), 1U);
    EXPECT_THAT(remarks[0], HasSubstr("log.csv: the path begins at "));
    EXPECT_THAT(remarks[0], HasSubstr(" s: its times are counted from its first row"));
  }
}

TEST(ReadToolPath, APathThatBeginsWithinTenSecondsHoldsItsFirstRowUntilThen) {
  const TemporaryFolder folder;
  std::vector<std::string> remarks;
  const ToolPath path =
      read_tool_path(folder.write("p.csv", log_with_times(2.0, 1.0)), PathInterpolation::kLinear, &remarks);
  EXPECT_EQ(path.rows().front().time, 2.0);
  EXPECT_EQ(path.at(1.0).position.z(), 0.06);
  EXPECT_TRUE(remarks.empty());
}

/// The remarks about a path file.
std::vector<std::string> path_remarks_in(const std::string& content) {
  const TemporaryFolder folder;
  std::vector<std::string> remarks;
  (void)read_tool_path(folder.write("way.csv", content), PathInterpolation::kLinear, &remarks);
  return remarks;
}

TEST(ReadToolPath, TimesThatCannotBeSecondsAreRefusedWithTheUnit) {
  EXPECT_EQ(path_error_in(log_with_times(1636500000100.0, 1e3)),
            "way.csv:2: time_s = 1636500000100: must be in seconds: is time_s in ms since 1970?");
  EXPECT_THAT(path_error_in(log_with_times(1.6365e15, 1e6)), HasSubstr("is time_s in us since 1970?"));
  EXPECT_THAT(path_error_in(log_with_times(1.6365e18, 1e9)), HasSubstr("is time_s in ns since 1970?"));
  EXPECT_THAT(path_error_in(log_with_times(0.0, 1e9)),
              HasSubstr("way.csv: time_s: the path is 4e+09 s long, must be at most 1e+06 s"));
  EXPECT_THAT(path_error_in("time_s,x_m,y_m,z_m\n0,0,0,0\n1636500000,0,0,0\n"), HasSubstr("without a jump?"));
}

TEST(ReadToolPath, ALogWhoseTimesMayBeMillisecondsIsQuestioned) {
  EXPECT_THAT(
      path_remarks_in(log_with_times(0.0, 1e3)),
      ElementsAre(HasSubstr("way.csv: time_s: the rows are 100 s apart, the tool moves at most 0.01 mm/s: is "
                            "time_s in ms? (the motion would reach 10 mm/s)")));
  EXPECT_THAT(path_remarks_in(log_with_times(0.0, 1e5)), ElementsAre(HasSubstr("rows are 1e+04 s apart")));
  for (const int rows_per_second : {50, 1000}) {
    std::string log = "time_s,x_m,y_m,z_m\n";  // at 200 mm/s, in ms
    for (int i = 0; i <= 50; ++i) {
      log += fmt::format("{},0,0,{}\n", 1000.0 * i / rows_per_second, 0.2 * i / rows_per_second);
    }
    EXPECT_THAT(path_remarks_in(log), ElementsAre(HasSubstr("is time_s in ms? (the motion would reach 200")));
  }
}

// Eleven rows a tenth of a second apart, with a pause after the sixth.
std::string log_with_pause(double pause) {
  std::string log = "time_s,x_m,y_m,z_m\n";
  for (int i = 0; i <= 10; ++i)
    log += fmt::format("{},0,0,{}\n", 0.1 * i + (i > 5 ? pause : 0.0), 0.06 - 0.001 * i);
  return log;
}

TEST(ReadToolPath, AFarLongerPauseThanBetweenTheOtherRowsIsQuestioned) {
  EXPECT_THAT(
      path_remarks_in(log_with_pause(1e5)),
      ElementsAre(HasSubstr("way.csv: time_s: rows 6 and 7 are 1e+05 s apart, the others 0.1 s: are these "
                            "two recordings?")));
  EXPECT_THAT(path_remarks_in(log_with_pause(9.0)), testing::IsEmpty());
}

TEST(ReadToolPath, AToolThatIsFasterThanAnyHandIsQuestionedWithItsRows) {
  std::string log = "time_s,x_m,y_m,z_m\n";
  for (int i = 0; i <= 10; ++i) log += fmt::format("{},0,0,{}\n", 0.01 * i, i < 5 ? 0.06 : 2.06);
  EXPECT_THAT(
      path_remarks_in(log),
      ElementsAre(HasSubstr("way.csv: the tool moves at 200 m/s between rows 5 and 6: is time_s in days, as "
                            "Excel counts, or is a row wrong?")));
}

TEST(ReadToolPath, AStaircaseOfStressRelaxationIsTaken) {
  const std::string stairs =
      "time_s,x_m,y_m,z_m\n0,0,0,0.06\n30,0,0,0.05\n330,0,0,0.05\n360,0,0,0.04\n660,0,0,0.04\n"
      "690,0,0,0.03\n990,0,0,0.03\n1020,0,0,0.02\n";
  const TemporaryFolder folder;
  EXPECT_EQ(read_tool_path(folder.write("p.csv", stairs)).end_time(), 1020.0);
  EXPECT_THAT(path_remarks_in(stairs),
              ElementsAre(HasSubstr("the tool moves at most 0.333 mm/s: is time_s")));
}

TEST(ReadToolPath, SeveralHandsCountFromTheEarliestOfTheirFirstRows) {
  const TemporaryFolder folder;
  const auto file = folder.write("second.csv", log_with_times(112.0, 1.0));
  EXPECT_EQ(first_path_time(file), 112.0);
  const auto path_from = [&file](double earliest, std::vector<std::string>& remarks) {
    return read_tool_path(file, PathInterpolation::kLinear, &remarks, earliest);
  };
  std::vector<std::string> shifted;
  EXPECT_EQ(path_from(100.0, shifted).rows().front().time, 12.0);
  EXPECT_THAT(shifted,
              ElementsAre(HasSubstr("the path begins at 112 s: its times are counted from 100 s, the "
                                    "first row of another hand's path: the tool rests for 12 s")));
  std::vector<std::string> resting;
  EXPECT_EQ(path_from(2.0, resting).rows().front().time, 112.0);
  EXPECT_THAT(resting, ElementsAre(HasSubstr("the path begins at 112 s: the tool rests for 112 s")));
}

TEST(ReadToolPath, OneRowIsTaken) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_tool_path(folder.write("p.csv", "time_s,x_m,y_m,z_m\n0,0,0,0.1\n")).rows().size(), 1U);
}

TEST(ReadToolPath, ASlowPathOfAFewRowsIsTaken) {
  const TemporaryFolder folder;
  const ToolPath path = read_tool_path(folder.write("p.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n3600,0,0,0.01\n"));
  EXPECT_EQ(path.end_time(), 3600.0);
}

TEST(ReadToolPath, APositionOutOfReachIsRefusedWithTheUnitThatWouldBeRight) {
  EXPECT_EQ(path_error_in("time_s,x_m,y_m,z_m\n0,0,-250,0\n"),
            "way.csv:2: y_m = -250: must be within 100 m: is y_m in mm? (it would be 0.25 m)");
}

TEST(ReadToolPath, TrajectoriesOfOtherProgramsAreRefusedByName) {
  const std::string tum =
      "1305031102.1758 1.3 0.6 1.6 0.6 0.6 -0.3 -0.3\n1305031102.2758 1.3 0.6 1.6 0.6 0.6 -0.3 -0.3\n";
  for (const std::string& text : {std::string(tum), "# timestamp tx ty tz qx qy qz qw\n" + tum,
                                  std::string("timestamp,tx,ty,tz,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n")}) {
    EXPECT_THAT(path_error_in(text), testing::AllOf(HasSubstr("this is a trajectory of TUM or evo"),
                                                    HasSubstr("qx,qy,qz,qw; grep -v '^[#t]' FILE | tr")));
  }
  EXPECT_THAT(path_error_in("1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("trajectory of KITTI"));
  EXPECT_THAT(
      path_error_in("#timestamp [ns],p_RS_R_x [m]\n1403636580838555648,4.6,-1.7,0.7,0.5,-0.1,-0.8,-0.1,0,0,0,"
                    "0,0,0,0,0,0\n"),
      HasSubstr("trajectory of EuRoC (times in ns"));
  // Poses of its motion capture: as many values as TUM's.
  EXPECT_THAT(
      path_error_in("#timestamp [ns],p_RS_R_x [m]\n1403636580838555648,4.6,-1.7,0.7,0.5,-0.1,-0.8,-0.1\n"),
      testing::AllOf(HasSubstr("trajectory of EuRoC (times in ns"), Not(HasSubstr("TUM or evo"))));
}

TEST(ToolPath, AFasterOneIsAtTheSamePlacesInLessTime) {
  for (const PathInterpolation how : {PathInterpolation::kLinear, PathInterpolation::kCubic}) {
    const ToolPath path({{0.0, {0, 0, 0}}, {1.0, {0, 0, 0.01}}, {3.0, {0.02, 0, 0.03}}}, true, how);
    const ToolPath faster = path.faster(2.0);
    EXPECT_EQ(faster.end_time(), 1.5);
    for (const double time : {0.0, 0.3, 0.5, 1.1, 2.0}) {
      EXPECT_LT((faster.at(time).position - path.at(2.0 * time).position).norm(), 1e-15) << time;
      EXPECT_LT((faster.velocity_at(time) - 2.0 * path.velocity_at(2.0 * time)).norm(), 1e-15) << time;
    }
  }
}

}  // namespace
}  // namespace palpate::scene
