#include "run/devices/haply.h"

#include <chrono>
#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/haptics/test/test_world.h"
#include "io/system/clock.h"
#include "io/websocket/test/haply_service.h"
#include "palpate/error.h"
#include "run/devices/devices.h"
#include "run/realtime/loop.h"

namespace palpate::devices {
namespace {

using haptics::DeviceState;
using haptics::Fault;
using nlohmann::json;
using test::Answer;
using test::HaplyService;
using test::one_arm;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::int64_t kMillisecond = 1'000'000;      // ns
constexpr std::int64_t kForever = 3'600'000'000'000;  // ns

/// Waits up to 20 s for a condition, far longer than it needs. @return whether the condition became true
bool eventually(const std::function<bool()>& holds) {
  const std::int64_t end = monotonic_ns() + 20'000 * kMillisecond;
  while (!holds()) {
    if (monotonic_ns() > end) return false;
    sleep_until_ns(monotonic_ns() + kMillisecond);
  }
  return true;
}

/// Time limits so long that none expires in a test, however slow the machine is.
HaplyTimes patient() {
  HaplyTimes times;
  times.opening = 20'000 * kMillisecond;
  times.reply = kForever;
  times.retry = 20 * kMillisecond;
  times.write_timeout = kForever;
  return times;
}

DeviceState read(HaplyDevice& device) { return device.read(0, 0.0); }

bool pushed_arm(HaplyDevice& device, const Vec3& force) { return device.write({force, Vec3::Zero(), 0.0}); }

std::string opening_error(const std::string& address, std::size_t place = 0, HaplyTimes times = patient()) {
  try {
    const HaplyDevice device(address, place, times);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

TEST(Haply, GivesTheServicesNewestStateAndPassesTheForceOn) {
  HaplyService service(one_arm(Vec3::Zero()), [](std::size_t command) {
    return Answer{one_arm(Vec3(1e-3 * static_cast<double>(std::min<std::size_t>(command, 50)), 0.0, 0.0))};
  });
  HaplyDevice device(service.address(), 0, patient());
  EXPECT_EQ(device.last_tick(1000.0), ~std::uint64_t{0});
  EXPECT_EQ(device.description(), "Inverse3 04BA at " + service.address());
  EXPECT_TRUE(eventually([&] { return read(device).position_D.x() == 0.05; }));
  EXPECT_EQ(service.force(), Vec3::Zero()) << "before the first write()";
  EXPECT_TRUE(pushed_arm(device, Vec3(1.0, 2.0, -3.5)));
  EXPECT_TRUE(eventually([&] { return service.force() == Vec3(1.0, 2.0, -3.5); }));
  EXPECT_EQ(read(device).fault, Fault::kNone);
  EXPECT_TRUE(eventually([&] { return read(device).age < 0.5; }));
  EXPECT_EQ(device.last_error(), "");
  EXPECT_EQ(service.connections(), 1U);
}

TEST(Haply, SendsZeroWhenTheLoopWritesNoMore) {
  HaplyService service(one_arm());
  HaplyTimes times = patient();
  times.write_timeout = 50 * kMillisecond;
  HaplyDevice device(service.address(), 0, times);
  // Repeats until one force arrives. On a busy machine a force may be too old when the device reads it.
  EXPECT_TRUE(
      eventually([&] { return pushed_arm(device, Vec3(1.0, 0.0, 0.0)) && service.force().x() == 1.0; }));
  EXPECT_TRUE(eventually([&] { return service.force() == Vec3::Zero(); }));
}

TEST(Haply, StopSendsZeroUntilTheNextWrite) {
  HaplyService service(one_arm());
  HaplyDevice device(service.address(), 0, patient());
  pushed_arm(device, Vec3(0.0, 1.0, 0.0));
  EXPECT_TRUE(eventually([&] { return service.force().y() == 1.0; }));
  std::thread other([&] {
    device.stop();
    device.stop();
  });
  other.join();
  EXPECT_TRUE(eventually([&] { return service.force() == Vec3::Zero(); }));
  pushed_arm(device, Vec3(0.0, 2.0, 0.0));
  EXPECT_TRUE(eventually([&] { return service.force().y() == 2.0; }));
}

TEST(Haply, ZeroForceDoesNotWaitForAReply) {
  std::atomic<bool> silent{false};
  HaplyService service(one_arm(),
                       [&](std::size_t) { return silent ? Answer{std::nullopt} : Answer{one_arm()}; });
  HaplyDevice device(service.address(), 0, patient());
  pushed_arm(device, Vec3(0.0, 0.0, 3.0));
  EXPECT_TRUE(eventually([&] { return service.force().z() == 3.0; }));
  silent = true;
  std::size_t sent = 0;
  EXPECT_TRUE(eventually([&] {  // all commands under way have arrived
    const bool still = service.received().size() == sent && read(device).age > 0.05;
    sent = service.received().size();
    return still;
  }));
  EXPECT_EQ(service.force().z(), 3.0);
  device.stop();
  EXPECT_TRUE(eventually([&] { return service.force() == Vec3::Zero(); }));
}

TEST(Haply, AForceThatIsNotFiniteIsRefusedAndZeroIsSent) {
  HaplyService service(one_arm());
  HaplyDevice device(service.address(), 0, patient());
  pushed_arm(device, Vec3(1.0, 0.0, 0.0));
  EXPECT_TRUE(eventually([&] { return service.force().x() == 1.0; }));
  EXPECT_FALSE(pushed_arm(device, Vec3(std::nan(""), 0.0, 0.0)));
  EXPECT_TRUE(eventually([&] { return service.force() == Vec3::Zero(); }));
}

TEST(Haply, ASlowServiceLetsTheSampleAge) {
  HaplyService service(one_arm(), [](std::size_t) {
    sleep_until_ns(monotonic_ns() + 30 * kMillisecond);
    return Answer{one_arm()};
  });
  HaplyDevice device(service.address(), 0, patient());
  EXPECT_TRUE(eventually([&] { return read(device).age > 0.02; }));
  EXPECT_TRUE(eventually([&] { return service.received().size() > 3; })) << "one after the other";
  EXPECT_EQ(read(device).fault, Fault::kNone);
  EXPECT_EQ(device.last_error(), "");
}

TEST(Haply, ASilentServiceLetsTheSampleAgeAndIsGivenUpInTheEnd) {
  HaplyService service(one_arm(), [](std::size_t) { return Answer{std::nullopt}; });
  HaplyTimes times = patient();
  times.reply = 300 * kMillisecond;
  HaplyDevice device(service.address(), 0, times);
  EXPECT_TRUE(eventually([&] { return read(device).age > 0.05; }));
  EXPECT_TRUE(eventually([&] { return read(device).fault == Fault::kDevice; }));
  EXPECT_THAT(device.last_error(), HasSubstr("the service gave no reply for 300 ms"));
  EXPECT_TRUE(eventually([&] { return service.connections() >= 2; })) << "it tries again";
}

TEST(Haply, AMalformedReplyIsADeviceFaultInWordsUntilTheNextGoodOne) {
  json no_velocity = json::parse(one_arm());
  no_velocity["inverse3"][0]["state"].erase("cursor_velocity");
  json null = json::parse(one_arm());
  null["inverse3"][0]["state"]["cursor_position"]["y"] = nullptr;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "is no JSON"},
      {"{\"inverse3\": [{\"device_id\"", "line 1, byte"},
      {"{\"inverse3\": [{\"state\": {\"cursor_position\": {\"x\": NaN}}}]}", "is no JSON"},
      {std::string("\0{}", 3), "is no JSON"},
      {"[]", "must be a JSON object"},
      {"{}", "inverse3 \"04BA\": missing"},
      {no_velocity.dump(), "inverse3[0].state.cursor_velocity.x: missing"},
      {null.dump(), "inverse3[0].state.cursor_position.y: missing"}};
  std::atomic<std::size_t> which{cases.size()};
  HaplyService service(
      one_arm(), [&](std::size_t) { return Answer{which < cases.size() ? cases[which].first : one_arm()}; });
  HaplyDevice device(service.address(), 0, patient());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    which = i;
    ASSERT_TRUE(eventually([&] { return read(device).fault == Fault::kDevice; })) << cases[i].second;
    EXPECT_THAT(device.last_error(), AllOf(StartsWith(service.address()), HasSubstr(cases[i].second)));
    EXPECT_EQ(read(device).position_D, Vec3(0.01, 0.02, 0.03)) << "the last good one";
    which = cases.size();
    ASSERT_TRUE(eventually([&] { return read(device).fault == Fault::kNone; })) << cases[i].second;
  }
  EXPECT_EQ(service.connections(), 1U);
}

/// The service gives the answer `last` in mid-run. Its second connection works.
void expect_fault_and_recovery(const Answer& last, const std::string& words) {
  std::atomic<bool> now{false};
  HaplyService service(one_arm(),
                       [&](std::size_t) { return now.exchange(false) ? last : Answer{one_arm()}; });
  HaplyDevice device(service.address(), 0, patient());
  EXPECT_TRUE(eventually([&] { return service.received().size() > 2; }));
  service.hold_back(true);
  now = true;
  EXPECT_TRUE(eventually([&] { return read(device).fault == Fault::kDevice; })) << words;
  EXPECT_THAT(device.last_error(), HasSubstr(words));
  EXPECT_EQ(read(device).position_D, Vec3(0.01, 0.02, 0.03)) << "the last good one";
  service.hold_back(false);
  EXPECT_TRUE(eventually([&] { return read(device).fault == Fault::kNone; })) << words;
  EXPECT_EQ(service.connections(), 2U);
  EXPECT_EQ(service.force(), Vec3::Zero()) << "nothing was written";
}

TEST(Haply, AServiceThatClosesInMidRunIsAFaultAndConnectedToAgain) {
  expect_fault_and_recovery({std::nullopt, Answer::Then::kClose}, "the service closed the connection");
}

TEST(Haply, AConnectionThatBreaksOffIsAFaultAndMadeAgain) {
  expect_fault_and_recovery({std::nullopt, Answer::Then::kBreakOff}, "the connection broke off");
}

TEST(Haply, ATextThatIsNotUtf8EndsTheConnection) {
  expect_fault_and_recovery({"{\"\xff\": 1}"}, "not valid utf8");
}

TEST(Haply, AHugeMessageIsNotTaken) {
  expect_fault_and_recovery({std::string(websocket::Client::kLargestMessage + 1, ' '), Answer::Then::kGoOn},
                            "the service sent a message of more than 1048576 bytes");
}

TEST(Haply, AServiceThatIsGoneIsReportedInWords) {
  std::optional<HaplyService> service(std::in_place, one_arm());
  HaplyDevice device(service->address(), 0, patient());
  service.reset();
  EXPECT_TRUE(eventually([&] { return device.last_error().find("connection refused") != std::string::npos; }))
      << device.last_error();
  EXPECT_EQ(read(device).fault, Fault::kDevice);
  EXPECT_TRUE(pushed_arm(device, Vec3(1.0, 0.0, 0.0))) << "the sample says that it is gone";
  device.stop();
}

TEST(Haply, AnotherArmThanBeforeIsNotTaken) {
  std::atomic<bool> closes{false};
  HaplyService service(one_arm(), [&](std::size_t) {
    if (closes) return Answer{std::nullopt, Answer::Then::kClose};
    return Answer{one_arm()};
  });
  HaplyDevice device(service.address(), 0, patient());
  service.greet_with(json{{"inverse3", {test::arm_json("0001", Vec3::Zero())}}}.dump());
  closes = true;
  EXPECT_TRUE(eventually([&] {
    return device.last_error().find("inverse3 \"04BA\": missing") != std::string::npos;
  })) << device.last_error();
  EXPECT_EQ(read(device).fault, Fault::kDevice);
  EXPECT_EQ(read(device).position_D, Vec3(0.01, 0.02, 0.03)) << "the last good one";
}

TEST(Haply, AnArmWithoutPowerHasItsForceOff) {
  json off = json::parse(one_arm());
  off["inverse3"][0]["status"]["power_supply"] = false;
  HaplyService service(one_arm(), [&](std::size_t) { return Answer{off.dump()}; });
  HaplyDevice device(service.address(), 0, patient());
  EXPECT_TRUE(eventually([&] { return read(device).fault == Fault::kForceOff; }));
  EXPECT_THAT(device.last_error(), HasSubstr("Inverse3 04BA: it has no power supply"));
}

TEST(Haply, TheDestructorSendsZeroAndSaysFarewell) {
  HaplyService service(one_arm());
  {
    HaplyDevice device(service.address(), 0, patient());
    pushed_arm(device, Vec3(0.0, 4.0, 0.0));
    EXPECT_TRUE(eventually([&] { return service.force().y() == 4.0; }));
  }
  EXPECT_TRUE(eventually([&] { return service.said_farewell(); }));
  EXPECT_EQ(service.force(), Vec3::Zero());
}

TEST(Haply, TheDestructorDoesNotWaitForASilentService) {
  HaplyService service(one_arm(), [](std::size_t) { return Answer{std::nullopt}; });
  const auto device = std::make_unique<HaplyDevice>(service.address(), 0, patient());
  EXPECT_TRUE(eventually([&] { return service.received().size() == 1; }));
}

TEST(Haply, WhatIsWrongAtTheOpeningIsReportedInWords) {
  std::string gone;
  {
    const HaplyService service(one_arm());
    gone = service.address();
  }
  EXPECT_EQ(opening_error(gone),
            "device haply: no service at " + gone +
                ": connection refused (start Haply's Inverse Service, or give its address "
                "with --device haply:ws://HOST:PORT)");
  const HaplyService declining(one_arm(), nullptr, HaplyService::Manner::kDeclines);
  EXPECT_THAT(opening_error(declining.address()),
              HasSubstr("declines the WebSocket handshake with HTTP status 403"));
  HaplyTimes hasty = patient();
  hasty.opening = 100 * kMillisecond;
  const HaplyService mute(one_arm(), nullptr, HaplyService::Manner::kMute);
  EXPECT_THAT(opening_error(mute.address(), 0, hasty),
              HasSubstr("no answer to the WebSocket handshake within 100 ms"));
  hasty.opening = 1000 * kMillisecond;
  const HaplyService silent("");
  EXPECT_THAT(opening_error(silent.address(), 0, hasty),
              HasSubstr("the service sent nothing within 1000 ms of the handshake"));
  const HaplyService garbled("{");
  EXPECT_THAT(opening_error(garbled.address()), AllOf(HasSubstr(garbled.address()), HasSubstr("is no JSON")));
  const HaplyService huge(std::string(websocket::Client::kLargestMessage + 1, ' '));
  EXPECT_THAT(opening_error(huge.address()), HasSubstr("a message of more than 1048576 bytes"));
  const HaplyService empty("{\"inverse3\": [], \"verse_grip\": []}");
  EXPECT_THAT(opening_error(empty.address()), HasSubstr("the service has no Inverse3"));
  const HaplyService one(one_arm());
  EXPECT_THAT(opening_error(one.address(), 1), HasSubstr("the service has no Inverse3 number 2, only 04BA"));
}

TEST(Haply, AnAddressMustBeOne) {
  EXPECT_EQ(parse_haply_address("").text(), "ws://localhost:10001");
  EXPECT_EQ(parse_haply_address("ws://lab-3.example:80/").text(), "ws://lab-3.example:80");
  EXPECT_EQ(parse_haply_address("ws://[::1]:10001").host, "::1");
  EXPECT_EQ(parse_haply_address("ws://[::1]:10001").text(), "ws://[::1]:10001");
  EXPECT_EQ(
      opening_error("localhost:10001"),
      "device haply: address \"localhost:10001\": does not begin with ws://, must be ws://HOST:PORT, as in "
      "ws://localhost:10001");
  EXPECT_THAT(opening_error("wss://localhost:10001"), HasSubstr("does not begin with ws://"));
  EXPECT_THAT(opening_error("ws://localhost"), HasSubstr("has no port"));
  EXPECT_THAT(opening_error("ws://[::1]"), HasSubstr("has no port"));
  for (const char* port : {"", "0", "65536", "-1", "80x", "10001/service"}) {
    EXPECT_THAT(opening_error(std::string("ws://localhost:") + port),
                HasSubstr("its port is no number from 1 to 65535"));
  }
  EXPECT_THAT(opening_error("ws://:80"), HasSubstr("has no host"));
  EXPECT_THAT(opening_error("ws://a b:80"), HasSubstr("has no host"));
  EXPECT_THAT(opening_error("ws://::1:80"), HasSubstr("has a colon in its host"));
  EXPECT_THAT(opening_error("ws://[name]:80"), HasSubstr("has a name in brackets"));
  const std::string too_long(300, 'a');
  EXPECT_THAT(opening_error("ws://" + too_long + ":80"), HasSubstr("there is no host \"" + too_long + "\""));
}

TEST(Haply, TwoHandsTakeTheServicesArmsAndGripsInOrder) {
  const Quat turned(0.0, 1.0, 0.0, 0.0);
  const std::string both =
      json{{"inverse3", {test::arm_json("L", Vec3(-0.1, 0, 0)), test::arm_json("R", Vec3(0.1, 0, 0))}},
           {"wireless_verse_grip",
            {test::grip_json("g", Quat::Identity(), false), test::grip_json("h", turned, true)}}}
          .dump();
  HaplyService service(both, [&](std::size_t) { return Answer{both}; });
  scene::Scene scene;
  scene.devices.push_back({"haply", service.address(), 1.0, {}});
  scene.devices.push_back({"haply", service.address() + "/", 1.0, {}});
  const auto left = open_device(scene, 0);
  const auto right = open_device(scene, 1);
  EXPECT_EQ(dynamic_cast<const HaplyDevice&>(*right).description(),
            "Inverse3 R with verse grip h at " + service.address());
  const DeviceState first = left->read(0, 0.0);
  const DeviceState second = right->read(0, 0.0);
  EXPECT_EQ(first.position_D, Vec3(-0.1, 0, 0));
  EXPECT_EQ(second.position_D, Vec3(0.1, 0, 0));
  EXPECT_EQ(first.orientation_D.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(second.orientation_D.coeffs(), turned.coeffs());
  EXPECT_EQ(first.gripper, 1.0);
  EXPECT_EQ(second.gripper, 0.0);
  EXPECT_EQ(second.buttons, 1U);
  EXPECT_TRUE(eventually([&] {  // each device commands its own arm
    std::size_t lefts = 0;
    const auto received = service.received();
    for (const auto& command : received) lefts += command.arm == "L" ? 1 : 0;
    return lefts > 0 && lefts < received.size();
  }));
}

TEST(Haply, TheProbeListsWhatIsThereOrSaysWhyNothingIs) {
  const std::string all =
      json{{"inverse3", {test::arm_json("L", Vec3::Zero()), test::arm_json("R", Vec3::Zero())}},
           {"wireless_verse_grip", {test::grip_json("g", Quat::Identity(), false)}}}
          .dump();
  std::string address;
  {
    const HaplyService service(all);
    address = service.address();
    const Probe found = probe_haply(address);
    EXPECT_EQ(found.kind, "haply");
    EXPECT_TRUE(found.available);
    EXPECT_EQ(found.text, "at " + address + ": Inverse3 L, R; verse grip g");
  }
  const Probe gone = probe_haply(address);
  EXPECT_FALSE(gone.available);
  EXPECT_THAT(gone.text, AllOf(StartsWith("no service at " + address + ": connection refused"),
                               HasSubstr("--device haply:ws://HOST:PORT")));
  const HaplyService empty("{}");
  EXPECT_EQ(probe_haply(empty.address()).text, "the service at " + empty.address() + " has no Inverse3");
  const HaplyService garbled("{");
  EXPECT_FALSE(probe_haply(garbled.address()).available);
  EXPECT_THAT(probe_haply(garbled.address()).text, HasSubstr("is no JSON"));
  EXPECT_FALSE(probe_haply("nonsense").available);
  EXPECT_THAT(probe_haply("nonsense").text, HasSubstr("must be ws://HOST:PORT"));
}

/// Keeps all rows, and the monotonic time [ns] of the first tick.
class StartKeeper final : public haptics::TickObserver {
 public:
  StartKeeper(std::size_t expected, std::atomic<std::int64_t>& start) : rows_(expected), start_(start) {}
  void on_start(std::int64_t /*unix_ns*/) noexcept override { start_ = monotonic_ns(); }
  void on_row(const haptics::TickRow& row) noexcept override { rows_.on_row(row); }
  [[nodiscard]] const std::vector<haptics::TickRow>& rows() const { return rows_.rows; }

 private:
  haptics::test::RowKeeper rows_;
  std::atomic<std::int64_t>& start_;
};

TEST(Haply, ALoopRunsWithItAndLeavesItWithoutForce) {
  // The arm moves from 2 mm above the block down to 2 mm of depth within 0.2 s of the start.
  std::atomic<std::int64_t> start{kForever};
  const auto lowering = [&](std::size_t) {
    const double time = 1e-9 * static_cast<double>(std::max<std::int64_t>(0, monotonic_ns() - start));
    const double height = std::max(-2e-3, 2e-3 - 20e-3 * time);
    return Answer{one_arm(Vec3(0.001, 0.002, haptics::test::kBallRadius + height))};
  };
  HaplyService service(*lowering(0).text, lowering);
  const haptics::SimulationWorld world = haptics::test::block_and_balls(1, 1000.0, haptics::test::no_noise());
  haptics::SimulationState state(world);
  HaplyDevice device(service.address(), 0);
  haptics::Device* devices[] = {&device};
  StartKeeper keeper(300, start);
  const haptics::LoopReport report =
      realtime::run_loop(world, state, devices, {&keeper}, {.ticks = 300, .offline = false});
  EXPECT_EQ(report.ticks, 300U);
  const std::vector<haptics::TickRow>& rows = keeper.rows();
  ASSERT_EQ(rows.size(), 300U);
  EXPECT_TRUE(eventually([&] { return service.force() == Vec3::Zero(); }));
  // A busy machine may make a sample late, which is a fault. Without a fault the force has arrived.
  double pushed = 0.0;
  for (const auto& command : service.received()) pushed = std::max(pushed, command.force.z());
  double written = 0.0;
  for (const auto& row : rows) written = std::max(written, row.force[2]);
  EXPECT_LE(pushed, written);
  if (report.fault == Fault::kNone && report.missed_deadlines == 0) {
    EXPECT_LT(rows.back().device[2], haptics::test::kBallRadius);
    EXPECT_GT(rows.back().tissue_force, 0.0);
    EXPECT_GT(pushed, 0.0);
  }
}

}  // namespace
}  // namespace palpate::devices
