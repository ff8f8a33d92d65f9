// Clients that are slow, read nothing, send invalid bytes or are many.
#include "net/igtl_clients.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "core/haptics/test/test_world.h"
#include "net/test/igtl_rig.h"
#include "run/realtime/loop.h"

namespace palpate::net {
namespace {

using namespace std::chrono_literals;
using namespace test;

TEST(IgtlClients, AClientThatNeverReadsHoldsUpNeitherTheLoopNorTheOthers) {
  constexpr std::uint64_t kTicks = 1000;
  IgtlServer server(kAnyFreePort, {.most_clients = 16, .send_timeout_ns = 600'000'000'000});
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
    IgtlRun run(&server, large_setup());
    report = realtime::run_loop(world, state, devices, {&server}, {.ticks = kTicks, .stalled_after_ns = 0});
  });
  // The other client sees the run to its last tick, and each state is newer than the previous state.
  double last = -1.0;
  while (last < 1e-3 * (kTicks - 1)) {
    const double time = other.next("SENSOR", "PalpateTime").values()[0];
    EXPECT_GT(time, last);
    last = time;
  }
  loop.join();
  EXPECT_EQ(report.ticks, kTicks);
  EXPECT_EQ(report.fault, haptics::Fault::kNone);
  const IgtlStatistics tally = server.finish();
  EXPECT_EQ(tally.clients, 2u);
  EXPECT_EQ(tally.given_up, 0u) << "it was there all the time";
}

TEST(IgtlClients, WhoTakesNothingForLongIsLetGo) {
  IgtlServer server(kAnyFreePort, {.most_clients = 16, .send_timeout_ns = 200'000'000});
  server.begin(std::make_unique<IgtlStream>(large_setup()));
  BareClient deaf(server.port());
  Client other(server.port());
  const Publisher loop(server);
  (void)other.next("POLYDATA", "PalpateOrgan");
  // The other client sees the time advance in its frames. The time limit of the client that reads nothing is
  // over long before.
  const double begin = other.next("SENSOR", "PalpateTime").time;
  while (other.next("SENSOR", "PalpateTime").time < begin + 1.5) continue;
  const IgtlStatistics tally = server.finish();
  EXPECT_EQ(tally.clients, 2u);
  EXPECT_EQ(tally.given_up, 1u);
}

TEST(IgtlClients, ASlowClientGetsFewerFramesWholeAndInOrderAndTheyAreCounted) {
  IgtlServer server(kAnyFreePort);
  server.begin(std::make_unique<IgtlStream>(large_setup()));
  Client slow(server.port());
  const Publisher loop(server);
  // The client pauses in the middle of a surface that is larger than all buffers.
  (void)slow.next("SENSOR", "PalpateTime");
  std::this_thread::sleep_for(700ms);
  double last = 0.0;
  for (int i = 0; i < 10; ++i) {
    const double tick = slow.next("SENSOR", "PalpateForce").values()[2];
    EXPECT_GT(tick, last);
    last = tick;
  }
  const IgtlStatistics tally = server.finish();
  EXPECT_GT(tally.frames_left_out, 10u) << "of some 35 in 0.7 s";
  EXPECT_EQ(tally.given_up, 0u);
}

TEST(IgtlClients, AClientThatVanishesInTheMiddleOfAMessageHarmsNobody) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client other(server.port());
  const Publisher loop(server);
  for (int i = 0; i < 20; ++i) {
    BareClient passing(server.port());
    ASSERT_TRUE(passing.connected());
    (void)passing.receive(30);  // half a header
    // A client that closes with unread bytes resets the connection, which the server sees at once. After the
    // close of a client without unread bytes, the server sees it at its next send.
    if (i % 2 == 0) passing.receive_what_is_there();
  }
  for (int i = 0; i < 20; ++i) (void)other.next("SENSOR", "PalpateForce");
  EXPECT_EQ(server.finish().failure, "");
}

TEST(IgtlClients, WhateverClientsSendIsForgottenHoweverMuch) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  Client other(server.port());
  BareClient rude(server.port());
  const Publisher loop(server);
  Bytes noise(1 << 16);
  for (std::size_t i = 0; i < noise.size(); ++i)
    noise[i] = static_cast<unsigned char>((i * 2654435761U) >> 13U);
  // A header that announces 2^63 bytes, then bytes without end.
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
  // The library's own client also sends requests.
  igtl::GetTransformMessage::Pointer question = igtl::GetTransformMessage::New();
  question->SetDeviceName("PalpateTool");
  question->Pack();
  other.send({static_cast<unsigned char*>(question->GetPackPointer()),
              static_cast<std::size_t>(question->GetPackSize())});
  (void)other.next("SENSOR", "PalpateForce");
  EXPECT_EQ(server.finish().failure, "");
}

TEST(IgtlClients, Slicer3DWhichKnowsNoSensorGetsNone) {
  IgtlServer server(kAnyFreePort);
  Client slicer(server.port());
  Client other(server.port());
  // The connector of 3D Slicer first sends a status without a name.
  igtl::StatusMessage::Pointer hello = igtl::StatusMessage::New();
  hello->Pack();
  const std::span bytes(static_cast<const unsigned char*>(hello->GetPackPointer()),
                        static_cast<std::size_t>(hello->GetPackSize()));
  slicer.send(bytes.first(20));  // in two pieces
  (void)slicer.next("STATUS", "PalpateStatus");
  slicer.send(bytes.subspan(20));
  for (int i = 0; i < 2; ++i) (void)slicer.next("STATUS", "PalpateStatus");  // read after 0.2 s
  server.begin(block_stream());
  const Publisher loop(server);
  for (int i = 0; i < 60; ++i) EXPECT_NE(slicer.next()->type, "SENSOR");
  (void)other.next("SENSOR", "PalpateForce");
}

TEST(IgtlClients, AClientThatOnlyListensIsServedAfterItSaidSo) {
  IgtlServer server(kAnyFreePort);
  server.begin(block_stream());
  BareClient quiet(server.port());
  quiet.send_no_more();
  const Publisher loop(server);
  for (int i = 0; i < 20; ++i) EXPECT_GT(quiet.receive(100), 0);
}

TEST(IgtlClients, MoreClientsThanPlacesAreRefusedAndCounted) {
  IgtlServer server(kAnyFreePort, {.most_clients = 2, .send_timeout_ns = 5'000'000'000});
  server.begin(block_stream());
  Client first(server.port());
  Client second(server.port());
  const Publisher loop(server);
  (void)first.next("SENSOR", "PalpateForce");
  (void)second.next("SENSOR", "PalpateForce");
  BareClient third(server.port());
  EXPECT_EQ(third.receive(1), 0) << "closed at once";
  (void)first.next("SENSOR", "PalpateForce");
  const IgtlStatistics tally = server.finish();
  EXPECT_EQ(tally.clients, 2u);
  EXPECT_EQ(tally.refused, 1u);
}

}  // namespace
}  // namespace palpate::net
