// `palpate run --igtl` with a client that uses the OpenIGTLink library.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "net/igtl_clients.h"
#include "net/test/igtl_received.h"
#include "palpate/recording.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;
using net::test::Client;
using net::test::Received;

/// A port that was free at the time of the call.
int free_port() { return net::IgtlClients({"127.0.0.1", 0}, {}).port(); }

/// Connects to the program when it listens.
std::unique_ptr<Client> client_of(int port) {
  for (int i = 0; i < 6000; ++i) {
    try {
      return std::make_unique<Client>(port);
    } catch (const std::runtime_error&) {
      std::this_thread::sleep_for(50ms);
    }
  }
  throw std::runtime_error("the program does not listen");
}

TEST(Igtl, WhatAClientReceivesIsWhatTheRecordingSays) {
  const Folder folder;
  const int port = free_port();
  Program program(folder.path(), {"run", "--igtl", std::to_string(port), "--headless", "--record", "run.h5",
                                  "--json", "--duration-s", "3"});
  const std::unique_ptr<Client> client = client_of(port);
  std::map<double, std::pair<Received, Received>> frames;  // pose and force at each time
  float lowest = 1e9F;
  float highest = -1e9F;
  Received pose;
  Received time;
  while (std::optional<Received> received = client->next()) {
    if (received->name == "PalpateTool") pose = *received;
    if (received->name == "PalpateTime") time = *received;
    if (received->name == "PalpateForce") frames[time.values()[0]] = {pose, *received};
    if (received->name != "PalpateOrgan") continue;
    const auto surface = received->as<igtl::PolyDataMessage>();
    for (int i = 0; i < surface->GetPoints()->GetNumberOfPoints(); ++i) {
      std::array<float, 3> place{};
      surface->GetPoints()->GetPoint(static_cast<unsigned int>(i), place.data());
      lowest = std::min(lowest, place[2]);
      highest = std::max(highest, place[2]);
    }
  }
  const Outcome outcome = program.wait();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("OpenIGTLink: listening at 127.0.0.1:" + std::to_string(port) +
                             ", for programs on this machine only"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("OpenIGTLink: 1 client, "), std::string::npos) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary["igtl"]["clients"], 1);
  EXPECT_GE(summary["igtl"]["frames"], frames.size());

  const record::Recording recording = record::read_recording(folder / "run.h5");
  ASSERT_EQ(recording.rows.size(), 3000u);
  EXPECT_GE(frames.size(), 5u) << "some 150, but for a busy machine";
  for (const auto& [at, frame] : frames) {
    const haptics::TickRow& row = recording.rows.at(static_cast<std::size_t>(std::llround(1000.0 * at)));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(frame.first.position()[axis], static_cast<float>(1e3 * row.tool[axis])) << at;
      EXPECT_EQ(frame.second.values()[axis], row.force[axis]) << at;
    }
    EXPECT_NEAR(frame.second.time, 1e-9 * static_cast<double>(recording.facts.started_unix_ns) + at, 60.0)
        << "wall time, but for how late ticks were";
  }
  EXPECT_EQ(frames.rbegin()->first, 2.999) << "the last tick reaches a client that keeps up";
  // The organ at rest. Its far side does not move.
  geometry::TriangleMesh rest = recording.scene.organ;
  geometry::transform(rest, recording.scene.organ_pose);
  EXPECT_NEAR(lowest, 1e3 * geometry::bounds(rest).low.z(), 1e-3) << "mm";
  EXPECT_NEAR(highest, 1e3 * geometry::bounds(rest).high.z(), 1e-3) << "mm";
}

TEST(Igtl, ItChangesNoRow) {
  const Folder folder;
  const std::string port = std::to_string(free_port());
  const std::vector<std::string> words = {"run", "--offline", "--duration-s", "0.5", "--record"};
  auto with = words;
  with.insert(with.end(), {"with.h5", "--igtl", port});
  auto without = words;
  without.emplace_back("without.h5");
  ASSERT_EQ(run(folder, with).exit_code, 0);
  ASSERT_EQ(run(folder, without).exit_code, 0);
  ASSERT_EQ(run(folder, {"export", "with.h5", "--csv", "with.csv"}).exit_code, 0);
  ASSERT_EQ(run(folder, {"export", "without.h5", "--csv", "without.csv"}).exit_code, 0);
  const std::string rows = text_of(folder / "with.csv");
  EXPECT_GT(lines(rows), 500u);
  EXPECT_EQ(rows, text_of(folder / "without.csv"));
}

TEST(Igtl, APortThatIsTakenExitsTwoInOneLineAndWritesNothing) {
  const Folder folder;
  const net::IgtlClients other({"127.0.0.1", 0}, {});
  const std::string port = std::to_string(other.port());
  const Outcome outcome = run(folder, {"run", "--offline", "--igtl", port, "--record", "r.h5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(lines(outcome.err), 1u) << outcome.err;
  EXPECT_NE(outcome.err.find("--igtl 127.0.0.1:" + port + ": the port is taken"), std::string::npos)
      << outcome.err;
  EXPECT_TRUE(folder.names().empty());
}

TEST(Igtl, WhoOpensItToOtherMachinesIsWarnedThatThereIsNoPassword) {
  const Folder folder;
  const std::string where = "0.0.0.0:" + std::to_string(free_port());
  const Outcome outcome = run(folder, {"run", "--offline", "--duration-s", "0.01", "--igtl", where});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("OpenIGTLink: listening at " + where), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("there is no password"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace palpate::tests
