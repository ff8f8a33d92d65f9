// A stream of poses as the hand of a run, with a clock set by hand. The force ends with the stream.
#include <algorithm>

#include <gtest/gtest.h>

#include "core/haptics/simulation.h"
#include "run/devices/pose_stream.h"
#include "run/devices/replay.h"
#include "run/devices/test/emulated_scene.h"

namespace palpate::devices {
namespace {

using haptics::Fault;
using haptics::TickRow;

constexpr std::uint64_t kStreamSilentTick = 1500;
constexpr std::uint64_t kStreamResumedTick = 2100;
constexpr std::uint64_t kStreamResetTick = 2500;
constexpr std::uint64_t kStreamLastTick = 4200;
constexpr std::int64_t kStreamTickNs = 1'000'000;

/// Path: outside and still for 1 s, then 6 mm in the block; outside and still from 2.1 s, in the block again
/// from 3.5 s.
scene::ToolPath streamed_path() {
  return test::heights(
      {{0.0, 8e-3}, {1.0, 8e-3}, {1.4, -6e-3}, {1.9, -6e-3}, {2.1, 8e-3}, {3.5, 8e-3}, {3.9, -6e-3}});
}

/// A tracker of 50 Hz that sends nothing from kStreamSilentTick to kStreamResumedTick.
class Tracker final : public haptics::Device {
 public:
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override {
    const bool silent = tick >= kStreamSilentTick && tick < kStreamResumedTick;
    const auto now = static_cast<std::int64_t>(tick) * kStreamTickNs;
    if (tick % 20 == 0 && !silent) {
      const scene::PathRow row = path_.at(time);
      refused_ = refused_ || !poses_.add({row.position, row.orientation}, now).empty();
    }
    haptics::DeviceState sample = poses_.at(now);
    if (tick == kStreamResetTick || tick == kStreamStartTick) sample.events = haptics::kResetFault;
    return sample;
  }
  bool write(const haptics::ForceCommand&) noexcept override { return true; }
  void stop() noexcept override {}
  [[nodiscard]] std::uint64_t last_tick(double) const noexcept override { return kStreamLastTick; }
  [[nodiscard]] bool refused() const noexcept { return refused_; }

  static constexpr std::uint64_t kStreamStartTick =
      300;  // the first 8 poses have come, and the delay is over

 private:
  scene::ToolPath path_ = streamed_path();
  PoseStream poses_;
  bool refused_ = false;
};

scene::Scene streamed_setup() {
  scene::Scene scene = test::block_and_hand();
  scene.devices[0].kind = "igtl";
  return scene;
}

TEST(PoseStreamLoop, AStreamThatEndsLeavesNoForceAndItComesBackOnlyByAResetAndTheRamp) {
  Tracker tracker;
  const std::vector<TickRow> rows = test::run_through(streamed_setup(), tracker);
  ASSERT_EQ(rows.size(), kStreamLastTick);
  EXPECT_FALSE(tracker.refused());
  EXPECT_GT(test::force_of(rows[kStreamSilentTick]).norm(), 0.1) << "pressing";
  const std::uint64_t newest = kStreamSilentTick - 20;
  EXPECT_EQ(rows[newest + 100].fault, 0U);
  for (std::uint64_t tick = newest + 101; tick < kStreamResetTick; ++tick) {
    ASSERT_EQ(rows[tick].fault, static_cast<std::uint32_t>(Fault::kStale)) << tick;
    if (tick < newest + 111) continue;
    ASSERT_EQ(test::force_of(rows[tick]).norm(), 0.0) << tick << ": 10 ms after the fault";
  }
  double largest_step = 0.0;
  for (std::uint64_t tick = kStreamResetTick; tick < kStreamLastTick; ++tick) {
    ASSERT_EQ(rows[tick].fault, 0U) << tick;
    largest_step =
        std::max(largest_step, (test::force_of(rows[tick]) - test::force_of(rows[tick - 1])).norm());
  }
  EXPECT_LT(largest_step, 0.1) << "N a tick";
  EXPECT_GT(test::force_of(rows.back()).norm(), 0.1) << "pressing again";
}

TEST(PoseStreamLoop, ItsRecordedSamplesGiveTheSameRowsBitForBit) {
  Tracker tracker;
  const scene::Scene scene = streamed_setup();
  const std::vector<TickRow> rows = test::run_through(scene, tracker);
  ReplayDevice replay(samples_of_hand(rows, 0));
  const std::vector<TickRow> again = test::run_through(scene, replay);
  ASSERT_EQ(again.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].force, again[i].force) << i;
    ASSERT_EQ(rows[i].tool, again[i].tool) << i;
    ASSERT_EQ(rows[i].tool_q, again[i].tool_q) << i;
    ASSERT_EQ(rows[i].energy, again[i].energy) << i;
    ASSERT_EQ(rows[i].fault, again[i].fault) << i;
  }
}

}  // namespace
}  // namespace palpate::devices
