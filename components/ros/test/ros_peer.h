#pragma once
// A second DDS program with the messages of ROS 2, on this machine only, for tests of `palpate ros`.
#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <unistd.h>

#include "ros_messages.h"

namespace palpate::tests {

using RosPose = geometry_msgs_msg_dds__PoseStamped_;
using RosWrench = geometry_msgs_msg_dds__WrenchStamped_;
using RosJoints = sensor_msgs_msg_dds__JointState_;
using RosText = std_msgs_msg_dds__String_;

template <typename Message>
const dds_topic_descriptor_t& descriptor_of() {
  if constexpr (std::is_same_v<Message, RosPose>) return geometry_msgs_msg_dds__PoseStamped__desc;
  if constexpr (std::is_same_v<Message, RosWrench>) return geometry_msgs_msg_dds__WrenchStamped__desc;
  if constexpr (std::is_same_v<Message, RosJoints>) return sensor_msgs_msg_dds__JointState__desc;
  if constexpr (std::is_same_v<Message, RosText>) return std_msgs_msg_dds__String__desc;
}

inline dds_entity_t valid(dds_entity_t entity) {
  if (entity < 0) throw std::runtime_error(dds_strretcode(entity));
  return entity;
}

/// A participant in a domain of its own, as a ROS 2 program with ROS_LOCALHOST_ONLY=1.
class RosPeer final {
 public:
  RosPeer()
      // Tests of several processes run at once.
      : domain_id_(100 + static_cast<std::uint32_t>(getpid()) % 130),
        domain_(valid(dds_create_domain(
            domain_id_,
            "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
            "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery>"
            "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32"
            "</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>"
            "</Domain></CycloneDDS>"))),
        participant_(valid(dds_create_participant(domain_id_, nullptr, nullptr))) {}
  ~RosPeer() { dds_delete(domain_); }
  RosPeer(const RosPeer&) = delete;
  RosPeer& operator=(const RosPeer&) = delete;

  [[nodiscard]] dds_entity_t participant() const noexcept { return participant_; }
  /// Value of ROS_DOMAIN_ID.
  [[nodiscard]] std::string domain() const { return std::to_string(domain_id_); }

 private:
  std::uint32_t domain_id_;
  dds_entity_t domain_;
  dds_entity_t participant_;
};

/// Subscribes with ROS 2's default profile: reliable, volatile. All messages are kept.
template <typename Message>
class RosReader final {
 public:
  RosReader(const RosPeer& peer, const std::string& dds_topic) {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_INFINITY);
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    const dds_entity_t topic = valid(
        dds_create_topic(peer.participant(), &descriptor_of<Message>(), dds_topic.c_str(), nullptr, nullptr));
    reader_ = valid(dds_create_reader(peer.participant(), topic, qos, nullptr));
    dds_delete_qos(qos);
  }
  RosReader(const RosReader&) = delete;
  RosReader& operator=(const RosReader&) = delete;

  /// Passes each received message to `use`.
  template <typename Use>
  void take(Use&& use) {
    for (;;) {
      void* samples[1] = {nullptr};
      dds_sample_info_t info[1];
      if (dds_take(reader_, samples, info, 1, 1) <= 0) return;
      if (info[0].valid_data) use(*static_cast<const Message*>(samples[0]));
      dds_return_loan(reader_, samples, 1);
    }
  }
  /// The next message as it was sent, with the four bytes that give its representation.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> take_bytes() {
    ddsi_serdata* data[1] = {nullptr};
    dds_sample_info_t info[1];
    if (dds_takecdr(reader_, data, 1, info, DDS_ANY_STATE) <= 0) return std::nullopt;
    std::vector<std::uint8_t> bytes(ddsi_serdata_size(data[0]));
    ddsi_serdata_to_ser(data[0], 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(data[0]);
    if (!info[0].valid_data) return std::nullopt;
    return bytes;
  }
  [[nodiscard]] bool has_publisher() const {
    dds_subscription_matched_status_t status{};
    return dds_get_subscription_matched_status(reader_, &status) == DDS_RETCODE_OK &&
           status.current_count > 0;
  }

 private:
  dds_entity_t reader_ = 0;
};

/// Publishes poses with ROS 2's sensor data profile: best effort.
class RosPoseWriter final {
 public:
  RosPoseWriter(const RosPeer& peer, const std::string& dds_topic) {
    const dds_entity_t topic = valid(
        dds_create_topic(peer.participant(), &descriptor_of<RosPose>(), dds_topic.c_str(), nullptr, nullptr));
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
    writer_ = valid(dds_create_writer(peer.participant(), topic, qos, nullptr));
    dds_delete_qos(qos);
  }
  RosPoseWriter(const RosPoseWriter&) = delete;
  RosPoseWriter& operator=(const RosPoseWriter&) = delete;
  ~RosPoseWriter() { dds_delete(writer_); }

  void write(RosPose pose, const std::string& frame = "world") {
    std::string name = frame;
    pose.header.frame_id = name.data();
    dds_write(writer_, &pose);
  }
  [[nodiscard]] bool has_subscriber() const {
    dds_publication_matched_status_t status{};
    return dds_get_publication_matched_status(writer_, &status) == DDS_RETCODE_OK && status.current_count > 0;
  }

 private:
  dds_entity_t writer_ = 0;
};

}  // namespace palpate::tests
