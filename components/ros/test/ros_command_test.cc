// `palpate ros`, and the device "ros", with a second DDS program.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

#include "ros/test/ros_peer.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;

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
    for (const auto& [stamp, stamped] : run_->hands[hand].messages) {
      const PoseAndWrench& message = stamped;
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
    if (!message.joints) continue;  // lost on a busy machine
    EXPECT_EQ(*message.joints, (std::vector<double>{0.0, 0.0})) << "closed in a press";
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

/// Two hands whose poses come from topics. The second one's name is in the scene.
const char* const kFollowers = R"([scene]
name = "followers"
[organ]
mesh = "gallbladder"
[[tool]]
mesh = "sphere:3"
[[tool]]
mesh = "sphere:3"
[[device]]
kind = "ros"
[[device]]
kind = "ros"
path = "/other/hand"
[noise]
enabled = false
)";

RosPose message_of(const Vec3& position, const Quat& q) {
  RosPose message{};
  message.pose = {{position.x(), position.y(), position.z()}, {q.x(), q.y(), q.z(), q.w()}};
  return message;
}

/// A run that a publisher leads. Hand 0 presses along the default path, then `mishap` happens and its poses
/// end. Hand 1 rests 100 mm above.
struct LedRun {
  record::Recording recording;
  Outcome outcome;
  std::vector<std::string> faults;  // of hand 0, as published
  double pressed_s = 0.0;           // time of the run from which the mishap happened, at the earliest
};

LedRun lead(const std::function<void(RosPoseWriter&, const RosPose&)>& mishap) {
  constexpr double kStill = 0.8;    // s: the force of a held device waits for rest, and rises in 0.5 s
  constexpr double kSpeed = 5.0;    // of the default path
  constexpr double kPressed = 0.2;  // s of rest at the deepest point
  const Folder folder;
  std::ofstream(folder / "scene.toml") << kFollowers;
  scene::Overrides request;
  request.scene = folder / "scene.toml";
  const scene::ToolPath path = scene::default_path(scene::load(request), 0).faster(kSpeed);
  const auto deepest =
      std::min_element(path.rows().begin(), path.rows().end(),
                       [](const auto& a, const auto& b) { return a.position.z() < b.position.z(); });
  const RosPeer peer;
  RosPoseWriter hand(peer, "rt/palpate/hand0/target_pose");
  RosPoseWriter other(peer, "rt/other/hand");
  RosReader<RosPose> poses(peer, "rt/palpate/hand0/pose");
  RosReader<RosText> faults(peer, "rt/palpate/hand0/fault");
  LedRun run;
  Program program(folder.path(), {"ros", "scene.toml", "--duration-s", "2", "--record", "run.h5"},
                  {{"ROS_DOMAIN_ID", peer.domain()}});
  std::optional<std::chrono::steady_clock::time_point> began;
  bool ended = false;
  while (!program.ended()) {
    poses.take([&began](const RosPose&) {
      if (!began) began = std::chrono::steady_clock::now();
    });
    faults.take([&run](const RosText& text) { run.faults.emplace_back(text.data); });
    const double time =
        began ? std::chrono::duration<double>(std::chrono::steady_clock::now() - *began).count() : 0.0;
    const scene::PathRow row = path.at(std::clamp(time - kStill, 0.0, deepest->time));
    const RosPose message = message_of(row.position, row.orientation);
    if (time < kStill + deepest->time + kPressed) {
      hand.write(message);
    } else if (!std::exchange(ended, true)) {
      run.pressed_s = kStill + deepest->time;
      mishap(hand, message);
    }
    other.write(
        message_of(path.rows().front().position + Vec3(0.0, 0.0, 0.1), path.rows().front().orientation));
    std::this_thread::sleep_for(10ms);
  }
  run.outcome = program.wait();
  faults.take([&run](const RosText& text) { run.faults.emplace_back(text.data); });
  if (run.outcome.exit_code == 0 || run.outcome.exit_code == 3) {
    run.recording = record::read_recording(folder / "run.h5");
  }
  return run;
}

/// Time of the first row of a hand with a fault [s]; infinity: none.
double fault_time(const LedRun& run, std::uint32_t hand) {
  for (const haptics::TickRow& row : run.recording.rows) {
    if (row.hand == hand && row.fault != 0) return row.time;
  }
  return std::numeric_limits<double>::infinity();
}

/// Leads again when this machine was too busy to send poses in time, so that a hand had a fault too early.
LedRun lead_in_time(const std::function<void(RosPoseWriter&, const RosPose&)>& mishap) {
  for (int attempt = 0;; ++attempt) {
    LedRun run = lead(mishap);
    const bool early = fault_time(run, 0) < run.pressed_s || fault_time(run, 1) < 1e9;
    if (!early || attempt == 4) return run;
  }
}

/// Checks that hand 0 pressed, and that its force is zero 10 ms after a fault and from then on.
void expect_press_and_fault(const LedRun& run, haptics::Fault fault) {
  constexpr std::size_t kFallTicks = 10;
  ASSERT_EQ(run.outcome.exit_code, 3) << run.outcome.err;
  double strongest = 0.0;
  std::size_t rows = 0;
  std::set<std::uint32_t> faults;
  for (const haptics::TickRow& row : run.recording.rows) {
    if (row.hand == 1) {
      EXPECT_EQ(row.fault, 0u) << "the other hand's poses went on";
      continue;
    }
    const double force = std::hypot(row.force[0], row.force[1], row.force[2]);
    ASSERT_TRUE(std::isfinite(force) && std::isfinite(row.tool[0] + row.tool[1] + row.tool[2]));
    strongest = std::max(strongest, force);
    if (row.fault == 0) continue;
    faults.insert(row.fault);
    if (++rows < kFallTicks) continue;
    ASSERT_EQ(force, 0.0) << row.time;
  }
  EXPECT_GT(strongest, 0.1) << "N";
  EXPECT_GT(rows, 100u);
  EXPECT_EQ(faults, (std::set<std::uint32_t>{static_cast<std::uint32_t>(fault)}));
  ASSERT_FALSE(run.faults.empty());
  EXPECT_EQ(run.faults.front(), "none");
  EXPECT_EQ(run.faults.back(), haptics::name_of(fault));
}

TEST(RosHand, TheToolFollowsThePosesAndSilenceIsAFaultWithZeroForce) {
  const LedRun run = lead_in_time([](RosPoseWriter&, const RosPose&) {});
  expect_press_and_fault(run, haptics::Fault::kStale);
  scene::Overrides request;
  request.scene_text = scene::SceneText{kFollowers, {}};
  const scene::ToolPath path = scene::default_path(scene::load(request), 0);
  // Interpolation between poses of the path stays within a millimetre of it.
  double lowest = path.rows().front().position.z();
  for (const haptics::TickRow& row : run.recording.rows) {
    if (row.hand != 0) continue;
    EXPECT_NEAR(row.tool[0], path.rows().front().position.x(), 1e-3);
    EXPECT_LE(row.tool[2], path.rows().front().position.z() + 1e-3);
    lowest = std::min(lowest, row.tool[2]);
  }
  EXPECT_NEAR(path.rows().front().position.z() - lowest, 0.022, 1e-3) << "m: 10 above, 12 deep";
}

TEST(RosHand, AHostilePublisherDoesNoHarm) {
  const LedRun run = lead_in_time([](RosPoseWriter& hand, const RosPose& good) {
    hand.write(good, std::string(1'000'000, 'x'));  // too long: it is dropped
    hand.write(good, std::string(60'000, '%'));
    for (const double value : {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(), 1e300, -1e300, 0.0}) {
      RosPose bad = good;
      bad.pose.orientation.w = value;
      hand.write(bad);
      bad = good;
      bad.pose.position.z = value;
      bad.header.stamp = {std::numeric_limits<std::int32_t>::min(),
                          std::numeric_limits<std::uint32_t>::max()};
      hand.write(bad);
    }
  });
  expect_press_and_fault(run, haptics::Fault::kDevice);
  EXPECT_NE(run.outcome.err.find("/palpate/hand0/target_pose: "), std::string::npos) << run.outcome.err;
  EXPECT_LT(run.outcome.err.size(), 4000u);
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
  EXPECT_NE(refused({"--device", "ros:/9"}).find("device ros: \"/9\": must be a topic"), std::string::npos);
  EXPECT_NE(refused({"--device", "mouse"}).find("needs the window"), std::string::npos);
}

}  // namespace
}  // namespace palpate::tests
