// Runs in real time: messages about faults during the run, resets by a signal, the core, and `palpate
// doctor`.
#include <array>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/recording.h"

#include "tests/broken_hand.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;

TEST(RealTime, AFaultIsReportedWhileTheRunGoesOnAndAResetBySignalReachesTheNextTick) {
  const Folder folder;
  record_broken_hand(folder / "hand.h5", 20'000, 100);
  Program program(folder.path(), {"run", "--device", "replay:hand.h5", "--headless", "--record", "run.h5",
                                  "--json", "--duration-s", "3"});
  for (int i = 0; i < 6000 && !fs::exists(folder / "run.h5"); ++i) std::this_thread::sleep_for(10ms);
  std::this_thread::sleep_for(1s);
  program.signal(SIGUSR1);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 3) << "also when it was reset: " << outcome.err;
  EXPECT_NE(outcome.err.find("fault at tick 100 (0.1 s), hand 0: a device sample"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("kill -USR1 "), std::string::npos) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary["ticks"], 3000);
  EXPECT_EQ(summary["fault"], "not-finite");
  ASSERT_GE(summary["faults"].size(), 1u);
  EXPECT_EQ(summary["faults"][0]["tick"], 100);
  EXPECT_EQ(summary["faults"][0]["hand"], 0);
  EXPECT_TRUE(summary["faults"][0]["reset_tick"].is_number()) << summary["faults"];
  EXPECT_EQ(summary["watchdog_stops"], 0) << "no hand holds a replayed device";
  const record::Recording recording = record::read_recording(folder / "run.h5");
  std::uint64_t resets = 0;
  for (const haptics::TickRow& row : recording.rows) resets += row.events & haptics::kResetFault;
  EXPECT_EQ(resets, 1u);
  EXPECT_EQ(recording.rows.back().fault, 0u) << "clear after the reset";
  EXPECT_EQ(run(folder, {"replay", "run.h5", "--verify"}).exit_code, 0) << "a replay meets the same reset";
}

TEST(RealTime, ALoopThatStoodStillWithADeviceInAHandIsAFaultThatIsReportedAndRecorded) {
  const Folder folder;
  Program program(folder.path(), {"run", "--device", std::string("forcedimension:") + PALPATE_DHD_STAND_IN,
                                  "--headless", "--record", "run.h5", "--json", "--duration-s", "2"});
  for (int i = 0; i < 6000 && !fs::exists(folder / "run.h5"); ++i) std::this_thread::sleep_for(10ms);
  program.signal(SIGSTOP);
  std::this_thread::sleep_for(300ms);
  program.signal(SIGCONT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("the loop stood still for 20 ms"), std::string::npos) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary["fault"], "stalled-loop");
  EXPECT_EQ(summary["ticks"], 2000) << "the run goes on";
  EXPECT_EQ(run(folder, {"replay", "run.h5", "--verify"}).exit_code, 0) << "a replay meets the same fault";
  for (const haptics::TickRow& row : record::read_recording(folder / "run.h5").rows) {
    if (row.fault == 0) continue;
    EXPECT_EQ(row.force, (std::array<double, 3>{})) << "tick " << row.tick;
  }
}

TEST(RealTime, ACoreThatCannotBeUsedIsRefusedInOneLineAndNothingIsWritten) {
  const Folder folder;
  const Outcome outcome = run(folder, {"run", "--core", "4096", "--record", "r.h5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(lines(outcome.err), 1u) << outcome.err;
  EXPECT_NE(outcome.err.find("--core = 4096"), std::string::npos) << outcome.err;
  EXPECT_TRUE(folder.names().empty());
}

TEST(RealTime, APolledRunIsSaidToBeOneInSummaryAndRecordingAndReplaysToTheBit) {
  const Folder folder;
  for (const bool polled : {false, true}) {
    std::vector<std::string> words{"run", "--duration-s", "0.3", "--record", "r.h5", "--json"};
    if (polled) words.emplace_back("--poll");
    const Outcome outcome = run(folder, words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["polled"], polled);
    EXPECT_EQ(record::read_recording(folder / "r.h5").facts.polled, polled);
    EXPECT_EQ(run(folder, {"replay", "r.h5", "--verify"}).exit_code, 0);
  }
}

TEST(RealTime, ThePrintedSummarySaysThatTheRunPolled) {
  const Folder folder;
  const std::string words = "in real time, polling the clock";
  EXPECT_NE(run(folder, {"run", "--duration-s", "0.1", "--poll"}).out.find(words), std::string::npos);
  EXPECT_EQ(run(folder, {"run", "--duration-s", "0.1"}).out.find(words), std::string::npos);
}

TEST(RealTime, PollingOfflineIsRefusedSinceNothingIsWaitedFor) {
  const Folder folder;
  const Outcome outcome = run(folder, {"run", "--offline", "--poll", "--record", "r.h5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--poll"), std::string::npos) << outcome.err;
  EXPECT_TRUE(folder.names().empty());
}

TEST(RealTime, TheRecordingHoldsTheHistogramsThatTheSummaryIsFrom) {
  const Folder folder;
  const Outcome outcome = run(folder, {"run", "--duration-s", "0.3", "--record", "r.h5", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  const record::RunFacts facts = record::read_recording(folder / "r.h5").facts;
  std::uint64_t ticks = 0;
  std::uint64_t late = 0;
  for (const auto& bucket : facts.tick_histogram) ticks += bucket.count;
  for (const auto& bucket : facts.late_histogram) late += bucket.count;
  EXPECT_EQ(ticks, 300u);
  EXPECT_EQ(late, 300u);
  EXPECT_DOUBLE_EQ(static_cast<double>(facts.lateness.max_ns) / 1e3, summary["late_us"]["max"]);
  EXPECT_GE(facts.late_histogram.back().upper, facts.lateness.max_ns);
}

TEST(Doctor, SaysInWordsAndAsJsonWhatThisMachineLacks) {
  const Folder folder;
  const Outcome words = run(folder, {"doctor"});
  EXPECT_EQ(words.exit_code, 0);
  EXPECT_NE(words.out.find("real-time priority"), std::string::npos);
  EXPECT_NE(words.out.find("p99.9"), std::string::npos);
  const Outcome outcome = run(folder, {"doctor", "--json"});
  EXPECT_EQ(outcome.exit_code, 0);
  const auto found = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(found["checks"].size(), 10u);
  for (const auto& check : found["checks"]) {
    EXPECT_TRUE(check["verdict"] == "good" || check["verdict"] == "bad" || check["verdict"] == "unknown");
    EXPECT_EQ(check["verdict"] == "bad" && check["advice"].is_null(), false) << check;
  }
  EXPECT_EQ(found["wake_ups"]["samples"], 1000);
  EXPECT_TRUE(found["wake_ups"]["late_us"].contains("p999"));
  EXPECT_TRUE(found["wake_ups"]["polled_late_us"].contains("p999"));
  EXPECT_NE(words.out.find("palpate run --poll"), std::string::npos);
  EXPECT_EQ(run(folder, {"doctor", "--help"}).exit_code, 0);
}

/// Waits until the program waits for the first poses of a client, which it does for 30 s before the run.
bool awaits_poses(const Program& program) {
  for (int i = 0; i < 2000; ++i) {
    if (program.err_so_far().find("the run begins when a client sends poses") != std::string::npos)
      return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

TEST(RealTime, AResetBeforeTheRunHasNoEffectAndASignalToStopEndsThePreparationWithoutAFile) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    const Folder folder;
    Program program(folder.path(),
                    {"run", "--device", "igtl:18973/Hand", "--headless", "--record", "run.h5"});
    ASSERT_TRUE(awaits_poses(program)) << program.err_so_far();
    program.signal(SIGUSR1);
    std::this_thread::sleep_for(100ms);
    EXPECT_FALSE(program.ended()) << "a reset";
    program.signal(number);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 0) << number << outcome.err;
    EXPECT_NE(outcome.err.find("stopped before the run began"), std::string::npos) << outcome.err;
    EXPECT_TRUE(folder.names().empty());
  }
}

TEST(RealTime, TheEndOfTheTerminalEndsTheRunAndClosesTheRecording) {
  const Folder folder;
  Program program(folder.path(), {"run", "--device", "emulated", "--headless", "--record", "run.h5"});
  for (int i = 0; i < 6000 && !fs::exists(folder / "run.h5"); ++i) std::this_thread::sleep_for(10ms);
  program.signal(SIGHUP);  // by the shell, and by the kernel when the shell has ended
  program.signal(SIGHUP);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(record::read_recording(folder / "run.h5").facts.complete);
}

}  // namespace
}  // namespace palpate::tests
