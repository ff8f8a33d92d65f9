#include "ros/publisher/ros_publisher.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/haptics/simulation.h"
#include "core/haptics/test/test_world.h"
#include "io/system/clock.h"

#include "ros/publisher/test/fake_node.h"

namespace palpate::ros {
namespace {

using test::FakeNode;
using test::Published;

geometry::Tool probe() { return {"probe", {geometry::ToolPart{}}, {}}; }

/// A shaft and two jaws that open by 0.2 and -0.2 rad.
geometry::Tool forceps() {
  geometry::Tool tool{"forceps", {geometry::ToolPart{}}, {}};
  for (const double angle : {0.2, -0.2}) {
    geometry::ToolPart jaw;
    jaw.is_jaw = true;
    jaw.open_angle = angle;
    tool.parts.push_back(jaw);
  }
  return tool;
}

haptics::TickRow row_at(std::uint64_t tick, std::uint32_t hand,
                        haptics::Fault fault = haptics::Fault::kNone) {
  haptics::TickRow row;
  row.tick = tick;
  row.hand = hand;
  const double number = static_cast<double>(tick);
  row.tool = {number, 10.0 + hand, 0.0};
  row.tool_q = {0.5, 0.5, -0.5, 0.5};
  row.force = {0.0, 0.0, number};
  row.torque = {number, 0.0, 0.0};
  row.gripper = 0.5;
  row.fault = static_cast<std::uint32_t>(fault);
  return row;
}

/// Calls the observer as the loop does.
void make_tick(RosPublisher& publisher, const std::vector<haptics::TickRow>& rows) {
  for (const haptics::TickRow& row : rows) publisher.on_row(row);
  static const haptics::SimulationWorld world = haptics::test::block_and_balls(1, 1000.0);
  static const haptics::SimulationState state(world);
  publisher.on_tick({state, {}, rows.front().tick, monotonic_ns()});
}

TEST(RosPublisher, PublishesTheRowsOfTheTicksThatAreDue) {
  FakeNode node;
  RosPublisher publisher(node, {probe()}, 1000.0, 100.0);
  for (std::uint64_t tick = 0; tick < 21; ++tick) make_tick(publisher, {row_at(tick, 0)});
  const std::int64_t before = unix_ns();
  const PublisherStatistics tally = publisher.finish();
  const Published& hand = node.hands[0];
  ASSERT_EQ(hand.samples.size(), 3u) << "ticks 0, 10 and 20";
  for (std::size_t i = 0; i < 3; ++i) {
    const HandSample& sample = hand.samples[i];
    const double tick = 10.0 * static_cast<double>(i);
    EXPECT_EQ(sample.pose.position, Vec3(tick, 10.0, 0.0));
    EXPECT_EQ(sample.pose.rotation.coeffs(), Quat(0.5, 0.5, -0.5, 0.5).coeffs()) << "w, x, y, z";
    EXPECT_EQ(sample.force, Vec3(0.0, 0.0, tick));
    EXPECT_EQ(sample.torque, Vec3(tick, 0.0, 0.0));
    EXPECT_NEAR(static_cast<double>(sample.unix_ns - before), 0.0, 60e9) << "wall time";
    EXPECT_TRUE(hand.joints[i].empty()) << "it has no jaws";
  }
  EXPECT_EQ(tally.messages, 2 * 3 + hand.faults.size());
  EXPECT_EQ(tally.failed, 0u);
  EXPECT_EQ(tally.skipped, 0u);
}

TEST(RosPublisher, ARateThatDoesNotDivideTheLoopsIsNotExceeded) {
  FakeNode node;
  EXPECT_EQ(RosPublisher(node, {}, 1000.0, 300.0).every(), 4u) << "250 Hz";
  EXPECT_EQ(RosPublisher(node, {}, 1000.0, 1000.0).every(), 1u);
  EXPECT_EQ(RosPublisher(node, {}, 100.0, 1000.0).every(), 1u) << "not more than there are";
}

TEST(RosPublisher, PublishesANewFaultOfItsHandAtOnce) {
  using haptics::Fault;
  FakeNode node;
  RosPublisher publisher(node, {probe(), probe()}, 1000.0, 1.0);
  make_tick(publisher, {row_at(0, 0), row_at(0, 1)});
  for (std::uint64_t tick = 1; tick < 9; ++tick) {
    make_tick(publisher, {row_at(tick, 0), row_at(tick, 1, tick < 5 ? Fault::kNone : Fault::kStale)});
  }
  make_tick(publisher, {row_at(9, 0), row_at(9, 1)});
  (void)publisher.finish();
  EXPECT_EQ(node.prefixes, (std::vector<std::string>{"/palpate/hand0", "/palpate/hand1"}));
  ASSERT_EQ(node.hands[1].samples.size(), 3u) << "ticks 0, 5 and 9";
  EXPECT_EQ(node.hands[1].samples[1].pose.position, Vec3(5.0, 11.0, 0.0));
  // Repetitions, once per second, are left out.
  const auto changes = [](std::vector<std::string> faults) {
    faults.erase(std::unique(faults.begin(), faults.end()), faults.end());
    return faults;
  };
  EXPECT_EQ(changes(node.hands[0].faults), (std::vector<std::string>{"none"}));
  EXPECT_EQ(changes(node.hands[1].faults), (std::vector<std::string>{"none", "stale-sample", "none"}));
}

TEST(RosPublisher, JointsAreTheJawsWithTheirAngles) {
  FakeNode node;
  RosPublisher publisher(node, {forceps()}, 1000.0, 1000.0);
  make_tick(publisher, {row_at(0, 0)});
  (void)publisher.finish();
  EXPECT_EQ(node.names[0], (std::vector<std::string>{"hand0_jaw0", "hand0_jaw1"}));
  ASSERT_EQ(node.hands[0].joints.size(), 1u);
  EXPECT_EQ(node.hands[0].joints[0], (std::vector<double>{0.1, -0.1})) << "half open";
}

TEST(RosPublisher, CountsTheTicksThatFindTheQueueFull) {
  FakeNode node;
  RosPublisher publisher(node, {probe()}, 1000.0, 1000.0);
  constexpr std::uint64_t kTicks = 100 * RosPublisher::kQueued;  // faster than its thread wakes up
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) make_tick(publisher, {row_at(tick, 0)});
  const PublisherStatistics tally = publisher.finish();
  EXPECT_GT(tally.skipped, 0u);
  EXPECT_EQ(node.hands[0].samples.size() + tally.skipped, kTicks);
}

}  // namespace
}  // namespace palpate::ros
