// Commanded forces and timed updates: recorded, read, exported and replayed bit for bit.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/contact/test/prepared_once.h"
#include "io/record/recording_writer.h"
#include "io/record/test/sample_recording.h"
#include "io/record/tick_columns.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "run/realtime/loop.h"

namespace palpate::record {
namespace {

using contact::test::prepared_once;

using haptics::LiveNoise;
using haptics::LiveStimulus;
using ::testing::ElementsAre;

constexpr double kProbeRadius = 3e-3;  // m

scene::Scene block_and_probe() {
  scene::Scene scene;
  scene.name = "block and probe";
  scene.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  scene.organ_pose.position = Vec3(0, 0, -0.02);
  scene.tissue = model::tissue_preset("gallbladder");
  scene.tools.push_back(
      {"ball", {{.name = "ball", .mesh = geometry::make_ball(kProbeRadius, 80)}}, kProbeRadius});
  scene.devices.emplace_back();
  return scene;
}

/// Presses and lifts in turn.
class SlowDevice final : public haptics::Device {
 public:
  haptics::DeviceState read(std::uint64_t, double time) noexcept override {
    haptics::DeviceState state;
    state.position_D = Vec3(0.001, 0.002, kProbeRadius - 0.001 + 0.004 * std::cos(7.0 * time));
    return state;
  }
  bool write(const haptics::ForceCommand&) noexcept override { return true; }
  void stop() noexcept override {}
  [[nodiscard]] std::uint64_t last_tick(double) const noexcept override { return 0; }
};

/// A trial of two intervals: the noise is off in the first, the force is in the second. Tick 700: another
/// tissue.
Recording trial(std::uint64_t ticks = 1000) {
  const TemporaryFolder folder;
  const scene::Scene scene = block_and_probe();
  const haptics::SimulationWorld world = scene::make_world(scene, prepared_once());
  haptics::SimulationState state(world);
  const std::unique_ptr<haptics::ParameterUpdates> updates = scene::make_parameter_updates(scene, world);
  (void)updates->offer(LiveNoise{false, 5e-5, 5e-3}, 99);
  (void)updates->offer(LiveStimulus{0.0, 50e-3, 1}, 100);
  (void)updates->offer(LiveStimulus{0.0, 50e-3, 0}, 300);
  (void)updates->offer(LiveStimulus{0.0125, 40e-3, 2}, 450);
  (void)updates->offer(LiveStimulus{0.0, 30e-3, 0}, 650);
  (void)updates->offer(model::tissue_preset("liver"), 700);
  SlowDevice device;
  haptics::Device* const devices[] = {&device};
  haptics::RunControl control(updates.get());
  Recorder recorder(folder / "a.h5", scene, true);
  recorder.finish(realtime::run_loop(world, state, devices, {&recorder},
                                     {.ticks = ticks, .offline = true, .control = &control}));
  return read_recording(folder / "a.h5");
}

TEST(StimulusRecorded, UpdatesHaveTheirTicksAndRowsTheForceAndTheIntervals) {
  const Recording recording = trial();
  std::vector<std::uint64_t> ticks;
  for (const haptics::ParameterUpdate& change : recording.changes) ticks.push_back(change.tick);
  EXPECT_THAT(ticks, ElementsAre(99, 100, 300, 450, 650, 700));
  ASSERT_EQ(recording.changes.size(), 6U);
  EXPECT_EQ(recording.changes[3].stimulus, (LiveStimulus{0.0125, 40e-3, 2}));
  EXPECT_EQ(recording.changes[3].what, haptics::kStimulusChanged);
  EXPECT_EQ(recording.changes[5].stimulus, LiveStimulus{}) << "an update of the tissue has none";
  std::vector<std::uint64_t> begins;
  std::vector<std::uint64_t> ends;
  for (const haptics::TickRow& row : recording.rows) {
    if ((row.events & haptics::kIntervalBegan) != 0) begins.push_back(row.tick);
    if ((row.events & haptics::kIntervalEnded) != 0) ends.push_back(row.tick);
    const bool off = row.tick < 450 || row.tick >= 679;
    const bool on = row.tick >= 489 && row.tick < 650;  // the ramps take 40 and 30 ticks
    if (off || on) {
      ASSERT_EQ(row.stimulus_force, on ? 0.0125 : 0.0) << row.tick;
    }
  }
  EXPECT_THAT(begins, ElementsAre(100, 450));
  EXPECT_THAT(ends, ElementsAre(300, 650));
}

TEST(StimulusRecorded, ReplayIsTheSameBitForBitAndNeedsTheForce) {
  Recording recording = trial();
  const ReplayResult same = replay(recording, {}, prepared_once());
  EXPECT_EQ(same.rows_compared, 1000U);
  EXPECT_EQ(same.rows_different, 0U) << same.first_difference;
  EXPECT_EQ(same.hash, hash_rows(recording.rows));
  recording.changes[3].stimulus.force = 0.0126;
  EXPECT_GT(replay(recording, {}, prepared_once()).rows_different, 200U);
  recording.changes[3].stimulus.force = 1e3;
  EXPECT_THROW((void)replay(recording, {}, prepared_once()), ParameterError);
}

TEST(StimulusRecorded, AnIntervalInTheRowsThatTheUpdatesLackIsADifference) {
  Recording recording = trial();
  recording.rows[200].events |= haptics::kIntervalEnded;
  const ReplayResult result = replay(recording, {}, prepared_once());
  EXPECT_EQ(result.rows_different, 1U);
  EXPECT_EQ(result.first_difference, "tick 200, hand 0, events: recorded 16, replayed 0");
}

TEST(StimulusRecorded, ExportNamesItAndGivesForceRampAndInterval) {
  const TemporaryFolder folder;
  export_changes_csv(trial(), folder / "c.csv");
  std::ifstream in(folder / "c.csv");
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 7U);
  EXPECT_THAT(lines[0], testing::HasSubstr(
                            ",stimulus_force_N,stimulus_ramp_s,stimulus_interval,source_radius_m,tissue"));
  EXPECT_THAT(lines[1], testing::StartsWith("99,1,noise,"));
  EXPECT_THAT(lines[4], testing::StartsWith("450,4,stimulus,"));
  EXPECT_THAT(lines[4], testing::EndsWith(",0.0125,0.04,2,0,\"gallbladder\""));
  EXPECT_THAT(lines[6], testing::EndsWith(",0,0,0,0,\"liver\""));
}

/// Rewrites the rows without the column of the commanded force, as older recordings have them.
void remove_stimulus(const std::filesystem::path& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t ticks = H5Dopen2(file, "ticks", H5P_DEFAULT);
  const hid_t space = H5Dget_space(ticks);
  const hid_t how = H5Dget_create_plist(ticks);
  const hdf5::Handle in_memory = tick_row_type();
  std::vector<haptics::TickRow> rows(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(ticks, in_memory.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
  H5Dclose(ticks);
  H5Ldelete(file, "ticks", H5P_DEFAULT);
  const std::size_t bytes = offsetof(haptics::TickRow, stimulus_force);
  const hid_t old = H5Tcreate(H5T_COMPOUND, bytes);
  for (const Column& column : tick_columns()) {
    if (column.offset >= offsetof(haptics::TickRow, stimulus_force)) continue;  // and the later ones
    const auto member = static_cast<unsigned>(H5Tget_member_index(in_memory.id(), column.name));
    const hid_t type = H5Tget_member_type(in_memory.id(), member);
    EXPECT_GE(H5Tinsert(old, column.name, column.offset, type), 0) << column.name;
    H5Tclose(type);
  }
  const hid_t again = H5Dcreate2(file, "ticks", old, space, H5P_DEFAULT, how, H5P_DEFAULT);
  EXPECT_GE(H5Dwrite(again, in_memory.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), 0);
  H5Dclose(again);
  H5Tclose(old);
  H5Pclose(how);
  H5Sclose(space);
  H5Fclose(file);
}

void record_rows(const std::filesystem::path& file, const Recording& recording) {
  Recorder recorder(file, recording.scene, true);
  recorder.on_start(kStarted);
  for (const haptics::TickRow& row : recording.rows) recorder.on_row(row);
  recorder.finish({});
}

TEST(StimulusRecorded, AnOldFileWithoutTheColumnHasZeroAndReplaysToTheSameBits) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  Recording before = trial(99);  // without updates
  record_rows(file, before);
  remove_stimulus(file);
  const Recording old = read_recording(file);
  ASSERT_EQ(old.rows.size(), 99U);
  for (std::size_t i = 0; i < old.rows.size(); ++i) ASSERT_TRUE(same_bits(old.rows[i], before.rows[i])) << i;
  EXPECT_EQ(replay(old, {}, prepared_once()).rows_different, 0U);
}

TEST(StimulusRecorded, AnOldFileThatWasCutOffGivesTheRowsBeforeTheDamage) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  record_sample(file, 3000, 1);
  remove_stimulus(file);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 2000 * 350);
  const Recording old = read_recording(file);
  EXPECT_GT(old.rows.size(), 900U);
  EXPECT_LT(old.rows.size(), 3000U);
  for (std::size_t i = 0; i < old.rows.size(); ++i) {
    haptics::TickRow expected = sample_row(i, 0);
    expected.stimulus_force = 0.0;
    ASSERT_TRUE(same_bits(old.rows[i], expected)) << i;
  }
}

TEST(StimulusRecorded, TheHashOfRowsWithoutACommandedForceIsThatFromBeforeItExisted) {
  std::vector<haptics::TickRow> rows = {sample_row(1, 0), sample_row(2, 0)};
  for (haptics::TickRow& row : rows) row.stimulus_force = 0.0;
  std::uint64_t expected = kHashStart;
  for (const haptics::TickRow& row : rows) {
    unsigned char bytes[sizeof(haptics::TickRow)];
    std::memcpy(bytes, &row, sizeof row);
    for (std::size_t i = 0; i < offsetof(haptics::TickRow, stimulus_force); ++i) {
      const bool time = i >= offsetof(haptics::TickRow, tick_ns) && i < offsetof(haptics::TickRow, status);
      if (!time) expected = (expected ^ bytes[i]) * 1099511628211ULL;
    }
  }
  EXPECT_EQ(hash_rows(rows), expected);
  rows[1].stimulus_force = 0.1;
  EXPECT_NE(hash_rows(rows), expected);
}

}  // namespace
}  // namespace palpate::record
