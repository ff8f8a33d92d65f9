// The server with clients of the OpenIGTLink library.
#include "net/igtl_server.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/haptics/test/test_world.h"
#include "net/test/igtl_rig.h"
#include "palpate/error.h"
#include "run/realtime/loop.h"

namespace palpate::net {
namespace {

using namespace std::chrono_literals;
using namespace test;
using testing::HasSubstr;

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

TEST(IgtlServer, ListensAtLoopbackAloneUnlessSetOtherwise) {
  const IgtlServer server(kAnyFreePort);
  // 127.0.0.2 is an address of this machine too. A server at all addresses occupies its port, a server at
  // 127.0.0.1 leaves it free.
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
  // The server must have accepted both clients before they can receive the last state of the run.
  (void)first.next("STATUS", "PalpateStatus");
  (void)second.next("STATUS", "PalpateStatus");
  std::array<std::future<Newest>, 2> all = {newest_of(first), newest_of(second)};
  {
    IgtlRun run(&server, block_setup());
    (void)realtime::run_loop(world, state, devices, {&rows, &server}, {.ticks = 600, .offline = true});
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
  const auto rows_with = [](const std::vector<haptics::TickObserver*>& others) {
    const haptics::SimulationWorld world = haptics::test::block_and_balls(1, 1000.0);
    haptics::SimulationState state(world);
    haptics::test::FakeDevice device(
        [](std::uint64_t, double time) { return haptics::test::pressing(time); });
    haptics::Device* devices[] = {&device};
    haptics::test::RowKeeper rows(600);
    std::vector<haptics::TickObserver*> observers = {&rows};
    observers.insert(observers.end(), others.begin(), others.end());
    (void)realtime::run_loop(world, state, devices, observers, {.ticks = 600, .offline = true});
    return std::move(rows.rows);
  };
  IgtlServer server(kAnyFreePort);
  Client client(server.port());
  std::vector<haptics::TickRow> with;
  {
    IgtlRun run(&server, block_setup());
    with = rows_with({&server});
  }
  const std::vector<haptics::TickRow> without = rows_with({});
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i)
    ASSERT_TRUE(haptics::test::same_bits(with[i], without[i])) << i;
}

TEST(IgtlServer, AClientThatComesLateGetsTheSurfaceAndTheStateToo) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client early(server.port());
  const Publisher loop(server);
  (void)early.next("POLYDATA", "PalpateOrgan");  // an organ that does not move is sent once
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

TEST(IgtlServer, AFaultIsReportedInWords) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client client(server.port());
  (void)client.next("STATUS", "PalpateStatus");
  haptics::Snapshot snapshot;
  snapshot.hands = 1;
  snapshot.faults[0] = haptics::Fault::kDevice;
  server.publish(snapshot);
  for (int i = 0; i < 50; ++i) {
    const auto status = client.next("STATUS", "PalpateStatus").as<igtl::StatusMessage>();
    if (status->GetCode() == 13) continue;  // no tick yet
    EXPECT_EQ(status->GetCode(), 18);
    EXPECT_THAT(status->GetStatusString(), HasSubstr("the force stays zero until it is reset"));
    return;
  }
  ADD_FAILURE() << "no message of a fault came";
}

TEST(IgtlServer, ASecondRunIsShownToTheSameClientsWithoutAnythingOfTheFirst) {
  IgtlServer server(kAnyFreePort);
  Client client(server.port());
  (void)client.next("STATUS", "PalpateStatus");
  server.begin(block_stream());
  publish(server, 7);
  server.end();
  EXPECT_EQ(client.next("SENSOR", "PalpateForce").values()[2], 7.0);
  (void)client.next("POLYDATA", "PalpateOrgan");  // reads the messages of the first run
  publish(server, 9);                             // a tick of no run
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
  while (client.next()) continue;  // the stream must end
}

}  // namespace
}  // namespace palpate::net
