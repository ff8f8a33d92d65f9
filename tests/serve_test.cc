// `palpate serve` with clients of the live interface.
#include <chrono>
#include <cmath>
#include <csignal>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "io/websocket/test/live_client.h"
#include "palpate/recording.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;
using net::test::LiveClient;
using nlohmann::json;

/// The serving program, at a port that the system chose.
class Serve final {
 public:
  Serve(const Folder& folder, std::vector<std::string> words)
      : program_(folder.path(), whole(std::move(words))) {}

  /// The port, or 0 if the program has not reported it within a minute.
  [[nodiscard]] std::uint16_t port() const {
    for (int i = 0; i < 6000; ++i) {
      const std::string out = program_.out_so_far();
      if (out.find('\n') != std::string::npos) {
        return json::parse(out.substr(0, out.find('\n')))["listening"]["port"];
      }
      std::this_thread::sleep_for(10ms);
    }
    return 0;
  }
  [[nodiscard]] std::string out() const { return program_.out_so_far(); }
  Outcome end() {
    program_.signal(SIGINT);
    return program_.wait();
  }

 private:
  static std::vector<std::string> whole(std::vector<std::string> words) {
    words.insert(words.begin(), {"serve", "--port", "0", "--json"});
    return words;
  }
  Program program_;
};

/// Waits until the run with this number has computed a tick.
void await_tick(LiveClient& client, int run) {
  for (int i = 0; i < 6000; ++i) {
    const json state = client.ask(R"({"do": "state"})")["state"];
    if (!state.is_null() && state["run"] == run) return;
    std::this_thread::sleep_for(20ms);
  }
  ADD_FAILURE() << "run " << run << " has no tick";
}

TEST(Serve, ChangesThatClientsMakeReachTheTicksAreRecordedAndReplayed) {
  const Folder folder;
  Serve serve(folder, {"--record", "run.h5", "--device", "emulated", "--duration-s", "600"});
  LiveClient client(serve.port());
  ASSERT_EQ(client.greet()["answer"], "hello");
  client.ask(R"({"do": "stream", "rate_Hz": 20})");
  const json tissue = client.ask(R"({"do": "set_tissue", "tissue": {"preset": "liver", "k1_N_per_m": 30}})");
  EXPECT_EQ(tissue["change"], 1) << tissue;
  EXPECT_TRUE(tissue["warnings"].is_array());
  const json noise = client.ask(R"({"do": "set_noise", "noise": {"enabled": false}})");
  EXPECT_EQ(noise["change"], 2) << noise;
  const json refused = client.ask(R"({"do": "set_tissue", "tissue": {"beta": -1}})");
  EXPECT_EQ(refused["error"]["field"], "beta") << refused;
  const json frame = client.hear_until(
      [](const json& message) { return message.contains("state") && message["state"]["change"] == 2; });
  EXPECT_FALSE(frame.is_null());
  const json scene = client.ask(R"({"do": "scene"})");
  EXPECT_EQ(scene["tissue"]["name"], "liver");
  EXPECT_EQ(scene["tissue"]["k1_N_per_m"], 30.0);
  EXPECT_EQ(scene["noise"]["enabled"], false);
  const json stopped = client.ask(R"({"do": "stop"})");
  EXPECT_EQ(stopped["run"]["state"], "ended") << stopped;
  EXPECT_EQ(client.ask(R"({"do": "stop"})")["error"]["code"], "state");
  const Outcome outcome = serve.end();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(lines(outcome.out), 3U) << "where it listens, the run, what was served: " << outcome.out;
  const record::Recording recording = record::read_recording(folder / "run.h5");
  ASSERT_EQ(recording.changes.size(), 2U);
  EXPECT_EQ(recording.changes[0].tissue.k1, 30.0);
  EXPECT_FALSE(recording.changes[1].noise.enabled);
  EXPECT_EQ(run(folder, {"replay", "run.h5", "--verify"}).exit_code, 0);
}

/// A scene with a visible nodule and a hidden stone in the gallbladder.
void write_scene_with_inclusions(const std::filesystem::path& file) {
  std::ofstream(file) << "[organ]\nmesh = \"gallbladder\"\n[tool]\nmesh = \"sphere:5\"\n"
                         "[device]\nkind = \"emulated\"\n"
                         "[[organ.inclusion]]\npreset = \"nodule\"\n"
                         "[[organ.inclusion]]\nname = \"secret\"\nradius_mm = 2\nstiffness_ratio = 20\n"
                         "depth_mm = 6\nvisible = false\n";
}

TEST(Serve, AnInclusionChangesDuringTheRunForAllClientsAndStaysForTheNextRun) {
  const Folder folder;
  write_scene_with_inclusions(folder / "lump.toml");
  Serve serve(folder, {"lump.toml", "--record", "run.h5", "--duration-s", "600"});
  LiveClient client(serve.port());
  LiveClient other(serve.port());
  client.greet();
  other.greet();
  client.ask(R"({"do": "stream", "rate_Hz": 20})");
  const json nodule = client.ask(R"({"do": "scene"})")["scene"]["inclusions"][0];
  EXPECT_EQ(nodule["name"], "nodule");
  EXPECT_EQ(nodule["number"], 1);
  json moved = nodule["position_mm"];
  moved[2] = moved[2].get<double>() - 0.5;
  const json answer =
      client.ask(json{{"do", "set_inclusion"},
                      {"inclusion", {{"name", "nodule"}, {"position_mm", moved}, {"stiffness_ratio", 3}}}}
                     .dump());
  EXPECT_EQ(answer["change"], 1) << answer;
  EXPECT_EQ(answer["warnings"], json::array()) << answer;
  const json frame = client.hear_until(
      [](const json& message) { return message.contains("state") && message["state"]["change"] == 1; });
  EXPECT_FALSE(frame.is_null());
  const json event =
      other.hear_until([](const json& message) { return message.value("event", "") == "inclusion"; });
  EXPECT_EQ(event["change"], 1) << event;
  EXPECT_EQ(event["inclusion"]["stiffness_ratio"], 3.0);
  EXPECT_NEAR(event["inclusion"]["position_mm"][2].get<double>(), moved[2].get<double>(), 1e-12);
  const json hard = client.ask(R"({"do":"set_inclusion","inclusion":{"number":1,"stiffness_ratio":101}})");
  EXPECT_EQ(hard["error"]["field"], "stiffness_ratio") << hard;
  const json outside =
      client.ask(R"({"do":"set_inclusion","inclusion":{"number":1,"position_mm":[0,0,500]}})");
  EXPECT_NE(outside["error"]["words"].get<std::string>().find("outside the organ"), std::string::npos)
      << outside;
  client.ask(R"({"do": "stop"})");
  const json waiting =
      client.ask(R"({"do":"set_inclusion","inclusion":{"number":1,"position_mm":[0,0,500]}})");
  EXPECT_NE(waiting["error"]["words"].get<std::string>().find("outside the organ"), std::string::npos)
      << waiting;
  EXPECT_TRUE(client.ask(R"({"do":"set_inclusion","inclusion":{"number":1,"stiffness_ratio":4}})")["change"]
                  .is_null());
  client.ask(R"({"do": "start"})");
  await_tick(client, 2);
  EXPECT_EQ(client.ask(R"({"do": "scene"})")["scene"]["inclusions"][0]["stiffness_ratio"], 4.0);
  EXPECT_EQ(serve.end().exit_code, 0);
  const record::Recording first = record::read_recording(folder / "run.h5");
  ASSERT_EQ(first.changes.size(), 1U);
  EXPECT_EQ(first.changes[0].inclusion.ratio, 3.0);
  const record::Recording second = record::read_recording(folder / "run-2.h5");
  ASSERT_EQ(second.scene.inclusions.size(), 2U);
  EXPECT_EQ(second.scene.inclusions[0].inclusion.ratio, 4.0);
  EXPECT_NEAR(second.scene.inclusions[0].inclusion.centre_S.z(), 1e-3 * moved[2].get<double>(), 1e-12);
  EXPECT_EQ(run(folder, {"replay", "run.h5", "--verify"}).exit_code, 0);
}

TEST(Serve, AHiddenInclusionIsCountedAndNeitherShownNorChanged) {
  const Folder folder;
  write_scene_with_inclusions(folder / "lump.toml");
  Serve serve(folder, {"lump.toml", "--wait"});
  LiveClient client(serve.port());
  client.greet();
  const json scene = client.ask(R"({"do": "scene"})");
  EXPECT_EQ(scene["scene"]["inclusions"].size(), 1U);
  EXPECT_EQ(scene["scene"]["hidden_inclusions"], 1);
  EXPECT_EQ(scene["scene"]["stiffness_map"], false);
  EXPECT_EQ(scene.dump().find("secret"), std::string::npos) << scene;
  const json by_number = client.ask(R"({"do":"set_inclusion","inclusion":{"number":2,"stiffness_ratio":3}})");
  EXPECT_EQ(by_number["error"]["code"], "refused") << by_number;
  const json by_name = client.ask(R"({"do":"set_inclusion","inclusion":{"name":"secret"}})");
  EXPECT_EQ(by_name["error"]["field"], "inclusion.name");
  EXPECT_NE(by_name["error"]["words"].get<std::string>().find("1 (nodule)"), std::string::npos) << by_name;
  const json loaded =
      client.ask(R"({"do": "load", "organ": "liver", "inclusions": ["cyst"], "tool": "sphere:5"})");
  EXPECT_FALSE(loaded.contains("error")) << loaded;
  EXPECT_EQ(client.ask(R"({"do": "scene"})")["scene"]["inclusions"][0]["name"], "cyst");
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, TheSurfaceIsSentOnceAtRestAndThenWhereItHasMoved) {
  const Folder folder;
  Serve serve(folder, {"--tool", "sphere:5", "--wait", "--duration-s", "600"});
  LiveClient client(serve.port());
  client.greet();
  const json rest = client.ask(R"({"do": "surface", "at_rest": true})")["surface"];
  EXPECT_EQ(rest["run"], 0);
  EXPECT_EQ(rest["triangles"].size(),
            3 * client.ask(R"({"do": "scene"})")["scene"]["organ_triangles"].get<std::size_t>());
  EXPECT_EQ(client.ask(R"({"do": "surface"})")["error"]["code"], "state") << "nothing was played";
  client.ask(R"({"do": "start"})");
  // The scripted tool touches after 1.3 s and is 10 mm deep after 3 s.
  json moved;
  double deepest = 0.0;
  for (int i = 0; i < 3000 && deepest < 5.0; ++i) {
    std::this_thread::sleep_for(20ms);
    moved = client.ask(R"({"do": "surface"})")["surface"];
    deepest = 0.0;
    for (std::size_t at = 0; moved.is_object() && at < moved["moved"].size(); ++at) {
      const auto vertex = moved["moved"][at].get<std::size_t>();
      const double way =
          moved["vertices_mm"][3 * at + 2].get<double>() - rest["vertices_mm"][3 * vertex + 2].get<double>();
      deepest = std::max(deepest, -way);
    }
  }
  EXPECT_GE(deepest, 5.0) << moved;
  EXPECT_EQ(moved["run"], 1);
  EXPECT_GT(moved["tick"], 1300);
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, APictureHasTheContactsOfTheNewestTickAndAToolItsMesh) {
  const Folder folder;
  Serve serve(folder, {"--tool", "sphere:5", "--wait", "--duration-s", "600"});
  LiveClient client(serve.port());
  client.greet();
  EXPECT_GT(client.ask(R"({"do": "tool"})")["tool"]["parts"].at(0)["triangles"].size(), 100U);
  const json refused = client.ask(R"({"do": "tool", "hand": 1})")["error"];
  EXPECT_EQ(refused["code"], "refused");
  EXPECT_EQ(refused["field"], "hand");
  EXPECT_EQ(client.ask(R"({"do": "picture"})")["error"]["code"], "state") << "nothing was played";
  client.ask(R"({"do": "start"})");
  json picture;
  double deepest = 0.0;
  for (int i = 0; i < 3000 && deepest < 5e-3; ++i) {
    std::this_thread::sleep_for(20ms);
    picture = client.ask(R"({"do": "picture"})")["picture"];
    if (!picture.is_object()) continue;
    for (const json& contact : picture["hands"].at(0)["contacts"]) {
      deepest = std::max(deepest, contact["depth_m"].get<double>());
    }
  }
  EXPECT_GE(deepest, 5e-3) << picture;
  EXPECT_EQ(picture["run"], 1);
  EXPECT_NEAR(picture["hands"][0]["contacts"][0]["tip_radius_m"].get<double>(), 5e-3, 1e-12);
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, AnOrganThatIsTooFineToBeSentIsReportedSoAndPlayed) {
  const Folder folder;
  Serve serve(folder, {"--organ", "gallbladder-30k", "--tool", "sphere:5", "--wait"});
  LiveClient client(serve.port());
  client.greet();
  const json refused = client.ask(R"({"do": "surface", "at_rest": true})")["error"];
  EXPECT_EQ(refused["code"], "refused");
  EXPECT_NE(refused["words"].get<std::string>().find("must have at most 20000 to be sent"), std::string::npos)
      << refused;
  client.ask(R"({"do": "start"})");
  await_tick(client, 1);
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, AFaultIsReportedToClientsInWordsAndTheyMayResetIt) {
  const Folder folder;
  std::ofstream(folder / "faulty.toml") << "[organ]\nmesh = \"gallbladder\"\n[tool]\nmesh = \"sphere:3\"\n"
                                           "[device]\nkind = \"emulated\"\n[[device.fault]]\nkind = \"nan\"\n"
                                           "time_s = 0.2\n";
  Serve serve(folder, {"faulty.toml", "--wait"});
  LiveClient client(serve.port());
  client.greet();
  EXPECT_EQ(client.ask(R"({"do": "state"})")["run"]["state"], "waiting");
  EXPECT_EQ(client.ask(R"({"do": "reset_faults"})")["error"]["code"], "state");
  client.say(R"({"do": "start"})");
  const auto fault_event = [](const json& message) { return message.value("event", "") == "fault"; };
  const json fault = client.hear_until(fault_event)["fault"];
  EXPECT_EQ(fault["fault"], "not-finite") << fault;
  EXPECT_EQ(fault["tick"], 200);
  EXPECT_EQ(fault["words"], "a device sample or a force was not finite");
  client.say(R"({"do": "reset_faults"})");
  EXPECT_EQ(client.hear_until(fault_event)["fault"]["fault"], "none");
  EXPECT_EQ(serve.end().exit_code, 3) << "also when it was reset";
}

TEST(Serve, ASceneThatIsLoadedFollowsTheOneBeforeAndOneThatCannotBeLeavesIt) {
  const Folder folder;
  const Folder elsewhere;
  std::ofstream(folder / "heart.toml") << "[scene]\nname = \"a heart\"\n[organ]\nmesh = \"heart\"\ntissue = "
                                          "\"heart\"\n[tool]\nmesh = \"sphere:3\"\n";
  std::ofstream(folder / "mouse.toml") << "[organ]\nmesh = \"heart\"\n[tool]\nmesh = \"sphere:3\"\n[device]\n"
                                          "kind = \"mouse\"\n";
  Serve serve(elsewhere, {"--scenes", folder.path().string(), "--device", "emulated", "--duration-s", "600",
                          "--record", "runs.h5"});
  LiveClient client(serve.port());
  client.greet();
  const auto refusal = [&client](const std::string& members) {
    const json answer = client.ask(R"({"do": "load", )" + members + "}");
    return answer.contains("error") ? answer["error"]["words"].get<std::string>() : "it was not refused";
  };
  EXPECT_NE(refusal(R"("scene": "../secret.toml")").find("below the server's --scenes"), std::string::npos);
  EXPECT_NE(refusal(R"("scene": "/etc/passwd")").find("below the server's --scenes"), std::string::npos);
  EXPECT_NE(refusal(R"("scene": "none.toml")").find("none.toml"), std::string::npos);
  EXPECT_NE(refusal(R"("organ": "lung")").find("lung"), std::string::npos);
  EXPECT_NE(refusal(R"("scene": "mouse.toml")").find("device mouse"), std::string::npos);
  EXPECT_NE(refusal(R"("device": "forcedimension:/tmp/a.so")").find("scripted"), std::string::npos);
  json run = client.ask(R"({"do": "state"})")["run"];
  EXPECT_EQ(run["number"], 1) << "the first run goes on";
  EXPECT_EQ(run["state"], "running");
  await_tick(client, 1);  // the run has a recording after this
  const json loaded = client.ask(R"({"do": "load", "scene": "heart.toml", "device": "emulated"})");
  EXPECT_EQ(loaded["run"]["number"], 2) << loaded;
  EXPECT_EQ(loaded["run"]["scene"], "a heart");
  await_tick(client, 2);
  EXPECT_EQ(client.ask(R"({"do": "scene"})")["tissue"]["name"], "heart");
  client.ask(R"({"do": "set_tissue", "tissue": {"k1_N_per_m": 44}})");
  client.ask(R"({"do": "stop"})");
  const json again = client.ask(R"({"do": "start"})");
  EXPECT_EQ(again["run"]["number"], 3) << again;
  await_tick(client, 3);
  EXPECT_EQ(client.ask(R"({"do": "scene"})")["tissue"]["k1_N_per_m"], 44.0) << "start keeps the tissue";
  EXPECT_EQ(client.ask(R"({"do": "start"})")["error"]["code"], "state");
  const Outcome outcome = serve.end();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(elsewhere.names(), (std::vector<std::string>{"runs-2.h5", "runs-3.h5", "runs.h5"}));
}

TEST(Serve, ASceneThatAClientLoadsNamesNoFileOutsideTheFolderAndQuotesNone) {
  const Folder scenes;
  const Folder outside;
  const Folder elsewhere;
  (void)outside.write("shadow.toml", "root:$6$secret:19000:0\n");
  (void)scenes.write("s.toml", "[organ]\nmesh = \"gallbladder\"\ntissue = \"" + outside / "shadow.toml" +
                                   "\"\n[tool]\nmesh = \"sphere:3\"\n");
  Serve serve(elsewhere, {"--scenes", scenes.path().string(), "--wait"});
  LiveClient client(serve.port());
  client.greet();
  const std::string words = client.ask(R"({"do": "load", "scene": "s.toml"})").dump();
  EXPECT_NE(words.find("organ.tissue"), std::string::npos) << words;
  EXPECT_NE(words.find("must be a file below " + scenes.path().string()), std::string::npos) << words;
  EXPECT_EQ(words.find("secret"), std::string::npos) << words;
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, AClientsSceneOpensNoDeviceWithWhichTheServerWasNotStarted) {
  const Folder folder;
  ASSERT_EQ(run(folder, {"run", "--offline", "--duration-s", "0.1", "--record", "own.h5"}).exit_code, 0);
  fs::copy_file(folder / "own.h5", folder / "other.h5");
  const auto write = [&folder](const std::string& name, const std::string& device) {
    (void)folder.write(
        name,
        "[organ]\nmesh = \"gallbladder\"\n[tool]\nmesh = \"curved-forceps\"\n[device]\n" + device + "\n");
  };
  write("port.toml", "kind = \"igtl\"\npath = \"18999/H\"");
  write("all.toml", "kind = \"igtl\"\npath = \"0.0.0.0:18999/H\"");
  write("service.toml", "kind = \"haply\"\npath = \"ws://192.0.2.1:10001\"");
  write("arm.toml", "kind = \"touch\"");
  write("library.toml", "kind = \"forcedimension\"");
  write("topic.toml", "kind = \"ros\"");
  write("other.toml", "kind = \"replay\"\npath = \"other.h5\"");
  write("own.toml", "kind = \"replay\"\npath = \"own.h5\"");
  Serve serve(folder, {"--scenes", folder.path().string(), "--device", "replay:own.h5"});
  LiveClient client(serve.port());
  client.greet();
  for (const char* name : {"port", "service", "arm", "library", "topic", "other"}) {
    const json answer = client.ask(json{{"do", "load"}, {"scene", std::string(name) + ".toml"}}.dump());
    ASSERT_TRUE(answer.contains("error")) << name << answer;
    const auto words = answer["error"]["words"].get<std::string>();
    EXPECT_NE(words.find("or a device with which the server was started"), std::string::npos) << words;
  }
  const json all = client.ask(R"({"do": "load", "scene": "all.toml"})");
  EXPECT_NE(all["error"]["words"].get<std::string>().find("must be PORT/NAME"), std::string::npos) << all;
  EXPECT_EQ(client.ask(R"({"do": "load", "scene": "own.toml"})")["run"]["number"], 2);
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, AClientStartsWithMadeUpDevicesAloneAndRecordsNothing) {
  const Folder folder;
  Serve serve(folder, {"--wait", "--duration-s", "600"});
  LiveClient client(serve.port());
  client.greet();
  const json devices = client.ask(R"({"do": "devices"})")["devices"];
  ASSERT_EQ(devices.size(), 2U) << devices;
  EXPECT_EQ(devices[0]["device"], "scripted");
  EXPECT_EQ(devices[1]["device"], "emulated");
  for (const char* const device : {"haply", "mouse"}) {
    const json refused = client.ask(json{{"do", "start"}, {"device", device}}.dump());
    EXPECT_EQ(refused["error"]["field"], "device") << refused;
  }
  ASSERT_EQ(client.ask(R"({"do": "start", "device": "emulated"})")["answer"], "start");
  await_tick(client, 1);
  EXPECT_EQ(client.ask(R"({"do": "scene"})")["scene"]["hands"][0]["device"], "emulated");
  EXPECT_EQ(client.ask(R"({"do": "record", "on": true})")["error"]["words"],
            "record: this server records only with --record FILE.h5");
  EXPECT_EQ(client.ask(R"({"do": "mouse", "deeper_mm": 1})")["error"]["code"], "state");
  serve.end();
  EXPECT_TRUE(folder.names().empty());
}

TEST(Serve, WhatIsWrongWithAFileOfTheCommandLineIsReportedThereAndNotToClients) {
  const Folder folder;
  (void)folder.write("mine.toml",
                     "[tissue]\nname = \"mine\"\nlaw = \"smooth\"\nk1_N_per_m = 20.0\nbeta = 1.6\nq = 0.7\n"
                     "rest_length_mm = 14.0\nmax_length_mm = 22.0\nmin_length_mm = 6.0\nt1_us = 1.0\n");
  Serve serve(folder, {"--tissue", "mine.toml", "--device", "emulated", "--duration-s", "600"});
  LiveClient client(serve.port());
  client.greet();
  client.ask(R"({"do": "stop"})");
  (void)folder.write("mine.toml", "a-secret-line here\n");
  const std::string words = client.ask(R"({"do": "start"})").dump();
  EXPECT_NE(words.find("the server's own messages give the reason"), std::string::npos) << words;
  EXPECT_EQ(words.find("secret"), std::string::npos) << words;
  const Outcome outcome = serve.end();
  EXPECT_NE(outcome.err.find("mine.toml:1"), std::string::npos) << outcome.err;
}

TEST(Serve, AClientsRunTakesANumberThatNoRecordingHas) {
  const Folder folder;
  for (const char* name : {"run.h5", "run-3.h5"}) (void)folder.write(name, "of somebody");
  Serve serve(folder, {"--wait", "--record", "run.h5", "--device", "emulated", "--duration-s", "600"});
  LiveClient client(serve.port());
  client.greet();
  EXPECT_EQ(client.ask(R"({"do": "start"})")["run"]["recording"], "run-2.h5");
  EXPECT_EQ(client.ask(R"({"do": "load", "task": "pull", "device": "emulated"})")["run"]["recording"],
            "run-4.h5");
  EXPECT_EQ(serve.end().exit_code, 0);
  EXPECT_EQ(text_of(folder / "run.h5"), "of somebody");
  EXPECT_EQ(text_of(folder / "run-3.h5"), "of somebody");
}

TEST(Serve, ASceneThatIsLoadedInPlaceOfOneThatWaitsIsOnItsWayUntilItRuns) {
  const Folder folder;
  Serve serve(folder, {"--wait"});
  LiveClient client(serve.port());
  client.greet();
  const json kept = client.ask(R"({"do": "set_tissue", "tissue": {"k1_N_per_m": 21}})");
  EXPECT_TRUE(kept["change"].is_null()) << "nothing is running";
  client.say(R"({"do": "load", "id": "l", "task": "pull"})");
  EXPECT_EQ(client.ask(R"({"do": "start"})")["error"]["code"], "state") << "one at a time";
  json loaded;
  for (int i = 0; i < 20'000 && loaded.is_null(); ++i) {
    client.say(R"({"do": "state", "id": "s"})");
    const json answer = client.hear_until([](const json& message) { return message.contains("answer"); });
    ASSERT_TRUE(answer.contains("run")) << answer;
    if (answer["id"] == "l") loaded = answer["run"];
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_EQ(loaded["number"], 1);
  EXPECT_EQ(loaded["scene"], "heart pull");
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, WhileASceneIsLoadedOthersAreAnsweredAndTheNextLoadOrStopBreaksItOff) {
  const Folder folder;
  Serve serve(folder, {"--wait", "--no-cache"});
  const std::uint16_t port = serve.port();
  LiveClient loader(port);
  loader.greet();
  LiveClient other(port);
  other.greet();
  const std::string large = R"({"do": "load", "organ": "gallbladder-300k", "tool": "sphere:5", "id": )";
  loader.say(large + "1}");
  EXPECT_EQ(loader.ask(R"({"do": "state"})")["run"]["loading"], true);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(other.ask(R"({"do": "state"})")["run"]["loading"], true);
  loader.say(large + "2}");
  const auto answer = [](const json& message) { return message.contains("answer"); };
  const json first = loader.hear_until(answer);
  EXPECT_EQ(first["id"], 1) << first;
  EXPECT_EQ(first["error"]["code"], "state") << first;
  EXPECT_EQ(first["error"]["words"], "the load was cancelled by the next load");
  EXPECT_EQ(other.ask(R"({"do": "stop"})")["run"]["state"], "waiting");
  const json second = loader.hear_until(answer);
  EXPECT_EQ(second["id"], 2) << second;
  EXPECT_EQ(second["error"]["words"], "the load was cancelled by stop");
  EXPECT_EQ(other.ask(R"({"do": "state"})")["run"]["loading"], false);
  EXPECT_EQ(loader.ask(R"({"do": "load", "task": "pull"})")["run"]["scene"], "heart pull")
      << "one that ends plays";
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, QuittingDoesNotWaitForASceneThatIsBeingPrepared) {
  const Folder folder;
  Serve serve(folder, {"--wait", "--no-cache"});
  LiveClient client(serve.port());
  client.greet();
  client.say(R"({"do": "load", "organ": "gallbladder-300k", "tool": "sphere:5"})");
  EXPECT_EQ(client.ask(R"({"do": "state"})")["run"]["loading"], true);
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, TheLastClientsLeavingEndsARunWhereThatIsAskedFor) {
  const Folder folder;
  Serve serve(folder, {"--device", "emulated", "--duration-s", "600", "--stop-when-alone"});
  const std::uint16_t port = serve.port();
  LiveClient client(port);
  client.greet();
  EXPECT_EQ(client.ask(R"({"do": "state"})")["run"]["state"], "running") << "it begins without anyone";
  client.vanish();
  for (int i = 0; i < 6000 && lines(serve.out()) < 2; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(lines(serve.out()), 2U) << "the run's summary has come: " << serve.out();
  LiveClient next(port);
  next.greet();
  EXPECT_EQ(next.ask(R"({"do": "state"})")["run"]["state"], "ended");
  EXPECT_EQ(serve.end().exit_code, 0);
}

TEST(Serve, WhoMayConnectIsSaidByFlagsAndBadOnesAreRefusedBeforeAnythingIsPlayed) {
  const Folder folder;
  const auto refusal = [&folder](std::vector<std::string> words) {
    words.insert(words.begin(), "serve");
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
    return outcome.err;
  };
  const auto has = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(refusal({"--listen", "0.0.0.0"}), "--token-file FILE, or --new-token");
  has(refusal({"--listen", "here"}), "--listen here");
  has(refusal({"--allow-origin", "*"}), "--allow-origin *");
  has(refusal({"--token-file", "none"}), "--token-file none");
  has(refusal({"--port", "70000"}), "--port = 70000");
  has(refusal({"--scenes", "none"}), "--scenes none");
  has(refusal({"--page", "none.html"}), "--page none.html");
  has(refusal({"--page", "."}), "this folder has no index.html");
  has(refusal({"--device", "mouse"}), "device mouse");
  has(refusal({"--record", "none/run.h5"}), "--record none/run.h5");
  has(refusal({"--organ", "lung"}), "lung");
}

TEST(Serve, ATokenFromAFileIsAskedForAndNeverPrinted) {
  const Folder folder;
  std::ofstream(folder / "token") << "a-secret-of-the-laboratory\n";
  chmod((folder / "token").c_str(), 0600);
  Serve serve(folder, {"--token-file", "token", "--wait"});
  const std::uint16_t port = serve.port();
  LiveClient wrong(port);
  EXPECT_EQ(wrong.greet("a-secret-of-the-library")["error"]["code"], "token");
  LiveClient right(port);
  EXPECT_EQ(right.greet("a-secret-of-the-laboratory")["answer"], "hello");
  const Outcome outcome = serve.end();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ((outcome.out + outcome.err).find("a-secret"), std::string::npos) << outcome.out << outcome.err;
}

TEST(Serve, TheExampleInPythonStreamsAndMakesTheTissueStiffer) {
  const Folder folder;
  Serve serve(folder, {"--wait", "--record", "run.h5"});
  const std::string port = std::to_string(serve.port());
  const std::string command = std::string("/usr/bin/python3 ") + PALPATE_EXAMPLES +
                              "/python/live_client.py --seconds 2 --port " + port + " > " +
                              (folder / "said") + " 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << text_of(folder / "said");  // NOLINT(concurrency-mt-unsafe)
  const std::string said = text_of(folder / "said");
  EXPECT_NE(said.find("gallbladder press, tissue gallbladder, k1 18.0 N/m"), std::string::npos) << said;
  EXPECT_NE(said.find("twice as stiff, by change 1"), std::string::npos) << said;
  EXPECT_EQ(serve.end().exit_code, 0);
  const record::Recording recording = record::read_recording(folder / "run.h5");
  ASSERT_EQ(recording.changes.size(), 1U);
  EXPECT_EQ(recording.changes[0].tissue.k1, 36.0);
}

TEST(Serve, TheStimulusServerExampleGivesWhatItsSealedCodesSayAndLogsCodesAlone) {
  const Folder folder;
  // No hand, so no fault when a busy machine lets the loop stand.
  Serve serve(folder, {"--device", "scripted", "--wait", "--record", "run.h5"});
  LiveClient starter(serve.port());
  starter.greet();
  EXPECT_EQ(starter.ask(R"({"do": "start"})")["answer"], "start");
  const std::string command = std::string("/usr/bin/python3 ") + PALPATE_EXAMPLES +
                              "/python/stimulus_server.py " + (folder / "mine") + " --trials 2 --port " +
                              std::to_string(serve.port()) + " > " + (folder / "said") + " 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << text_of(folder / "said");  // NOLINT(concurrency-mt-unsafe)
  EXPECT_EQ(serve.end().exit_code, 0);
  const std::string log = text_of(folder / "mine/trials.jsonl");
  EXPECT_EQ(log.find("\"noise\""), std::string::npos) << log;
  const json sealed = json::parse(text_of(folder / "mine/sealed.json"));
  std::vector<haptics::ParameterUpdate> changes = record::read_recording(folder / "run.h5").changes;
  ASSERT_EQ(changes.size(), 1U + 2 * 4U) << "off at first; on and off for each interval of two trials";
  std::istringstream lines(log);
  std::string line;
  std::getline(lines, line);  // the session's
  std::size_t next = 1;
  while (std::getline(lines, line)) {
    const json trial = json::parse(line);
    for (std::size_t i = 0; i < 2; ++i, next += 2) {
      EXPECT_EQ(changes[next].noise.enabled, sealed[trial["codes"][i].get<std::string>()] == "noise");
      const auto tick = [&](std::size_t k) {
        return std::llround(1000.0 * trial["onsets_s"][i][k].get<double>());
      };
      const auto began = static_cast<long long>(changes[next].tick);
      EXPECT_GE(began, tick(0));
      EXPECT_LE(began, tick(1));
    }
  }
  EXPECT_EQ(next, changes.size());
}

}  // namespace
}  // namespace palpate::tests
