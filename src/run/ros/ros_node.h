#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "palpate/pose.h"

namespace palpate::ros {

/// One hand at one tick, as it is published. World frame, SI units.
struct HandSample {
  std::int64_t unix_ns = 0;    // wall time of the tick [ns]
  Pose pose;                   // of the handle
  Vec3 force = Vec3::Zero();   // N, on the hand
  Vec3 torque = Vec3::Zero();  // N m, about the handle's origin
};

/// The topics of one hand. All members: one thread, not the tick's.
class HandTopics {
 public:
  virtual ~HandTopics() = default;
  /// Publishes pose, wrench and, for a tool with jaws, joint states. @param joints angle of each jaw [rad]
  /// @return how many messages were published
  virtual std::size_t publish(const HandSample& sample, std::span<const double> joints) noexcept = 0;
  /// Publishes the name of the latched fault, "none" without a fault. @return whether it was published
  virtual bool publish_fault(const char* name) noexcept = 0;
  /// Waits until subscribers with reliable QoS have received everything. @param limit_ns longest wait
  virtual void wait_for_receipt(std::int64_t limit_ns) noexcept = 0;
};

/// A pose of geometry_msgs/PoseStamped, unchecked: values may be anything a stranger sends.
struct ReceivedPose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

/// A topic whose poses are received. Its destructor waits for a running callback.
class Subscription {
 public:
  virtual ~Subscription() = default;
  /// [any] Whether a program publishes to the topic.
  [[nodiscard]] virtual bool has_publisher() const noexcept = 0;
};

/// Gets received poses, on a thread of the DDS library.
class PoseListener {
 public:
  virtual ~PoseListener() = default;
  virtual void on_pose(const ReceivedPose& pose) noexcept = 0;
  /// A message that has no valid pose in it, or the end of the last publisher. @param what as text
  virtual void on_loss(const char* what) noexcept = 0;
};

/// A participant in a DDS domain with ROS 2's names and types, in the plug-in palpate_ros.so. All members:
/// [setup].
class Node {
 public:
  virtual ~Node() = default;
  /// @param prefix ROS 2 name, "/palpate/hand0" @param joints names of the jaws; empty: no joint states
  [[nodiscard]] virtual std::unique_ptr<HandTopics> advertise(const std::string& prefix,
                                                              const std::vector<std::string>& joints) = 0;
  /// @param topic ROS 2 name @param listener outlives the subscription
  [[nodiscard]] virtual std::unique_ptr<Subscription> subscribe(const std::string& topic,
                                                                PoseListener& listener) = 0;
};

/// Where a node takes part.
struct NodeOptions {
  std::uint32_t domain = 0;
  std::string network_interface{};  // name or address; empty: CYCLONEDDS_URI, or this machine only
  std::string cyclonedds_uri{};     // configuration of CycloneDDS; empty: none
};

/// [setup] ROS_DOMAIN_ID and CYCLONEDDS_URI. @param network_interface value of --network-interface
/// @throws InputError naming ROS_DOMAIN_ID when it is not 0 to 232, or --network-interface when
/// CYCLONEDDS_URI is set too, or when it is not a name or an address.
[[nodiscard]] NodeOptions options_of_environment(const std::string& network_interface = {});

/// [setup] Prefix of a hand's topics, "/palpate/hand0".
[[nodiscard]] std::string topic_prefix(std::size_t hand);

/// [setup] Checks the name of a topic, "/palpate/hand0/target_pose". @throws InputError
void require_topic_name(const std::string& topic, const std::string& named_by);

/// [setup] Whether this version of palpate can take part: the plug-in palpate_ros.so is installed.
[[nodiscard]] bool has_plugin();

/// [setup] Loads the plug-in and takes part. Nodes of one process and domain share the first one's network.
/// @throws InputError when the plug-in is missing, with the package to install, or CycloneDDS refuses.
[[nodiscard]] std::unique_ptr<Node> open_node(const NodeOptions& options);

}  // namespace palpate::ros
