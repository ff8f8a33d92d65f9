// The plug-in palpate_ros.so: a participant in ROS 2's part of DDS, by CycloneDDS. It throws
// std::runtime_error only.
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsrt/log.h>

#include "run/ros/ros_node.h"

#include "ros_messages.h"

namespace palpate::ros {
namespace {

constexpr const char* kFrame = "world";
constexpr std::int32_t kDepth = 10;        // messages kept, as in ROS 2's default profile
constexpr std::int32_t kPoseDepth = 32;    // received poses kept until the listener runs
constexpr std::size_t kTakenAtOnce = 16;   // received poses
constexpr std::size_t kLongestLog = 1000;  // characters

// Received samples above 64 kB are dropped: a PoseStamped has about 100 bytes. The element is part of every
// configuration.
constexpr const char* kLimits =
    "<CycloneDDS><Domain><Internal><MaxSampleSize>64 kB</MaxSampleSize></Internal></Domain></CycloneDDS>";

/// The last messages of CycloneDDS, which prints them on standard error otherwise.
class Log final {
 public:
  Log() { dds_set_log_sink(&Log::add, this); }
  void clear() {
    const std::lock_guard lock(mutex_);
    text_.clear();
  }
  /// The first line since clear().
  [[nodiscard]] std::string first_line() {
    const std::lock_guard lock(mutex_);
    return text_.substr(0, text_.find('\n'));
  }

 private:
  static void add(void* self, const dds_log_data_t* data) {
    Log& log = *static_cast<Log*>(self);
    const std::lock_guard lock(log.mutex_);
    if (log.text_.size() < kLongestLog) log.text_.append(data->message, std::min(data->size, kLongestLog));
  }

  std::mutex mutex_;
  std::string text_;
};

/// CycloneDDS has one log and one set of domains per process, which the nodes of a process share.
struct Process {
  Log log;
  std::mutex mutex;
  struct Domain {
    dds_entity_t entity = 0;
    int nodes = 0;
  };
  std::map<std::uint32_t, Domain> domains;  // guarded by mutex
};

Process& process() {
  static Process* const one = new Process;  // never destroyed: threads of CycloneDDS may log at exit
  return *one;
}

[[noreturn]] void fail(const std::string& what, dds_return_t code) {
  const std::string line = process().log.first_line();
  throw std::runtime_error(what + ": " + (line.empty() ? dds_strretcode(code) : line));
}

dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity < 0) fail(what, entity);
  return entity;
}

/// The configuration of the domain. Without other options it uses the loopback interface only: discovery goes
/// to the first participants of this machine, without multicast.
std::string configuration(const NodeOptions& options) {
  if (!options.cyclonedds_uri.empty()) return std::string(kLimits) + "," + options.cyclonedds_uri;
  const std::string start = std::string(kLimits) + ",<CycloneDDS><Domain><General><Interfaces>";
  const std::string end = "</General></Domain></CycloneDDS>";
  const std::string& name = options.network_interface;
  if (name.empty()) {
    return start +
           "<NetworkInterface "
           "address=\"127.0.0.1\"/></Interfaces><AllowMulticast>false</AllowMulticast></General>"
           "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32"
           "</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery></Domain>"
           "</CycloneDDS>";
  }
  const bool address = name.find_first_of(".:") != std::string::npos;
  return start + "<NetworkInterface " + (address ? "address" : "name") + "=\"" + name + "\"/></Interfaces>" +
         end;
}

/// A node's part in a domain. The last node of a domain deletes it.
class DomainUse final {
 public:
  explicit DomainUse(const NodeOptions& options) : id_(options.domain) {
    const std::lock_guard lock(process().mutex);
    Process::Domain& domain = process().domains[id_];
    if (domain.nodes == 0) {
      process().log.clear();
      domain.entity = checked(dds_create_domain(id_, configuration(options).c_str()),
                              "CycloneDDS cannot use the network");
    }
    ++domain.nodes;
  }
  ~DomainUse() {
    const std::lock_guard lock(process().mutex);
    Process::Domain& domain = process().domains[id_];
    if (--domain.nodes == 0) dds_delete(domain.entity);
  }
  DomainUse(const DomainUse&) = delete;
  DomainUse& operator=(const DomainUse&) = delete;

 private:
  std::uint32_t id_;
};

/// An entity of CycloneDDS, deleted at the end with all that it contains.
class Entity final {
 public:
  explicit Entity(dds_entity_t number) : number_(number) {}
  ~Entity() { dds_delete(number_); }
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  [[nodiscard]] dds_entity_t number() const noexcept { return number_; }

 private:
  dds_entity_t number_;
};

struct DeleteQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, DeleteQos>;

Qos qos_of(dds_reliability_kind_t reliability, dds_durability_kind_t durability, std::int32_t depth) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), reliability, DDS_MSECS(10));
  dds_qset_durability(qos.get(), durability);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  return qos;
}

/// Name of a topic in DDS: ROS 2 adds "rt".
std::string dds_name(const std::string& ros_name) { return "rt" + ros_name; }

dds_entity_t make_topic(dds_entity_t participant, const dds_topic_descriptor_t& type,
                        const std::string& name) {
  return checked(dds_create_topic(participant, &type, dds_name(name).c_str(), nullptr, nullptr), name);
}

dds_entity_t make_writer(dds_entity_t participant, const dds_topic_descriptor_t& type,
                         const std::string& name, const Qos& qos) {
  return checked(dds_create_writer(participant, make_topic(participant, type, name), qos.get(), nullptr),
                 name);
}

std_msgs_msg_dds__Header_ header_at(std::int64_t unix_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  std_msgs_msg_dds__Header_ header;
  header.stamp.sec = static_cast<std::int32_t>(unix_ns / kSecond);
  header.stamp.nanosec = static_cast<std::uint32_t>(unix_ns % kSecond);
  header.frame_id = const_cast<char*>(kFrame);  // writers do not change it
  return header;
}

geometry_msgs_msg_dds__Vector3_ plain(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// A sequence for a writer, in memory of `items`.
template <typename Sequence, typename Item>
Sequence sequence_of(std::span<Item> items) {
  Sequence sequence{};
  sequence._maximum = sequence._length = static_cast<std::uint32_t>(items.size());
  sequence._buffer = items.data();
  return sequence;
}

class CycloneTopics final : public HandTopics {
 public:
  CycloneTopics(dds_entity_t participant, const std::string& prefix, const std::vector<std::string>& joints)
      : names_(joints), angles_(joints.size()) {
    for (std::string& name : names_) name_pointers_.push_back(name.data());
    const Qos live = qos_of(DDS_RELIABILITY_RELIABLE, DDS_DURABILITY_VOLATILE, kDepth);
    const Qos latched = qos_of(DDS_RELIABILITY_RELIABLE, DDS_DURABILITY_TRANSIENT_LOCAL, 1);
    pose_ = make_writer(participant, geometry_msgs_msg_dds__PoseStamped__desc, prefix + "/pose", live);
    wrench_ = make_writer(participant, geometry_msgs_msg_dds__WrenchStamped__desc, prefix + "/wrench", live);
    fault_ = make_writer(participant, std_msgs_msg_dds__String__desc, prefix + "/fault", latched);
    if (joints.empty()) return;
    joints_ = make_writer(participant, sensor_msgs_msg_dds__JointState__desc, prefix + "/joint_states", live);
  }

  std::size_t publish(const HandSample& sample, std::span<const double> joints) noexcept override {
    const std_msgs_msg_dds__Header_ header = header_at(sample.unix_ns);
    const Vec3& p = sample.pose.position;
    const Quat& q = sample.pose.rotation;
    const geometry_msgs_msg_dds__PoseStamped_ pose{header,
                                                   {{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}}};
    const geometry_msgs_msg_dds__WrenchStamped_ wrench{header, {plain(sample.force), plain(sample.torque)}};
    std::size_t done = 0;
    done += dds_write(pose_, &pose) == DDS_RETCODE_OK ? 1 : 0;
    done += dds_write(wrench_, &wrench) == DDS_RETCODE_OK ? 1 : 0;
    if (joints_ == 0) return done;
    std::copy_n(joints.begin(), std::min(joints.size(), angles_.size()), angles_.begin());
    sensor_msgs_msg_dds__JointState_ state{};
    state.header = header;
    state.name = sequence_of<dds_sequence_string>(std::span(name_pointers_));
    state.position = sequence_of<dds_sequence_double>(std::span(angles_));
    done += dds_write(joints_, &state) == DDS_RETCODE_OK ? 1 : 0;
    return done;
  }

  bool publish_fault(const char* name) noexcept override {
    std_msgs_msg_dds__String_ message;
    message.data = const_cast<char*>(name);  // writers do not change it
    return dds_write(fault_, &message) == DDS_RETCODE_OK;
  }

  void wait_for_receipt(std::int64_t limit_ns) noexcept override {
    const dds_time_t until = dds_time() + limit_ns;
    for (const dds_entity_t writer : {pose_, wrench_, fault_, joints_}) {
      if (writer != 0) dds_wait_for_acks(writer, std::max<dds_duration_t>(0, until - dds_time()));
    }
  }

 private:
  std::vector<std::string> names_;
  std::vector<char*> name_pointers_;
  std::vector<double> angles_;
  dds_entity_t pose_ = 0;
  dds_entity_t wrench_ = 0;
  dds_entity_t fault_ = 0;
  dds_entity_t joints_ = 0;  // 0: the tool has no jaws
};

class CycloneSubscription final : public Subscription {
 public:
  CycloneSubscription(dds_entity_t participant, const std::string& topic, PoseListener& listener)
      : listener_(listener), reader_(make_reader(participant, topic)) {}

  [[nodiscard]] bool has_publisher() const noexcept override {
    dds_subscription_matched_status_t status{};
    return dds_get_subscription_matched_status(reader_.number(), &status) == DDS_RETCODE_OK &&
           status.current_count > 0;
  }

 private:
  dds_entity_t make_reader(dds_entity_t participant, const std::string& topic) {
    const Qos qos = qos_of(DDS_RELIABILITY_BEST_EFFORT, DDS_DURABILITY_VOLATILE, kPoseDepth);
    const std::unique_ptr<dds_listener_t, void (*)(dds_listener_t*)> calls(dds_create_listener(this),
                                                                           &dds_delete_listener);
    dds_lset_data_available(calls.get(), [](dds_entity_t reader, void* self) {
      static_cast<CycloneSubscription*>(self)->take(reader);
    });
    dds_lset_subscription_matched(
        calls.get(), [](dds_entity_t, const dds_subscription_matched_status_t status, void* self) {
          if (status.current_count > 0) return;
          static_cast<CycloneSubscription*>(self)->listener_.on_loss("its publisher has gone");
        });
    return checked(dds_create_reader(participant,
                                     make_topic(participant, geometry_msgs_msg_dds__PoseStamped__desc, topic),
                                     qos.get(), calls.get()),
                   topic);
  }

  /// Passes on all poses that have arrived.
  void take(dds_entity_t reader) noexcept {
    for (;;) {
      std::array<void*, kTakenAtOnce> samples{};
      std::array<dds_sample_info_t, kTakenAtOnce> infos{};
      const dds_return_t count = dds_take(reader, samples.data(), infos.data(), kTakenAtOnce,
                                          static_cast<std::uint32_t>(kTakenAtOnce));
      if (count <= 0) return;
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        if (!infos[i].valid_data) continue;  // a publisher has gone
        const auto& pose = static_cast<const geometry_msgs_msg_dds__PoseStamped_*>(samples[i])->pose;
        const geometry_msgs_msg_dds__Quaternion_& q = pose.orientation;
        listener_.on_pose(
            {Vec3(pose.position.x, pose.position.y, pose.position.z), Quat(q.w, q.x, q.y, q.z)});
      }
      dds_return_loan(reader, samples.data(), count);
    }
  }

  PoseListener& listener_;
  Entity reader_;
};

class CycloneNode final : public Node {
 public:
  explicit CycloneNode(const NodeOptions& options)
      : domain_(options),
        participant_(
            checked(dds_create_participant(options.domain, nullptr, nullptr), "no DDS participant")) {}

  std::unique_ptr<HandTopics> advertise(const std::string& prefix,
                                        const std::vector<std::string>& joints) override {
    return std::make_unique<CycloneTopics>(participant_.number(), prefix, joints);
  }

  std::unique_ptr<Subscription> subscribe(const std::string& topic, PoseListener& listener) override {
    return std::make_unique<CycloneSubscription>(participant_.number(), topic, listener);
  }

 private:
  DomainUse domain_;
  Entity participant_;
};

}  // namespace
}  // namespace palpate::ros

/// [setup] A node, to be deleted by the caller. @throws std::runtime_error
extern "C" palpate::ros::Node* palpate_make_ros_node(const palpate::ros::NodeOptions& options) {
  return new palpate::ros::CycloneNode(options);
}
