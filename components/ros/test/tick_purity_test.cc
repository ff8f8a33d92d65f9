// A tick that is published to ROS 2 uses no heap and no lock (experiments of tests/tick_purity_test.cc).
#include <string>

#include <gtest/gtest.h>

#include "ros/publisher/ros_publisher.h"
#include "ros/publisher/test/fake_node.h"
#include "tests/built_in_experiments.h"
#include "tests/heap_and_lock_guard.h"
#include "tests/tick_bracket.h"

namespace palpate::tests {
namespace {

constexpr std::uint64_t kTicks = 10'000;

class PublishedTickPurity : public testing::TestWithParam<const char*> {};

TEST_P(PublishedTickPurity, NoHeapUseAndNoLockWhileEveryTickIsPublishedToRos2) {
  Rig rig = built_in(GetParam());
  ros::test::FakeNode node;
  ros::RosPublisher publisher(node, rig.scene.tools, rig.world.rate_Hz, ros::RosPublisher::kFastestRate);
  Bracket bracket(kTicks, arm_guard, disarm_guard);
  const std::uint64_t heap_before = heap_uses();
  const std::uint64_t locks_before = lock_uses();
  (void)rig.run({&publisher, &bracket}, {.ticks = kTicks, .offline = true});
  EXPECT_EQ(heap_uses() - heap_before, 0u);
  EXPECT_EQ(lock_uses() - locks_before, 0u);
  EXPECT_GT(publisher.finish().messages, 0u);
}

INSTANTIATE_TEST_SUITE_P(All, PublishedTickPurity, testing::Values("press", "pull", "moving"),
                         [](const auto& task) { return std::string(task.param); });

}  // namespace
}  // namespace palpate::tests
