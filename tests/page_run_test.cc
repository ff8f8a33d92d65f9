// `palpate run --page` with a client in place of the browser.
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/websocket/test/live_client.h"
#include "palpate/recording.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;
using net::test::LiveClient;
using nlohmann::json;

/// Waits until the program has printed this many lines, for a minute at most.
bool await_lines(const Program& program, std::size_t count) {
  for (int i = 0; i < 6000 && lines(program.out_so_far()) < count; ++i) std::this_thread::sleep_for(10ms);
  return lines(program.out_so_far()) >= count;
}

TEST(PageRun, BeginsForTheClientWithItsTokenAndEndsWhenThePageIsClosed) {
  ::unsetenv("DISPLAY");  // no browser opens
  ::unsetenv("WAYLAND_DISPLAY");
  const Folder folder;
  Program program(folder.path(), {"run", "--page", "--device", "emulated", "--record", "run.h5", "--json"});
  ASSERT_TRUE(await_lines(program, 1)) << program.out_so_far();
  const std::string out = program.out_so_far();
  const json place = json::parse(out.substr(0, out.find('\n')))["listening"];
  LiveClient stranger(place["port"].get<std::uint16_t>());
  EXPECT_EQ(stranger.greet()["error"]["code"], "token");
  {
    LiveClient page(place["port"].get<std::uint16_t>());
    ASSERT_EQ(page.greet(place["token"])["answer"], "hello");
    EXPECT_EQ(page.ask(R"({"do": "state"})")["run"]["state"], "waiting");
    EXPECT_EQ(page.ask(R"({"do": "start"})")["answer"], "start");
    while (page.ask(R"({"do": "state"})")["state"].is_null()) std::this_thread::sleep_for(10ms);
  }
  EXPECT_TRUE(await_lines(program, 2)) << "the run goes on without its page";
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err << outcome.out;
  EXPECT_NE(outcome.err.find("/#" + place["token"].get<std::string>()), std::string::npos) << outcome.err;
  EXPECT_GT(record::read_recording(folder / "run.h5").rows.size(), 0U);
}

/// The program with the page, and its one client.
class Page final {
 public:
  Page(const Folder& folder, std::vector<std::string> flags)
      : program_(folder.path(), whole(std::move(flags))) {
    EXPECT_TRUE(await_lines(program_, 1));
    const std::string out = program_.out_so_far();
    const json place = json::parse(out.substr(0, out.find('\n')))["listening"];
    client_.emplace(place["port"].get<std::uint16_t>());
    EXPECT_EQ(client_->greet(place["token"])["answer"], "hello");
  }
  json ask(const json& message) { return client_->ask(message.dump()); }
  json hand() { return ask({{"do", "state"}})["state"]["hands"][0]; }
  /// Waits until the run has a tick for which this holds, for half a minute at most.
  bool await(const std::function<bool(const json&)>& wanted) {
    for (int i = 0; i < 1500; ++i) {
      const json state = ask({{"do", "state"}})["state"];
      if (!state.is_null() && wanted(state)) return true;
      std::this_thread::sleep_for(20ms);
    }
    return false;
  }
  Outcome end() {
    program_.signal(SIGINT);
    return program_.wait();
  }

 private:
  static std::vector<std::string> whole(std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"run", "--page", "--json"});
    return flags;
  }
  Program program_;
  std::optional<LiveClient> client_;
};

TEST(PageRun, TheMouseOfThePageMovesTheToolAndTheRunIsRecordedAndReplayedBitForBit) {
  const Folder folder;
  Page page(folder, {"--device", "mouse"});
  EXPECT_EQ(page.ask({{"do", "record"}, {"on", true}})["error"]["code"], "state") << "nothing was played";
  ASSERT_EQ(page.ask({{"do", "start"}})["answer"], "start");
  ASSERT_TRUE(page.await([](const json& state) { return state["tick"] > 10; }));
  const json start = page.hand();
  // From 0.3 m above the nearest place down, 5 mm aside; the tool floats 5 mm over it, and the wheel presses
  // 9 mm.
  json origin = start["contact_m"];
  origin[0] = origin[0].get<double>() + 5e-3;
  origin[2] = origin[2].get<double>() + 0.3;
  const json aims = {
      {"do", "mouse"}, {"ray", {{"origin_m", origin}, {"direction", {0, 0, -1}}}}, {"deeper_mm", 9}};
  EXPECT_EQ(page.ask(aims), json({{"answer", "mouse"}}));
  EXPECT_TRUE(page.await([](const json& state) { return state["hands"][0]["depth_m"] > 3e-3; }));
  ASSERT_TRUE(page.await([](const json& state) { return !state["ticks_per_s"].is_null(); }));
  const double rate = page.ask({{"do", "state"}})["state"]["ticks_per_s"];
  EXPECT_TRUE(rate > 300.0 && rate < 1010.0) << rate << " Hz, less than 1000 on a busy machine";
  const json contact = page.hand()["contact_m"];
  EXPECT_NEAR(contact[0].get<double>(), origin[0].get<double>(), 3e-3) << "under the pointer";
  const json begun = page.ask({{"do", "record"}, {"on", true}});
  EXPECT_EQ(begun["writing"], true) << begun;
  EXPECT_EQ(page.ask({{"do", "mouse"}, {"grip", true}, {"ray", nullptr}})["answer"], "mouse");
  std::this_thread::sleep_for(200ms);
  EXPECT_NEAR(page.hand()["depth_m"].get<double>(), 4e-3, 1e-3) << "it stays when the pointer is elsewhere";
  const json ended = page.ask({{"do", "record"}, {"on", false}});
  EXPECT_EQ(ended["writing"], false) << ended;
  EXPECT_FALSE(ended.contains("recording_failure")) << ended;
  EXPECT_EQ(page.ask({{"do", "state"}})["run"]["state"], "running") << "the run goes on";
  EXPECT_EQ(page.ask({{"do", "mouse"}, {"hand", 1}})["error"]["code"], "state");
  page.ask({{"do", "stop"}});
  EXPECT_EQ(page.ask(aims)["error"]["code"], "state");
  const Outcome outcome = page.end();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string file = folder.names().at(0);
  EXPECT_EQ(folder.names().size(), 1U) << "nothing else is left";
  EXPECT_EQ(file.rfind("palpate-", 0), 0U) << file;
  EXPECT_TRUE(begun["recording"].get<std::string>().ends_with(file)) << begun;
  const record::Recording recording = record::read_recording(folder / file);
  ASSERT_GT(recording.rows.size(), 200U);
  EXPECT_EQ(recording.rows.front().tick, 0U) << "from the run's start on";
  EXPECT_EQ(recording.rows.back().buttons, 1U) << "the left button";
  EXPECT_EQ(run(folder, {"replay", file, "--verify"}).exit_code, 0);
}

TEST(PageRun, TheGamepadOfThePageLeadsTheToolAndOneThatFallsSilentStopsItWithAFault) {
  const Folder folder;
  Page page(folder, {"--device", "gamepad"});
  ASSERT_EQ(page.ask({{"do", "start"}})["answer"], "start");
  ASSERT_TRUE(page.await([](const json& state) { return state["tick"] > 10; }));
  const double start = page.hand()["tool_m"][0];
  const auto send = [&page](const json& way) { return page.ask({{"do", "gamepad"}, {"way", way}}); };
  // 40 mm/s at most: a quarter of the deflection is 10 mm/s, and the tool comes 10 mm far.
  const auto begun = std::chrono::steady_clock::now();
  while (std::abs(page.hand()["tool_m"][0].get<double>() - start) < 10e-3) {
    ASSERT_EQ(send({0.25, 0, 0}), json({{"answer", "gamepad"}}));
    std::this_thread::sleep_for(20ms);
    ASSERT_LT(std::chrono::steady_clock::now() - begun, 20s);
  }
  EXPECT_GT(std::chrono::steady_clock::now() - begun, 900ms);
  EXPECT_EQ(page.hand()["fault"], "none");
  ASSERT_TRUE(page.await([](const json& state) { return state["hands"][0]["fault"] == "device"; }));
  const json stopped = page.hand()["tool_m"];
  std::this_thread::sleep_for(300ms);
  EXPECT_NEAR(page.hand()["tool_m"][0].get<double>(), stopped[0].get<double>(), 1e-4);
  page.ask({{"do", "stop"}});
  const Outcome outcome = page.end();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("no gamepad is connected any more"), std::string::npos) << outcome.err;
}

TEST(PageRun, ARecordingThatIsNotEndedEndsWithItsRun) {
  const Folder folder;
  Page page(folder, {"--device", "emulated"});
  page.ask({{"do", "start"}});
  ASSERT_TRUE(page.await([](const json& state) { return state["tick"] > 10; }));
  const json begun = page.ask({{"do", "record"}, {"on", true}});
  EXPECT_EQ(begun["writing"], true) << begun;
  const Outcome outcome = page.end();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(folder.names().size(), 1U) << "nothing else is left";
  EXPECT_EQ(run(folder, {"replay", folder.names().at(0), "--verify"}).exit_code, 0) << outcome.err;
}

TEST(PageRun, WholeRunsAreRecordedWithTheFlagAndTheButtonSaysSo) {
  const Folder folder;
  Page page(folder, {"--device", "emulated", "--record", "whole.h5"});
  page.ask({{"do", "start"}});
  ASSERT_TRUE(page.await([](const json& state) { return state["tick"] > 10; }));
  EXPECT_EQ(page.ask({{"do", "state"}})["run"]["writing"], true);
  const json refused = page.ask({{"do", "record"}, {"on", false}});
  EXPECT_NE(refused["error"]["words"].get<std::string>().find("whole.h5"), std::string::npos) << refused;
  page.end();
  EXPECT_EQ(folder.names(), std::vector<std::string>{"whole.h5"});
}

TEST(PageRun, AnotherDeviceIsChosenBetweenRunsAndOneThatCannotBeOpenedIsReportedInWords) {
  const Folder folder;
  Page page(folder, {"--device", "emulated"});
  const json devices = page.ask({{"do", "devices"}})["devices"];
  EXPECT_EQ(devices[0]["device"], "emulated") << "first that of the command line";
  std::map<std::string, bool> available;
  for (const json& one : devices) available[one["device"]] = one["available"];
  EXPECT_TRUE(available.at("scripted"));
  EXPECT_TRUE(available.at("mouse"));
  EXPECT_TRUE(available.at("gamepad"));
  EXPECT_FALSE(available.at("haply"));
  EXPECT_EQ(available.count("replay") + available.count("igtl") + available.count("host"), 0U) << devices;
  const json absent = page.ask({{"do", "start"}, {"device", "haply"}});
  EXPECT_NE(absent["error"]["words"].get<std::string>().find("device haply"), std::string::npos) << absent;
  const json path = page.ask({{"do", "start"}, {"device", "replay:/etc/passwd"}});
  EXPECT_EQ(path["error"]["words"], "device = \"replay:/etc/passwd\": must be a kind without a path");
  for (const std::string device : {"mouse", "emulated"}) {
    ASSERT_EQ(page.ask({{"do", "start"}, {"device", device}})["answer"], "start") << device;
    EXPECT_EQ(page.ask({{"do", "scene"}})["scene"]["hands"][0]["device"], device);
    EXPECT_EQ(page.ask({{"do", "devices"}})["error"]["code"], "state") << "a maker's library is in use";
    page.ask({{"do", "stop"}});
  }
  EXPECT_EQ(page.end().exit_code, 0);
  const Folder other;
  std::ofstream(other / "path.csv") << "time_s,x_m,y_m,z_m\n0,0,0,0.2\n9,0,0,0.2\n";
  Page with_path(other, {"--device", "scripted:path.csv"});
  ASSERT_EQ(with_path.ask({{"do", "start"}, {"device", "mouse"}})["answer"], "start");
  with_path.ask({{"do", "stop"}});
  const std::string own = with_path.ask({{"do", "devices"}})["devices"][0]["device"];
  EXPECT_NE(own.find("path.csv"), std::string::npos);
  ASSERT_EQ(with_path.ask({{"do", "start"}, {"device", own}})["answer"], "start") << own;
  ASSERT_TRUE(with_path.await([](const json& state) { return state["run"] == 2 && state["tick"] > 10; }));
  EXPECT_NEAR(with_path.hand()["tool_m"][2].get<double>(), 0.2, 1e-12) << "the command line's path";
  with_path.end();
}

TEST(PageRun, IsRefusedWithFlagsOfARunWithoutAPage) {
  const Folder folder;
  for (const char* const flag : {"--offline", "--headless"}) {
    const Outcome outcome = run(folder, {"run", "--page", flag});
    EXPECT_EQ(outcome.exit_code, 2) << flag;
    EXPECT_NE(outcome.err.find("--page"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace palpate::tests
