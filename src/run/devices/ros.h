#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "palpate/device.h"
#include "run/devices/pose_stream.h"
#include "run/devices/probe.h"
#include "run/ros/ros_node.h"

namespace palpate::devices {

/// [setup] The topic of a hand whose device names none, "/palpate/hand0/target_pose".
[[nodiscard]] std::string default_ros_topic(std::size_t hand);

/// A hand that another program moves through a ROS 2 topic of geometry_msgs/PoseStamped: the poses, in the
/// device's frame, pass through a PoseStream. The times of arrival count, not the stamps, because clocks of
/// two machines differ. The gripper is closed. The commanded force is not sent by the device: `palpate ros`
/// publishes it.
class RosDevice final : public haptics::Device, private ros::PoseListener {
 public:
  static constexpr std::int64_t kOpening = 30'000'000'000;  // ns, for the first poses

  /// [setup] Subscribes and waits until enough poses have come. @param topic name in ROS 2
  /// @throws InputError when `topic` is not a name, or no poses come within `opening_ns`.
  RosDevice(std::unique_ptr<ros::Node> node, const std::string& topic, std::int64_t opening_ns = kOpening,
            const OnWait& on_wait = {});
  ~RosDevice() override;
  RosDevice(const RosDevice&) = delete;
  RosDevice& operator=(const RosDevice&) = delete;

  /// [rt] The interpolated pose. Its fault is that of PoseStream::at().
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] @return false when the command is not finite.
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  /// [any] Does nothing: nothing displays the force.
  void stop() noexcept override {}
  /// [any]
  [[nodiscard]] std::string last_error() const override;
  /// [any] "ROS 2 topic /palpate/hand0/target_pose".
  [[nodiscard]] std::string description() const { return "ROS 2 topic " + topic_; }

 private:
  void on_pose(const ros::ReceivedPose& pose) noexcept override;
  void on_loss(const char* what) noexcept override;
  void wait_for_poses(std::int64_t opening_ns, const OnWait& on_wait);

  const std::string topic_;
  std::unique_ptr<ros::Node> node_;
  PoseStream poses_;
  mutable std::mutex mutex_;   // guards the next three; calls of the listener wait for each other
  std::string last_error_;     // the last one; empty: none
  bool lost_ = false;          // the publisher has gone
  std::int64_t heard_ns_ = 0;  // arrival of the newest pose; 0: none yet
  std::unique_ptr<ros::Subscription> subscription_;  // last: its thread uses all of the above
};

/// [setup] Whether palpate can take part in ROS 2.
[[nodiscard]] Probe probe_ros();

}  // namespace palpate::devices
