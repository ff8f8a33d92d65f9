#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/text.h"
#include "io/record/test/sample_recording.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

using ::testing::StartsWith;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

std::vector<std::vector<std::string>> exported(const std::vector<haptics::TickRow>& rows) {
  const TemporaryFolder folder;
  Recording recording;
  recording.rows = rows;
  export_csv(recording, folder / "a.csv");
  std::vector<std::vector<std::string>> lines;
  std::istringstream in(contents(folder / "a.csv"));
  for (std::string line; std::getline(in, line);) lines.push_back(split(line));
  return lines;
}

TEST(Export, ColumnsHaveTheDocumentedOrderThenTheDevices) {
  const TemporaryFolder folder;
  export_csv(Recording{}, folder / "a.csv");
  EXPECT_EQ(contents(folder / "a.csv"),
            "tick,time_s,hand,phase,distance_m,depth_m,cutoff_layer,saturated,tissue_force_N,noise_force_N,"
            "friction_N,force_x_N,force_y_N,force_z_N,torque_x_N_m,torque_y_N_m,torque_z_N_m,gripper_force_N,"
            "tool_x_m,tool_y_m,tool_z_m,tool_qw,tool_qx,tool_qy,tool_qz,gripper,contact_x_m,contact_y_m,"
            "contact_z_m,normal_x,normal_y,normal_z,tick_ns,late_ns,status,fault,energy_J,engagement,"
            "device_x_m,device_y_m,device_z_m,device_qw,device_qx,device_qy,device_qz,device_vx_m_per_s,"
            "device_vy_m_per_s,device_vz_m_per_s,device_gripper,device_age_s,device_buttons,device_valid,"
            "device_fault,events,stimulus_force_N,layer,inserted_mm,slip,tip_force_N\n");
}

TEST(Export, EveryValueStandsInItsColumnInShortestForm) {
  const haptics::TickRow row = sample_row(4, 1);
  const auto lines = exported({row});
  ASSERT_EQ(lines.size(), 2U);
  std::vector<std::string> want = {"4",
                                   "0.004",
                                   "1",
                                   "press",
                                   shortest(row.distance),
                                   shortest(row.depth),
                                   "4",
                                   "0",
                                   shortest(row.tissue_force),
                                   shortest(row.noise_force),
                                   shortest(row.friction)};
  for (const double v : row.force) want.push_back(shortest(v));
  for (const double v : row.torque) want.push_back(shortest(v));
  want.push_back(shortest(row.gripper_force));
  for (const double v : row.tool) want.push_back(shortest(v));
  for (const double v : row.tool_q) want.push_back(shortest(v));
  want.push_back(shortest(row.gripper));
  for (const double v : row.contact) want.push_back(shortest(v));
  for (const double v : row.normal) want.push_back(shortest(v));
  for (const char* text : {"1004", "-4", "4", "device"}) want.emplace_back(text);
  want.push_back(shortest(row.energy));
  want.push_back(shortest(row.engagement));
  for (const double v : row.device) want.push_back(shortest(v));
  for (const double v : row.device_q) want.push_back(shortest(v));
  for (const double v : row.device_velocity) want.push_back(shortest(v));
  want.push_back(shortest(row.device_gripper));
  want.push_back(shortest(row.device_age));
  for (const char* text : {"12", "1", "2", "1"}) want.emplace_back(text);
  want.push_back(shortest(row.stimulus_force));
  for (const char* text : {"0", "0", "0", "0"}) want.emplace_back(text);  // no needle
  EXPECT_EQ(lines[1], want);
}

TEST(Export, PhaseAndFaultAreWords) {
  std::vector<haptics::TickRow> rows(6);
  for (std::uint32_t i = 0; i < 6; ++i) {
    rows[i].phase = i % 3;
    rows[i].fault = i;
  }
  const auto lines = exported(rows);
  EXPECT_EQ(lines[1][3], "approach");
  EXPECT_EQ(lines[2][3], "press");
  EXPECT_EQ(lines[3][3], "pull");
  EXPECT_EQ(lines[1][35], "0");
  EXPECT_EQ(lines[2][35], "not-finite");
  EXPECT_EQ(lines[3][35], "device");
  EXPECT_EQ(lines[4][35], "stale-sample");
  EXPECT_EQ(lines[5][35], "stalled-loop");
  EXPECT_EQ(lines[6][35], "force-off");
}

TEST(Export, ManyRowsAllArriveAndNotANumberIsAWord) {
  std::vector<haptics::TickRow> rows;
  for (std::uint64_t tick = 0; tick < 10000; ++tick) rows.push_back(sample_row(tick, 0));
  rows.back().depth = -std::numeric_limits<double>::quiet_NaN();
  const auto lines = exported(rows);
  ASSERT_EQ(lines.size(), 10001U);
  for (std::size_t i = 0; i < rows.size(); ++i) ASSERT_EQ(lines[i + 1][0], std::to_string(i));
  EXPECT_EQ(lines.back()[5], "nan");
}

TEST(Export, FileThatCannotBeWrittenIsNamed) {
  try {
    export_csv(Recording{}, "/none/a.csv");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), StartsWith("/none/a.csv: cannot be written"));
  }
}

TEST(Export, FullDiskIsReported) {
  Recording recording;
  recording.rows.resize(10000);
  EXPECT_THROW(export_csv(recording, "/dev/full"), InputError);
}

}  // namespace
}  // namespace palpate::record
