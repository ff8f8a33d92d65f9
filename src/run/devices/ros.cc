#include "run/devices/ros.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "io/system/clock.h"
#include "palpate/error.h"

namespace palpate::devices {
namespace {

constexpr std::int64_t kRosOpeningPoll = 5'000'000;  // ns between two checks for the first poses

}  // namespace

std::string default_ros_topic(std::size_t hand) { return ros::topic_prefix(hand) + "/target_pose"; }

RosDevice::RosDevice(std::unique_ptr<ros::Node> node, const std::string& topic, std::int64_t opening_ns,
                     const OnWait& on_wait)
    : topic_(topic), node_(std::move(node)) {
  ros::require_topic_name(topic, "device ros:");
  subscription_ = node_->subscribe(topic, *this);
  wait_for_poses(opening_ns, on_wait);
}

RosDevice::~RosDevice() = default;

haptics::DeviceState RosDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  return poses_.at(monotonic_ns());
}

bool RosDevice::write(const haptics::ForceCommand& command_D) noexcept {
  return command_D.force.allFinite() && command_D.torque.allFinite();
}

std::string RosDevice::last_error() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::int64_t silence = monotonic_ns() - heard_ns_;
  if (lost_ || heard_ns_ == 0 || silence <= PoseStream::kSilence) return last_error_;
  return fmt::format("{}: no pose came for {} ms", topic_, silence / 1'000'000);
}

void RosDevice::on_pose(const ros::ReceivedPose& pose) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  heard_ns_ = monotonic_ns();
  const std::string refused = poses_.add({pose.position, pose.orientation}, heard_ns_);
  lost_ = false;
  if (!refused.empty()) last_error_ = topic_ + ": " + refused;
}

void RosDevice::on_loss(const char* what) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  lost_ = true;
  last_error_ = topic_ + ": " + what;
  poses_.break_off();
}

void RosDevice::wait_for_poses(std::int64_t opening_ns, const OnWait& on_wait) {
  const std::int64_t deadline = monotonic_ns() + opening_ns;
  for (;;) {
    const std::int64_t now = monotonic_ns();
    const haptics::DeviceState sample = poses_.at(now);
    if (sample.fault == haptics::Fault::kNone && sample.age == 0.0) return;
    if (now >= deadline) break;
    if (on_wait) on_wait();
    sleep_until_ns(std::min(deadline, now + kRosOpeningPoll));
  }
  const std::string error = last_error();
  throw InputError(fmt::format("device ros: no geometry_msgs/msg/PoseStamped came on {} within {:.3g} s: {}",
                               topic_, 1e-9 * static_cast<double>(opening_ns),
                               !error.empty() ? error
                               : subscription_->has_publisher()
                                   ? "its publisher must send at least 20 poses per second"
                                   : "no program publishes to it"));
}

Probe probe_ros() {
  if (ros::has_plugin()) {
    return {"ros", true, "poses from a ROS 2 topic: ros:/TOPIC, by default ros:/palpate/hand0/target_pose"};
  }
  return {"ros",
          false,
          "this palpate is built without CycloneDDS",
          true,
          {{"palpate_ros.so is not installed", "apt install palpate-ros"}}};
}

}  // namespace palpate::devices
