// A server with real clients of the library, and with ones that behave badly.
#include "palpate/net/igtl_server.h"

#include <array>
#include <chrono>
#include <future>
#include <map>
#include <thread>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "palpate/base/clock.h"
#include "palpate/base/error.h"
#include "palpate/geometry/builtin.h"
#include "palpate/haptics/test/test_world.h"
#include "palpate/net/test/igtl_received.h"

namespace palpate::net {
namespace {

using namespace std::chrono_literals;
using test::Client;
using test::Received;
using testing::HasSubstr;

constexpr IgtlAddress kAnyFreePort{"127.0.0.1", 0};

/// A connection by the system's own calls, for what the library's client would never do.
class BareClient final {
 public:
  explicit BareClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const int small = 4096;  // bytes: full soon
    (void)setsockopt(socket_.number(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(static_cast<std::uint16_t>(port));
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_.number(), reinterpret_cast<const sockaddr*>(&where), sizeof where) == 0;
  }
  [[nodiscard]] bool connected() const { return connected_; }
  /// Bytes that came, at most so many; 0: the end.
  [[nodiscard]] ssize_t receive(std::size_t most) {
    Bytes bytes(most);
    return recv(socket_.number(), bytes.data(), bytes.size(), 0);
  }
  /// Sends as much as goes without waiting. @return bytes
  std::size_t send_what_goes(const Bytes& bytes) {
    const ssize_t sent = send(socket_.number(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return sent < 0 ? 0 : static_cast<std::size_t>(sent);
  }
  /// Everything that is there already.
  void receive_what_is_there() {
    Bytes bytes(1 << 16);
    while (recv(socket_.number(), bytes.data(), bytes.size(), MSG_DONTWAIT) > 0) continue;
  }
  void send_no_more() { (void)shutdown(socket_.number(), SHUT_WR); }

 private:
  Descriptor socket_;
  bool connected_ = false;
};

scene::Setup block_setup() {
  scene::Setup setup;
  setup.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  setup.organ_pose.position = Vec3(0, 0, -0.02);
  return setup;
}

/// The same, so finely divided that its surface takes some MB: more than the system's buffers hold.
scene::Setup large_setup() {
  scene::Setup setup = block_setup();
  setup.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.0005);
  return setup;
}

/// One dent per contact, as deep as it is.
std::vector<deform::Indentation> dents(const haptics::Snapshot& snapshot) {
  std::vector<deform::Indentation> all;
  for (int i = 0; i < snapshot.results[0].view_count; ++i) {
    const contact::ContactView& view = snapshot.results[0].views[static_cast<std::size_t>(i)];
    all.push_back({view.point_S, view.direction_S, view.depth, view.tip_radius, 0.0});
  }
  return all;
}

/// As the loop does: tick after tick, each with its number in its pose and force.
void publish(IgtlServer& server, std::uint64_t tick) {
  haptics::Snapshot& snapshot = server.snapshots().writable();
  snapshot = haptics::Snapshot{};
  snapshot.tick = tick;
  snapshot.hands = 1;
  snapshot.tools[0].pose_W.position = Vec3(1e-6 * static_cast<double>(tick), 0, 0.05);
  snapshot.commands[0].force = Vec3(0, 0, static_cast<double>(tick));
  snapshot.results[0].distance = 0.01;
  server.snapshots().publish();
}

/// A loop that publishes every millisecond until it is gone.
class Publisher final {
 public:
  explicit Publisher(IgtlServer& server)
      : thread_([this, &server] {
          for (std::uint64_t tick = 1; !stop_.load(); ++tick) {
            publish(server, tick);
            ticks_.store(tick);
            std::this_thread::sleep_for(1ms);
          }
        }) {}
  ~Publisher() {
    stop_.store(true);
    thread_.join();
  }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;
  [[nodiscard]] std::uint64_t ticks() const { return ticks_.load(); }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> ticks_{0};
  std::thread thread_;
};

/// The last message of each name until the stream ends, read meanwhile.
using Newest = std::map<std::string, Received>;
std::future<Newest> newest_of(Client& client) {
  return std::async(std::launch::async, [&client] {
    Newest newest;
    while (std::optional<Received> received = client.next()) newest[received->name] = *received;
    return newest;
  });
}

std::unique_ptr<IgtlStream> block_stream() { return std::make_unique<IgtlStream>(block_setup(), dents); }

TEST(IgtlAddress, APortAloneIsThisMachinesAndAnAddressMayStandBeforeIt) {
  EXPECT_EQ(parse_igtl_address("18944").host, "127.0.0.1");
  EXPECT_EQ(parse_igtl_address("18944").port, 18944);
  EXPECT_EQ(parse_igtl_address("0.0.0.0:1").host, "0.0.0.0");
  EXPECT_EQ(parse_igtl_address("0.0.0.0:65535").port, 65535);
}

TEST(IgtlAddress, WhatIsNoPortIsRefusedWithWhatWouldBeRight) {
  for (const char* wrong : {"", "0", "65536", "-1", "+80", "80 ", "8e3", "99999999999", ":80", "localhost:80",
                            "1.2.3:80", "1.2.3.4:", "1.2.3.4:0", "[::1]:80"}) {
    try {
      (void)parse_igtl_address(wrong);
      ADD_FAILURE() << wrong;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr(std::string("--igtl ") + wrong + ": wanted is a port from 1 to 65535"));
    }
  }
}

TEST(IgtlServer, APortThatIsTakenIsRefusedInWords) {
  const IgtlServer first(kAnyFreePort);
  try {
    const IgtlServer second({"127.0.0.1", first.port()});
    ADD_FAILURE() << "two servers at one port";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--igtl 127.0.0.1:" + std::to_string(first.port()) +
                                        ": the port is taken by another program"));
  }
}

TEST(IgtlServer, AnAddressThatIsNotThisMachinesIsRefusedInWords) {
  EXPECT_THAT(
      [] {
        const IgtlServer server({"192.0.2.1", 18944});
      },
      testing::ThrowsMessage<InputError>(HasSubstr("this machine has no address 192.0.2.1")));
  EXPECT_THROW(const IgtlServer server({"nowhere", 18944}), InputError);
}

TEST(IgtlServer, APortCanBeListenedAtAgainAtOnce) {
  int port = 0;
  {
    IgtlServer server(kAnyFreePort);
    port = server.port();
    Client client(port);
    (void)client.next("STATUS", "PalpateStatus");
  }
  EXPECT_NO_THROW(IgtlServer({"127.0.0.1", port}));
}

TEST(IgtlServer, ListensAtLoopbackAloneUnlessToldOtherwise) {
  const IgtlServer server(kAnyFreePort);
  // 127.0.0.2 is this machine too: a server at all addresses would take it, one at 127.0.0.1 leaves it free.
  EXPECT_NO_THROW(IgtlServer({"127.0.0.2", server.port()}));
  const IgtlServer open({"0.0.0.0", 0});
  EXPECT_THROW(IgtlServer({"127.0.0.2", open.port()}), InputError);
}

TEST(IgtlServer, WithoutARunTheStatusSaysSo) {
  IgtlServer server(kAnyFreePort);
  Client client(server.port());
  const auto status = client.next("STATUS", "PalpateStatus").as<igtl::StatusMessage>();
  EXPECT_EQ(status->GetCode(), 13) << "not ready";
  EXPECT_STREQ(status->GetStatusString(), "nothing is being run");
}

TEST(IgtlServer, ARealLoopsLastTickReachesEveryClientAsItsRowsSay) {
  IgtlServer server(kAnyFreePort);
  Client first(server.port());
  Client second(server.port());
  const haptics::SimulationWorld world = haptics::test::block_and_balls(1, 1000.0);
  haptics::SimulationState state(world);
  haptics::test::FakeDevice device([](std::uint64_t, double time) { return haptics::test::pressing(time); });
  haptics::Device* devices[] = {&device};
  haptics::test::RowKeeper rows(600);
  // Until both are let in, the run's last state cannot be theirs.
  (void)first.next("STATUS", "PalpateStatus");
  (void)second.next("STATUS", "PalpateStatus");
  std::array<std::future<Newest>, 2> all = {newest_of(first), newest_of(second)};
  {
    IgtlRun run(&server, block_setup(), dents);
    (void)haptics::run_loop(world, state, devices, &rows,
                            {.ticks = 600, .offline = true, .more_snapshots = run.snapshots()});
  }
  EXPECT_EQ(server.finish().failure, "");
  const haptics::TickRow& last = rows.rows.back();
  ASSERT_GT(last.depth, 1e-3) << "it presses";
  for (std::future<Newest>& one : all) {
    const Newest newest = one.get();
    EXPECT_EQ(newest.at("PalpateTime").values()[0], last.time);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(newest.at("PalpateTool").position()[axis], static_cast<float>(1e3 * last.tool[axis]));
      EXPECT_EQ(newest.at("PalpateForce").values()[axis], last.force[axis]);
      EXPECT_EQ(newest.at("PalpateTorque").values()[axis], last.torque[axis]);
    }
    EXPECT_EQ(newest.at("PalpateDepth").values()[0], 1e3 * last.depth);
    igtl::PointElement::Pointer point;
    newest.at("PalpateContact").as<igtl::PointMessage>()->GetPointElement(0, point);
    std::array<float, 3> place{};
    point->GetPosition(place.data());
    EXPECT_EQ(place[2], static_cast<float>(1e3 * last.contact[2]));
    const auto surface = newest.at("PalpateOrgan").as<igtl::PolyDataMessage>();
    float lowest_of_top = 0.0F;  // the block's top is at z = 0
    for (int i = 0; i < surface->GetPoints()->GetNumberOfPoints(); ++i) {
      std::array<float, 3> vertex{};
      surface->GetPoints()->GetPoint(static_cast<unsigned int>(i), vertex.data());
      if (std::abs(vertex[0]) < 20.0F && std::abs(vertex[1]) < 20.0F && vertex[2] > -35.0F) {
        lowest_of_top = std::min(lowest_of_top, vertex[2]);
      }
    }
    EXPECT_LT(lowest_of_top, -1e3 * last.depth * 0.8) << "the dent is in the surface";
    EXPECT_GT(lowest_of_top, -1e3 * last.depth * 1.01);
    const auto status = newest.at("PalpateStatus").as<igtl::StatusMessage>();
    EXPECT_EQ(status->GetCode(), 19) << "the last word is that it ends";
  }
}

TEST(IgtlServer, RowsAreTheSameBitForBitWithAndWithoutIt) {
  const auto rows_with = [](SnapshotCell<haptics::Snapshot>* cell) {
    const haptics::SimulationWorld world = haptics::test::block_and_balls(1, 1000.0);
    haptics::SimulationState state(world);
    haptics::test::FakeDevice device(
        [](std::uint64_t, double time) { return haptics::test::pressing(time); });
    haptics::Device* devices[] = {&device};
    haptics::test::RowKeeper rows(600);
    (void)haptics::run_loop(world, state, devices, &rows,
                            {.ticks = 600, .offline = true, .more_snapshots = cell});
    return std::move(rows.rows);
  };
  IgtlServer server(kAnyFreePort);
  Client client(server.port());
  std::vector<haptics::TickRow> with;
  {
    IgtlRun run(&server, block_setup(), dents);
    with = rows_with(run.snapshots());
  }
  const std::vector<haptics::TickRow> without = rows_with(nullptr);
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i)
    ASSERT_TRUE(haptics::test::same_bits(with[i], without[i])) << i;
}

TEST(IgtlServer, AClientThatComesLateGetsTheSurfaceAndTheStateToo) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client early(server.port());
  const Publisher loop(server);
  (void)early.next("POLYDATA", "PalpateOrgan");  // the organ lies still: it is sent once
  Client late(server.port());
  (void)late.next("POLYDATA", "PalpateOrgan");
  const Received force = late.next("SENSOR", "PalpateForce");
  EXPECT_GT(force.values()[2], 0.0);
}

TEST(IgtlServer, EachMessageOfAFrameIsOfTheSameTick) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client client(server.port());
  const Publisher loop(server);
  for (int frame = 0; frame < 20; ++frame) {
    const Received pose = client.next("TRANSFORM", "PalpateTool");
    const Received time = client.next("SENSOR", "PalpateTime");
    const Received force = client.next("SENSOR", "PalpateForce");
    EXPECT_FLOAT_EQ(pose.position()[0], static_cast<float>(1e-3 * force.values()[2]));
    EXPECT_DOUBLE_EQ(time.values()[0], force.values()[2] / 1000.0);
    EXPECT_EQ(time.time, force.time);
  }
}

TEST(IgtlServer, AClientThatNeverReadsHoldsUpNeitherTheLoopNorTheOthers) {
  constexpr std::uint64_t kTicks = 1000;
  IgtlServer server(kAnyFreePort, {.most_clients = 16, .patience_ns = 600'000'000'000});
  const BareClient deaf(server.port());
  ASSERT_TRUE(deaf.connected());
  Client other(server.port());
  (void)other.next("STATUS", "PalpateStatus");
  haptics::LoopReport report;
  std::thread loop([&] {
    const haptics::SimulationWorld world = haptics::test::block_and_balls(1, 1000.0);
    haptics::SimulationState state(world);
    haptics::test::FakeDevice device(
        [](std::uint64_t, double time) { return haptics::test::pressing(time); });
    haptics::Device* devices[] = {&device};
    IgtlRun run(&server, large_setup(), dents);
    report = haptics::run_loop(world, state, devices, nullptr,
                               {.ticks = kTicks, .more_snapshots = run.snapshots(), .stalled_after_ns = 0});
  });
  // The other sees the run to its last tick, and each state is newer than the one before.
  double last = -1.0;
  while (last < 1e-3 * (kTicks - 1)) {
    const double time = other.next("SENSOR", "PalpateTime").values()[0];
    EXPECT_GT(time, last);
    last = time;
  }
  loop.join();
  EXPECT_EQ(report.ticks, kTicks);
  EXPECT_EQ(report.fault, haptics::Fault::kNone);
  const IgtlTally tally = server.finish();
  EXPECT_EQ(tally.clients, 2u);
  EXPECT_EQ(tally.given_up, 0u) << "it was there all the time";
}

TEST(IgtlServer, WhoTakesNothingForLongIsLetGo) {
  IgtlServer server(kAnyFreePort, {.most_clients = 16, .patience_ns = 200'000'000});
  server.begin(std::make_unique<IgtlStream>(large_setup(), dents));
  BareClient deaf(server.port());
  Client other(server.port());
  const Publisher loop(server);
  (void)other.next("POLYDATA", "PalpateOrgan");
  // The other sees time pass in its frames; the deaf one's time is over long before.
  const double begin = other.next("SENSOR", "PalpateTime").time;
  while (other.next("SENSOR", "PalpateTime").time < begin + 1.5) continue;
  const IgtlTally tally = server.finish();
  EXPECT_EQ(tally.clients, 2u);
  EXPECT_EQ(tally.given_up, 1u);
}

TEST(IgtlServer, ASlowClientGetsFewerFramesWholeAndInOrderAndTheyAreCounted) {
  IgtlServer server(kAnyFreePort);
  server.begin(std::make_unique<IgtlStream>(large_setup(), dents));
  Client slow(server.port());
  const Publisher loop(server);
  // It reads nothing for a while, in the middle of the surface that is larger than all buffers.
  (void)slow.next("SENSOR", "PalpateTime");
  std::this_thread::sleep_for(700ms);
  double last = 0.0;
  for (int i = 0; i < 10; ++i) {
    const double tick = slow.next("SENSOR", "PalpateForce").values()[2];
    EXPECT_GT(tick, last);
    last = tick;
  }
  const IgtlTally tally = server.finish();
  EXPECT_GT(tally.frames_left_out, 10u) << "of some 35 in 0.7 s";
  EXPECT_EQ(tally.given_up, 0u);
}

TEST(IgtlServer, AClientThatVanishesInTheMiddleOfAMessageHarmsNobody) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client other(server.port());
  const Publisher loop(server);
  for (int i = 0; i < 20; ++i) {
    BareClient passing(server.port());
    ASSERT_TRUE(passing.connected());
    (void)passing.receive(30);  // half a header, and it is gone: the system tells the server so at once
    if (i % 2 == 0) passing.receive_what_is_there();  // or only when the server sends the next time
  }
  for (int i = 0; i < 20; ++i) (void)other.next("SENSOR", "PalpateForce");
  EXPECT_EQ(server.finish().failure, "");
}

TEST(IgtlServer, WhateverClientsSendIsForgottenHoweverMuch) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client other(server.port());
  BareClient rude(server.port());
  const Publisher loop(server);
  Bytes noise(1 << 16);
  for (std::size_t i = 0; i < noise.size(); ++i)
    noise[i] = static_cast<unsigned char>((i * 2654435761U) >> 13U);
  // A header that promises 2^63 bytes, then noise without end.
  Bytes header(58, 0xFF);
  header[0] = 0;
  header[1] = 1;
  (void)rude.send_what_goes(header);
  std::size_t sent = 0;
  for (int i = 0; i < 50; ++i) {
    for (int j = 0; j < 100; ++j) sent += rude.send_what_goes(noise);
    (void)other.next("SENSOR", "PalpateForce");
  }
  EXPECT_GT(sent, noise.size()) << "it was taken";
  // The library's own client asks for things, too.
  igtl::GetTransformMessage::Pointer question = igtl::GetTransformMessage::New();
  question->SetDeviceName("PalpateTool");
  question->Pack();
  other.send({static_cast<unsigned char*>(question->GetPackPointer()),
              static_cast<std::size_t>(question->GetPackSize())});
  (void)other.next("SENSOR", "PalpateForce");
  EXPECT_EQ(server.finish().failure, "");
}

TEST(IgtlServer, Slicer3DWhichKnowsNoSensorGetsNone) {
  IgtlServer server(kAnyFreePort);
  Client slicer(server.port());
  Client other(server.port());
  // What its connector sends first: a status without a name.
  igtl::StatusMessage::Pointer hello = igtl::StatusMessage::New();
  hello->Pack();
  const std::span bytes(static_cast<const unsigned char*>(hello->GetPackPointer()),
                        static_cast<std::size_t>(hello->GetPackSize()));
  slicer.send(bytes.first(20));  // in two pieces
  (void)slicer.next("STATUS", "PalpateStatus");
  slicer.send(bytes.subspan(20));
  for (int i = 0; i < 2; ++i) (void)slicer.next("STATUS", "PalpateStatus");  // 0.2 s: it has been read
  server.begin(block_stream());
  const Publisher loop(server);
  for (int i = 0; i < 60; ++i) EXPECT_NE(slicer.next()->type, "SENSOR");
  (void)other.next("SENSOR", "PalpateForce");
}

TEST(IgtlServer, AClientThatOnlyListensIsServedAfterItSaidSo) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  BareClient quiet(server.port());
  quiet.send_no_more();
  const Publisher loop(server);
  for (int i = 0; i < 20; ++i) EXPECT_GT(quiet.receive(100), 0);
}

TEST(IgtlServer, MoreClientsThanPlacesAreRefusedAndCounted) {
  IgtlServer server(kAnyFreePort, {.most_clients = 2, .patience_ns = 5'000'000'000});
  server.begin(block_stream());
  Client first(server.port());
  Client second(server.port());
  const Publisher loop(server);
  (void)first.next("SENSOR", "PalpateForce");
  (void)second.next("SENSOR", "PalpateForce");
  BareClient third(server.port());
  EXPECT_EQ(third.receive(1), 0) << "closed at once";
  (void)first.next("SENSOR", "PalpateForce");
  const IgtlTally tally = server.finish();
  EXPECT_EQ(tally.clients, 2u);
  EXPECT_EQ(tally.refused, 1u);
}

TEST(IgtlServer, AFaultIsToldInWords) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client client(server.port());
  (void)client.next("STATUS", "PalpateStatus");
  haptics::Snapshot& snapshot = server.snapshots().writable();
  snapshot.hands = 1;
  snapshot.faults[0] = haptics::Fault::kDevice;
  server.snapshots().publish();
  for (int i = 0; i < 50; ++i) {
    const auto status = client.next("STATUS", "PalpateStatus").as<igtl::StatusMessage>();
    if (status->GetCode() == 13) continue;  // no tick yet
    EXPECT_EQ(status->GetCode(), 18);
    EXPECT_THAT(status->GetStatusString(), HasSubstr("the force stays zero until it is reset"));
    return;
  }
  ADD_FAILURE() << "no fault was told";
}

TEST(IgtlServer, ASecondRunIsShownToTheSameClientsWithoutAnythingOfTheFirst) {
  IgtlServer server(kAnyFreePort);
  Client client(server.port());
  (void)client.next("STATUS", "PalpateStatus");
  server.begin(block_stream());
  publish(server, 7);
  server.end();
  EXPECT_EQ(client.next("SENSOR", "PalpateForce").values()[2], 7.0);
  (void)client.next("POLYDATA", "PalpateOrgan");  // all of the first run
  publish(server, 9);                             // of no run
  server.begin(block_stream());
  std::this_thread::sleep_for(100ms);
  publish(server, 3);
  server.end();
  EXPECT_EQ(client.next("SENSOR", "PalpateForce").values()[2], 3.0);
  (void)client.next("POLYDATA", "PalpateOrgan");
}

TEST(IgtlServer, ItsEndIsSeenByItsClients) {
  auto server = std::make_unique<IgtlServer>(kAnyFreePort);
  Client client(server->port());
  (void)client.next("STATUS", "PalpateStatus");
  server.reset();
  while (client.next()) continue;  // an end, not a wait
}

}  // namespace
}  // namespace palpate::net
