// The emulated hand in the loop: its result, a repeated run and a replay.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "palpate/recording.h"
#include "palpate/scene.h"
#include "run/devices/devices.h"
#include "run/devices/test/emulated_scene.h"

namespace palpate::devices {
namespace {

using haptics::TickRow;
using test::force_of;

scene::ToolPath press_once() {
  return test::heights({{0.0, 8e-3}, {1.0, 8e-3}, {1.5, -10e-3}, {2.0, -10e-3}});
}

TEST(EmulatedRun, TheForceFeedsBackSoTheHandStopsAboveWhereItWantsToBe) {
  for (const scene::HandGrip& grip : {scene::kLightGrip, scene::kFirmGrip}) {
    scene::Scene scene = test::block_and_hand();
    scene.noise.enabled = false;
    scene.devices[0].emulated.grip = grip;
    EmulatedDevice device(press_once(), scene.devices[0], scene.rate_Hz);
    const TickRow last = test::run_through(scene, device).back();
    // At rest the pull of the grip, K (wanted depth - depth), equals the tissue force except for friction.
    const double pull = grip.stiffness * (10e-3 - last.depth);
    EXPECT_GT(last.tissue_force, 0.05);
    EXPECT_NEAR(pull, force_of(last).norm(), scene::kEmulatedFriction + 0.5e-5 * grip.stiffness);
  }
}

TEST(EmulatedRun, ARecordedRunWithAFaultAndAResetReplaysBitForBit) {
  const scene::Scene scene = test::block_and_hand({{scene::EmulatedFaultKind::kNotANumber, 1.8, 0.05, 8e-3},
                                                   {scene::EmulatedFaultKind::kLate, 2.2, 0.1, 8e-3}});
  EmulatedDevice device(press_once(), scene.devices[0], scene.rate_Hz);
  test::WithResets user(device, {2000});
  record::Recording recording;
  recording.scene = scene;
  recording.rows = test::run_through(scene, user);
  EXPECT_TRUE(std::any_of(recording.rows.begin(), recording.rows.end(),
                          [](const TickRow& r) { return r.fault != 0; }));
  const record::ReplayResult replayed = record::replay(recording);
  EXPECT_EQ(replayed.rows_compared, recording.rows.size());
  EXPECT_EQ(replayed.rows_different, 0U) << replayed.first_difference;
}

TEST(EmulatedRun, RealTimeAndOfflineGiveTheSameRows) {
  const scene::Scene scene = test::block_and_hand();
  const auto rows_of = [&](bool offline) {
    EmulatedDevice device(press_once(), scene.devices[0], scene.rate_Hz);
    return test::run_through(scene, device, offline);
  };
  const std::vector<TickRow> offline = rows_of(true);
  const std::vector<TickRow> live = rows_of(false);
  ASSERT_EQ(live.size(), offline.size());
  for (std::size_t i = 0; i < live.size(); ++i) {
    // A machine that halts for 20 ms latches a stall fault, and the runs differ from that tick on.
    if (live[i].fault == static_cast<std::uint32_t>(haptics::Fault::kStalled)) break;
    ASSERT_EQ(record::row_difference(offline[i], live[i]), "") << i;
  }
}

TEST(EmulatedRun, WithoutAPathItWaitsASecondAndThenFollowsTheDefaultOne) {
  scene::Overrides request;
  request.organ = "box";
  request.tools = {"sphere:3"};
  request.device = "emulated";
  const scene::Scene scene = scene::load(request);
  const auto device = open_device(scene, 0);
  const scene::ToolPath path = scene::default_path(scene, 0);
  EXPECT_EQ(device->last_tick(1000.0),
            static_cast<std::uint64_t>(std::lround((path.end_time() + 1.5) * 1000.0)));
  const std::vector<TickRow> rows = test::run_through(scene, *device);
  EXPECT_EQ(rows[900].engagement, 1.0) << "the force is let through before the hand moves";
  EXPECT_NEAR(
      (Vec3(rows[1000].device[0], rows[1000].device[1], rows[1000].device[2]) - path.at(0.0).position).norm(),
      0.0, 0.2e-3);
  const auto deepest = std::max_element(rows.begin(), rows.end(),
                                        [](const TickRow& a, const TickRow& b) { return a.depth < b.depth; });
  EXPECT_GT(deepest->depth, 9e-3);
  EXPECT_LT(deepest->depth, 12e-3) << "the tissue holds the hand back";
  EXPECT_EQ(rows.back().fault, 0U);
}

}  // namespace
}  // namespace palpate::devices
