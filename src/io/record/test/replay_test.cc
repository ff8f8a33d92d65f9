#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/contact/test/prepared_once.h"
#include "io/record/test/sample_recording.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/recording.h"
#include "run/realtime/loop.h"

namespace palpate::record {
namespace {

using contact::test::prepared_once;

using ::testing::HasSubstr;

constexpr double kReplayedBallRadius = 3e-3;  // m

/// A ball in each hand above a block whose top is at z = 0.
scene::Scene block_and_balls(std::size_t hands) {
  scene::Scene scene;
  scene.name = "block and balls";
  scene.seed = 9;
  scene.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  scene.organ_pose.position = Vec3(0, 0, -0.02);
  scene.tissue = model::tissue_preset("gallbladder");
  for (std::size_t hand = 0; hand < hands; ++hand) {
    scene.tools.push_back({"ball",
                           {{.name = "ball", .mesh = geometry::make_ball(kReplayedBallRadius, 80)}},
                           kReplayedBallRadius});
    scene.devices.emplace_back();
  }
  return scene;
}

/// Presses at 20 mm/s from 2 mm above to 3 mm deep, with a lateral offset between hands.
class PressingDevice final : public haptics::Device {
 public:
  explicit PressingDevice(double x) : x_(x) {}
  haptics::DeviceState read(std::uint64_t, double time) noexcept override {
    haptics::DeviceState state;
    state.position_D = Vec3(x_, 0.002, kReplayedBallRadius + std::max(-0.003, 0.002 - 0.02 * time));
    return state;
  }
  bool write(const haptics::ForceCommand&) noexcept override { return true; }
  void stop() noexcept override {}
  [[nodiscard]] std::uint64_t last_tick(double) const noexcept override { return 0; }

 private:
  double x_;
};

/// The loop's rows of a run, recorded and read back.
Recording run(const scene::Scene& scene, std::uint64_t ticks) {
  const TemporaryFolder folder;
  const haptics::SimulationWorld world = scene::make_world(scene, prepared_once());
  haptics::SimulationState state(world);
  PressingDevice left(0.01);
  PressingDevice right(-0.01);
  haptics::Device* const devices[] = {&left, &right};
  Recorder recorder(folder / "a.h5", scene, true);
  realtime::LoopOptions options;
  options.ticks = ticks;
  options.offline = true;
  recorder.finish(
      realtime::run_loop(world, state, std::span(devices, scene.tools.size()), {&recorder}, options));
  return read_recording(folder / "a.h5");
}

TEST(Replay, RecordedRunComesOutTheSameBitForBit) {
  const Recording recording = run(block_and_balls(2), 300);
  ASSERT_EQ(recording.rows.size(), 600U);
  EXPECT_EQ(recording.rows.back().phase, 1U) << "the run must touch to mean anything";
  const ReplayResult result = replay(recording, {}, prepared_once());
  EXPECT_EQ(result.rows_compared, 600U);
  EXPECT_EQ(result.rows_different, 0U) << result.first_difference;
  EXPECT_EQ(result.first_difference, "");
  EXPECT_EQ(result.hash, hash_rows(recording.rows));
}

/// The scene of block_and_balls() with breathing and heartbeat.
scene::Scene breathing_block() {
  scene::Scene scene = block_and_balls(1);
  scene.organ_motion = {model::organ_motion_preset(model::OrganMotionKind::kBreathing),
                        model::organ_motion_preset(model::OrganMotionKind::kHeartbeat)};
  scene.organ_motion[0].phase = 0.3;
  scene.organ_motion[1].axis_W = Vec3(1, 2, 2) / 3.0;
  return scene;
}

TEST(Replay, ARunOnAMovingOrganComesOutTheSameBitForBit) {
  const Recording recording = run(breathing_block(), 1500);
  const ReplayResult result = replay(recording, {}, prepared_once());
  EXPECT_EQ(result.rows_compared, 1500U);
  EXPECT_EQ(result.rows_different, 0U) << result.first_difference;
  Recording still = recording;
  still.scene.organ_motion.clear();
  EXPECT_GT(replay(still, {}, prepared_once()).rows_different, 1000U) << "the motion is what was recorded";
}

TEST(Replay, ARunOnASmoothTissueThatRelaxesComesOutTheSameBitForBit) {
  scene::Scene scene = block_and_balls(2);
  scene.tissue.law = model::LawKind::kSmooth;
  scene.tissue.relaxation = {{0.3, 0.05}, {0.2, 1.0 / 3.0}, {0.1, 7.0}};
  const Recording recording = run(scene, 600);
  const ReplayResult result = replay(recording, {}, prepared_once());
  EXPECT_EQ(result.rows_compared, 1200U);
  EXPECT_EQ(result.rows_different, 0U) << result.first_difference;
  Recording elastic = recording;
  elastic.scene.tissue.relaxation.pop_back();
  EXPECT_GT(replay(elastic, {}, prepared_once()).rows_different, 500U) << "relaxation is what was recorded";
}

TEST(SnapshotsAt, CarryTheOrgansPoseOfTheirTick) {
  const scene::Scene scene = breathing_block();
  const std::vector<haptics::Snapshot> snapshots = snapshots_at(run(scene, 1000), {0, 999}, prepared_once());
  EXPECT_EQ(snapshots[0].organ_W.position, scene.organ_pose.position);
  const Pose moved = scene::organ_motion_of(scene).pose_at(scene.organ_pose, 999, scene.rate_Hz);
  EXPECT_EQ(snapshots[1].organ_W.position, moved.position);
  EXPECT_EQ(snapshots[1].organ_W.rotation.coeffs(), moved.rotation.coeffs());
  EXPECT_GT((moved.position - scene.organ_pose.position).norm(), 1e-3);
}

TEST(Replay, ChangedValueIsFoundAndNamed) {
  Recording recording = run(block_and_balls(1), 250);
  recording.rows[200].torque[1] = 0.125;
  recording.rows[201].depth = 1.0;
  const ReplayResult result = replay(recording, {}, prepared_once());
  EXPECT_EQ(result.rows_different, 2U);
  EXPECT_THAT(result.first_difference,
              HasSubstr("tick 200, hand 0, torque_y_N_m: recorded 0.125, replayed "));
}

TEST(Replay, RecordingThatLacksATickIsRefused) {
  Recording recording = run(block_and_balls(1), 20);
  recording.rows.erase(recording.rows.begin() + 7);
  EXPECT_THROW((void)replay(recording, {}, prepared_once()), InputError);
}

TEST(Replay, MeasuredTimesNeitherDifferNorCountInTheHash) {
  const haptics::TickRow a = sample_row(5, 0);
  haptics::TickRow b = a;
  b.tick_ns += 1;
  b.late_ns += 1;
  EXPECT_EQ(row_difference(a, b), "");
  EXPECT_EQ(hash_rows(std::span(&a, 1)), hash_rows(std::span(&b, 1)));
  b.device_valid = 0;
  EXPECT_EQ(row_difference(a, b), "tick 5, hand 0, device_valid: recorded 1, replayed 0");
  EXPECT_NE(hash_rows(std::span(&a, 1)), hash_rows(std::span(&b, 1)));
}

TEST(Replay, BitsCountNotValues) {
  haptics::TickRow a;
  haptics::TickRow b;
  b.depth = -0.0;
  EXPECT_EQ(row_difference(a, b), "tick 0, hand 0, depth_m: recorded 0, replayed -0");
}

TEST(Replay, HashGoesOnFromTheRowsBefore) {
  const haptics::TickRow rows[] = {sample_row(0, 0), sample_row(1, 0)};
  EXPECT_EQ(hash_rows(rows), hash_rows(std::span(rows + 1, 1), hash_rows(std::span(rows, 1))));
  EXPECT_EQ(hash_rows({}), 14695981039346656037ULL);  // FNV-1a of no bytes
}

TEST(SnapshotsAt, AreThoseOfTheTicksAskedFor) {
  const Recording recording = run(block_and_balls(2), 250);
  const std::vector<haptics::Snapshot> snapshots =
      snapshots_at(recording, {0, 120, 120, 249}, prepared_once());
  ASSERT_EQ(snapshots.size(), 4U);
  const std::uint64_t ticks[] = {0, 120, 120, 249};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(snapshots[i].tick, ticks[i]);
    EXPECT_EQ(snapshots[i].hands, 2U);
    for (std::size_t hand = 0; hand < 2; ++hand) {
      const haptics::TickRow& row = recording.rows[ticks[i] * 2 + hand];
      EXPECT_EQ(snapshots[i].results[hand].depth, row.depth);
      EXPECT_EQ(snapshots[i].tools[hand].pose_W.position.z(), row.tool[2]);
      EXPECT_EQ(snapshots[i].commands[hand].force.z(), row.force[2]);
    }
  }
  EXPECT_GT(snapshots[3].results[0].view_count, 0);
}

TEST(SnapshotsAt, TicksPastTheEndOrOutOfOrderAreRefused) {
  const Recording recording = run(block_and_balls(1), 20);
  EXPECT_THROW((void)snapshots_at(recording, {20}, prepared_once()), InputError);
  EXPECT_THROW((void)snapshots_at(recording, {5, 3}, prepared_once()), InputError);
}

}  // namespace
}  // namespace palpate::record
