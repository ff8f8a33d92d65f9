// `palpate ros`, and the device "ros", with a second DDS program.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/recording.h"

#include "tests/program.h"
#include "tests/ros_peer.h"

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;

/// Waits until `holds` is true; at most as long as a busy machine may take.
template <typename Condition>
bool wait_until(Condition&& holds) {
  for (int i = 0; i < 6000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

/// Instruments press an organ five times faster than by default.
const char* const kTwoHands = R"([scene]
name = "two hands"
[organ]
mesh = "gallbladder"
[[tool]]
mesh = "sphere:3"
[[tool]]
mesh = "curved-forceps"
[[device]]
kind = "scripted"
base = { position_mm = [0, -15, 0] }
[[device]]
kind = "scripted"
base = { position_mm = [0, 15, 0] }
[path]
speed = 5
)";

struct PoseAndWrench {
  std::optional<geometry_msgs_msg_dds__Pose_> pose;
  std::optional<geometry_msgs_msg_dds__Wrench_> wrench;
  std::optional<std::vector<double>> joints;
};

std::int64_t stamp_of(const std_msgs_msg_dds__Header_& header) {
  return std::int64_t{1'000'000'000} * header.stamp.sec + header.stamp.nanosec;
}

/// The messages of one run with two hands.
class RosTopics : public ::testing::Test {
 protected:
  struct Hand {
    std::map<std::int64_t, PoseAndWrench> messages;  // by stamp [ns]
    std::set<std::string> frames;
    std::set<std::vector<std::string>> joint_names;
    std::vector<std::string> faults;
  };
  struct Run {
    std::array<Hand, 2> hands;
    std::vector<std::vector<std::uint8_t>> bytes;  // of hand 0's poses, as they were sent
    std::map<std::string, std::string> types;      // of the topics that begin with rt/palpate
    bool keyless = true;
    Outcome outcome;
    record::Recording recording;
  };

  static void SetUpTestSuite() { run_ = new Run(played()); }
  static void TearDownTestSuite() {
    delete run_;
    run_ = nullptr;
  }

  static Run played() {
    const Folder folder;
    std::ofstream(folder / "two.toml") << kTwoHands;
    const RosPeer peer;
    Run run;
    Readers first(peer, 0);
    Readers second(peer, 1);
    RosReader<RosPose> raw(peer, "rt/palpate/hand0/pose");
    Program program(
        folder.path(),
        {"ros", "two.toml", "--publish-rate", "250", "--duration-s", "1", "--record", "run.h5", "--json"},
        {{"ROS_DOMAIN_ID", peer.domain()}});
    const dds_entity_t publications =
        valid(dds_create_reader(peer.participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr));
    while (!program.ended()) {
      first.take(run.hands[0]);
      second.take(run.hands[1]);
      while (auto bytes = raw.take_bytes()) run.bytes.push_back(std::move(*bytes));
      take_types(publications, run);
      std::this_thread::sleep_for(2ms);
    }
    first.take(run.hands[0]);
    second.take(run.hands[1]);
    run.outcome = program.wait();
    run.recording = record::read_recording(folder / "run.h5");
    return run;
  }

  static Run* run_;

 private:
  struct Readers {
    Readers(const RosPeer& peer, int hand)
        : prefix("rt/palpate/hand" + std::to_string(hand)),
          pose(peer, prefix + "/pose"),
          wrench(peer, prefix + "/wrench"),
          joints(peer, prefix + "/joint_states"),
          fault(peer, prefix + "/fault") {}
    void take(Hand& hand) {
      pose.take([&hand](const RosPose& message) {
        hand.messages[stamp_of(message.header)].pose = message.pose;
        hand.frames.insert(message.header.frame_id);
      });
      wrench.take([&hand](const RosWrench& message) {
        hand.messages[stamp_of(message.header)].wrench = message.wrench;
        hand.frames.insert(message.header.frame_id);
      });
      joints.take([&hand](const RosJoints& message) {
        const double* angles = message.position._buffer;
        hand.messages[stamp_of(message.header)].joints.emplace(angles, angles + message.position._length);
        char** names = message.name._buffer;
        hand.joint_names.emplace(names, names + message.name._length);
        EXPECT_EQ(message.velocity._length + message.effort._length, 0u);
      });
      fault.take([&hand](const RosText& message) { hand.faults.emplace_back(message.data); });
    }
    std::string prefix;
    RosReader<RosPose> pose;
    RosReader<RosWrench> wrench;
    RosReader<RosJoints> joints;
    RosReader<RosText> fault;
  };

  static void take_types(dds_entity_t publications, Run& run) {
    void* samples[1] = {nullptr};
    dds_sample_info_t info[1];
    while (dds_take(publications, samples, info, 1, 1) > 0) {
      const auto& found = *static_cast<const dds_builtintopic_endpoint_t*>(samples[0]);
      if (info[0].valid_data && std::string(found.topic_name).rfind("rt/palpate", 0) == 0) {
        run.types[found.topic_name] = found.type_name;
        // The kinds of an entity that writes a keyless topic [DDSI-RTPS 2.3, table 9.1]
        run.keyless = run.keyless && found.key.v[15] == 0x03;
      }
      dds_return_loan(publications, samples, 1);
    }
  }
};

RosTopics::Run* RosTopics::run_ = nullptr;

bool equal(const geometry_msgs_msg_dds__Pose_& pose, const haptics::TickRow& row) {
  const auto& [p, q] = pose;
  return p.x == row.tool[0] && p.y == row.tool[1] && p.z == row.tool[2] && q.w == row.tool_q[0] &&
         q.x == row.tool_q[1] && q.y == row.tool_q[2] && q.z == row.tool_q[3];
}

bool equal(const geometry_msgs_msg_dds__Wrench_& wrench, const haptics::TickRow& row) {
  const auto& [f, t] = wrench;
  return f.x == row.force[0] && f.y == row.force[1] && f.z == row.force[2] && t.x == row.torque[0] &&
         t.y == row.torque[1] && t.z == row.torque[2];
}

TEST_F(RosTopics, PoseAndWrenchWithOneStampAreThoseOfOneRecordedRow) {
  ASSERT_EQ(run_->outcome.exit_code, 0) << run_->outcome.err;
  ASSERT_EQ(run_->recording.rows.size(), 2000u);
  for (std::uint32_t hand = 0; hand < 2; ++hand) {
    std::size_t pairs = 0;
    double strongest = 0.0;
    for (const auto& [stamp, message] : run_->hands[hand].messages) {
      if (!message.pose || !message.wrench) continue;  // lost on a busy machine
      ++pairs;
      strongest = std::max(strongest, std::abs(message.wrench->force.z));
      const auto row = std::find_if(
          run_->recording.rows.begin(), run_->recording.rows.end(), [&](const haptics::TickRow& one) {
            return one.hand == hand && equal(*message.pose, one) && equal(*message.wrench, one);
          });
      ASSERT_NE(row, run_->recording.rows.end()) << "hand " << hand << " at " << stamp;
      const double since_start = 1e-9 * static_cast<double>(stamp - run_->recording.facts.started_unix_ns);
      EXPECT_GE(since_start, row->time - 1e-3) << "wall time";
      EXPECT_LT(since_start, row->time + 60.0) << "wall time, and how late ticks were";
    }
    EXPECT_GE(pairs, 20u) << "some 250, but for a busy machine";
    EXPECT_GT(strongest, 0.1) << "N, while it presses";
    EXPECT_EQ(run_->hands[hand].frames, (std::set<std::string>{"world"}));
  }
}

TEST_F(RosTopics, JawsAreJointsWithTheirAngles) {
  EXPECT_TRUE(run_->hands[0].joint_names.empty()) << "a sphere has no jaws";
  const Hand& forceps = run_->hands[1];
  ASSERT_EQ(forceps.joint_names, (std::set<std::vector<std::string>>{{"hand1_jaw0", "hand1_jaw1"}}));
  for (const auto& [stamp, message] : forceps.messages) {
    if (message.joints) EXPECT_EQ(*message.joints, (std::vector<double>{0.0, 0.0})) << "closed in a press";
  }
}

TEST_F(RosTopics, WithoutAFaultItIsNone) {
  for (const Hand& hand : run_->hands) {
    ASSERT_FALSE(hand.faults.empty());
    EXPECT_EQ(std::set<std::string>(hand.faults.begin(), hand.faults.end()), std::set<std::string>{"none"});
  }
}

TEST_F(RosTopics, NamesAndTypesAreThoseOfRos2AndNoneHasAKey) {
  const std::map<std::string, std::string> types = {
      {"rt/palpate/hand0/pose", "geometry_msgs::msg::dds_::PoseStamped_"},
      {"rt/palpate/hand0/wrench", "geometry_msgs::msg::dds_::WrenchStamped_"},
      {"rt/palpate/hand0/fault", "std_msgs::msg::dds_::String_"},
      {"rt/palpate/hand1/pose", "geometry_msgs::msg::dds_::PoseStamped_"},
      {"rt/palpate/hand1/wrench", "geometry_msgs::msg::dds_::WrenchStamped_"},
      {"rt/palpate/hand1/fault", "std_msgs::msg::dds_::String_"},
      {"rt/palpate/hand1/joint_states", "sensor_msgs::msg::dds_::JointState_"}};
  EXPECT_EQ(run_->types, types);
  EXPECT_TRUE(run_->keyless);
}

// Offsets by hand: representation 4 bytes; sec, nanosec and the length of "world" with its zero 4 each; the
// text 6, then 6 so that the first double is at a multiple of 8 from the representation's end; 7 doubles.
TEST_F(RosTopics, APoseIsSentInRos2sBytes) {
  ASSERT_FALSE(run_->bytes.empty());
  const std::vector<std::uint8_t>& bytes = run_->bytes.back();
  ASSERT_EQ(bytes.size(), 84u);
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + 4),
            (std::vector<std::uint8_t>{0, 1, 0, 0}))
      << "plain CDR, little-endian, no options";
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin() + 12, bytes.begin() + 16),
            (std::vector<std::uint8_t>{6, 0, 0, 0}));
  EXPECT_EQ(std::string(bytes.begin() + 16, bytes.begin() + 22), std::string("world\0", 6));
  std::array<double, 7> numbers{};
  std::memcpy(numbers.data(), bytes.data() + 28, sizeof numbers);
  const auto& [x, y, z, qx, qy, qz, qw] = numbers;
  const geometry_msgs_msg_dds__Pose_ pose{{x, y, z}, {qx, qy, qz, qw}};
  EXPECT_TRUE(
      std::any_of(run_->recording.rows.begin(), run_->recording.rows.end(),
                  [&pose](const haptics::TickRow& row) { return row.hand == 0 && equal(pose, row); }));
}

TEST_F(RosTopics, TheProgramListsTopicsQosAndDomainAndCountsItsMessages) {
  const std::string& err = run_->outcome.err;
  EXPECT_NE(err.find("(ROS_DOMAIN_ID), for programs on this machine only"), std::string::npos) << err;
  for (const char* text :
       {"/palpate/hand0/pose", "geometry_msgs/msg/WrenchStamped", "/palpate/hand1/joint_states",
        "250 Hz, reliable, keep last 10, volatile", "keep last 1, transient local"}) {
    EXPECT_NE(err.find(text), std::string::npos) << text << " in " << err;
  }
  EXPECT_EQ(err.find("hand0/joint_states"), std::string::npos);
  const auto summary = nlohmann::json::parse(run_->outcome.out);
  EXPECT_EQ(summary["ticks"], 1000);
  EXPECT_GE(summary["ros"]["messages"].get<std::size_t>(), run_->hands[0].messages.size());
  EXPECT_EQ(summary["ros"]["failed"], 0);
}

std::string refused(std::vector<std::string> words,
                    const std::map<std::string, std::string>& environment = {}) {
  const Folder folder;
  words.insert(words.begin(), "ros");
  words.insert(words.end(), {"--record", "run.h5"});
  const Outcome outcome = run(folder, words, environment);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(lines(outcome.err), 1u) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_TRUE(folder.names().empty()) << "no file is touched";
  return outcome.err;
}

TEST(RosCommand, BadNetworksAndRatesExitTwoInOneLine) {
  EXPECT_NE(refused({"--network-interface", "eth999"}).find("eth999: does not match an available interface"),
            std::string::npos);
  EXPECT_NE(refused({}, {{"ROS_DOMAIN_ID", "233"}}).find("ROS_DOMAIN_ID = \"233\""), std::string::npos);
  EXPECT_NE(refused({}, {{"CYCLONEDDS_URI", "<wrong/>"}}).find("wrong: unknown element"), std::string::npos);
  EXPECT_NE(refused({"--publish-rate", "0"}).find("--publish-rate"), std::string::npos);
  EXPECT_NE(refused({"--device", "mouse"}).find("needs the window"), std::string::npos);
}

}  // namespace
}  // namespace palpate::tests
