#include "run/devices/ros.h"

#include <atomic>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "io/system/clock.h"
#include "palpate/error.h"

namespace palpate::devices {
namespace {

class Topic final : public ros::Subscription {
 public:
  [[nodiscard]] bool has_publisher() const noexcept override { return false; }
};

/// A node without a network. It keeps its subscriber for a test that sends poses.
class PoseNode final : public ros::Node {
 public:
  explicit PoseNode(std::atomic<ros::PoseListener*>& listener) : listener_(listener) {}
  std::unique_ptr<ros::HandTopics> advertise(const std::string& /*prefix*/,
                                             const std::vector<std::string>& /*joints*/) override {
    return nullptr;
  }
  std::unique_ptr<ros::Subscription> subscribe(const std::string& /*topic*/,
                                               ros::PoseListener& listener) override {
    listener_ = &listener;
    return std::make_unique<Topic>();
  }

 private:
  std::atomic<ros::PoseListener*>& listener_;
};

/// A device whose poses, 1 mm along x, came 10 ms apart from another thread until it was open.
class OpenedRosDevice {
 public:
  OpenedRosDevice() {
    std::atomic<ros::PoseListener*> subscriber{nullptr};
    std::atomic<bool> opened{false};
    std::thread sender([&] {
      while (!opened.load()) {
        if (ros::PoseListener* known = subscriber.load())
          known->on_pose({Vec3(1e-3, 0.0, 0.0), Quat::Identity()});
        sleep_until_ns(monotonic_ns() + 10'000'000);
      }
    });
    device = std::make_unique<RosDevice>(std::make_unique<PoseNode>(subscriber), "/hand");
    opened.store(true);
    sender.join();
    listener = subscriber.load();
  }

  std::unique_ptr<RosDevice> device;
  ros::PoseListener* listener = nullptr;
};

std::string refused_device(const std::string& topic) {
  try {
    std::atomic<ros::PoseListener*> listener{nullptr};
    const RosDevice device(std::make_unique<PoseNode>(listener), topic, 1'000'000);
  } catch (const InputError& error) {
    return error.what();
  }
  return "opened";
}

TEST(RosDevice, WithoutPosesItIsRefused) {
  EXPECT_EQ(refused_device("/hand"),
            "device ros: no geometry_msgs/msg/PoseStamped came on /hand within 0.001 s: no program publishes "
            "to it");
}

TEST(RosDevice, ATopicThatRos2DoesNotAllowIsRefused) {
  EXPECT_EQ(refused_device("hand"),
            "device ros: \"hand\": must be a topic such as /palpate/hand0/target_pose, of letters, digits, _ "
            "and /");
}

TEST(RosDevice, ReadsThePosesAndFaultsWhenTheirPublisherHasGone) {
  const OpenedRosDevice opened;
  EXPECT_EQ(opened.device->read(0, 0.0).position_D, Vec3(1e-3, 0.0, 0.0));
  EXPECT_EQ(opened.device->read(0, 0.0).gripper, 0.0);
  opened.listener->on_loss("its publisher has gone");
  EXPECT_EQ(opened.device->read(1, 0.001).fault, haptics::Fault::kDevice);
  EXPECT_EQ(opened.device->last_error(), "/hand: its publisher has gone");
}

TEST(RosDevice, APoseThatIsNotFiniteIsAFault) {
  const OpenedRosDevice opened;
  opened.listener->on_pose({Vec3(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0), Quat::Identity()});
  EXPECT_EQ(opened.device->read(1, 0.001).fault, haptics::Fault::kDevice);
}

TEST(RosDevice, ACommandThatIsNotFiniteIsRefused) {
  const OpenedRosDevice opened;
  EXPECT_TRUE(opened.device->write({}));
  EXPECT_FALSE(
      opened.device->write({Vec3(0.0, 0.0, std::numeric_limits<double>::quiet_NaN()), Vec3::Zero(), 0.0}));
}

TEST(RosDevice, EachHandHasItsTopic) {
  EXPECT_EQ(default_ros_topic(0), "/palpate/hand0/target_pose");
  EXPECT_EQ(default_ros_topic(1), "/palpate/hand1/target_pose");
}

}  // namespace
}  // namespace palpate::devices
