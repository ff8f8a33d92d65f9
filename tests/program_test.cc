// Exit codes, messages and output files of the program.
#include "tests/program.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;

/// Waits at most a minute for a file. A recording appears with its first tick.
bool appears(const std::string& file) {
  for (int i = 0; i < 6000; ++i) {
    if (fs::exists(file)) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

/// Wall time of a 1 kHz recording: its ticks, and the delays that late ticks added to the schedule.
double covered_seconds(const std::string& csv) {
  constexpr double kPeriod = 1e-3;
  std::istringstream all(csv);
  std::string line;
  std::getline(all, line);
  const std::string head = line.substr(0, line.find("late_ns"));
  const auto column = std::count(head.begin(), head.end(), ',');
  double covered = 0.0;
  while (std::getline(all, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (std::ptrdiff_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
    const double late = std::stod(cell) * 1e-9;
    covered += kPeriod + (late >= kPeriod ? late : 0.0);
  }
  return covered;
}

TEST(Program, AloneItPrintsItsHelpAndExitsTwo) {
  const Folder folder;
  const Outcome outcome = run(folder, {});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("run"), std::string::npos);
}

TEST(Program, HelpAndVersionExitZero) {
  const Folder folder;
  EXPECT_EQ(run(folder, {"--help"}).exit_code, 0);
  const Outcome version = run(folder, {"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.rfind("palpate ", 0), 0u);
  const Outcome help = run(folder, {"run", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("Example: palpate run"), std::string::npos);
}

TEST(Program, BadUsageAndBadInputExitTwoInOneLineAndWriteNothing) {
  const Folder folder;
  const std::vector<std::string> outputs = {"--record", "r.h5", "--report", "rep", "--screenshot", "s.png"};
  const std::vector<std::vector<std::string>> wrongs = {
      {"--nonsense"},
      {"--task", "poke"},
      {"--organ", "none.stl", "--organ-unit", "mm"},
      {"--organ", "gallblader"},
      {"--tissue", "none.toml"},
      {"--rate-Hz", "fast"},
      {"--rate-Hz", "-1"},
      {"--duration-s", "-1"},
      {"--duration-s", "0"},
      {"--duration-s", "nan"},
      {"--duration-s", "1e300"},
      {"--seed", "one"},
      {"--max-missed", "few"},
      {"--device", "scripted:none.csv"},
      {"--device", "teleport"},
      {"--igtl", "70000"},
      {"--igtl", "0"},
      {"--igtl", "-1"},
      {"--igtl", "slicer"},
      {"--igtl", "here:18944"},
      {"--igtl", "192.0.2.1:18944"},  // an address for documentation, which no machine has
      {"none.toml"},
  };
  for (const auto& wrong : wrongs) {
    std::vector<std::string> words = {"run", "--offline", "--headless"};
    words.insert(words.end(), wrong.begin(), wrong.end());
    words.insert(words.end(), outputs.begin(), outputs.end());
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << wrong.front();
    EXPECT_EQ(lines(outcome.err), 1u) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(folder.names().empty()) << wrong.front();
  }
}

TEST(Program, AReportSaysTheCommandThatMadeIt) {
  const Folder folder;
  const Outcome outcome =
      run(folder, {"run", "--offline", "--duration-s", "0.05", "--report", "my report"}, kNoPictures);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(
      text_of(folder / "my report/report.html").find("palpate run --offline --duration-s 0.05 --report"),
      std::string::npos);
}

TEST(Program, OutputsThatCannotBeWrittenExitTwoAndLeaveTheOthersAlone) {
  const Folder folder;
  for (const auto& wrong : std::vector<std::vector<std::string>>{{"--record", "no/such/r.h5"},
                                                                 {"--record", "."},
                                                                 {"--screenshot", "no/such/s.png"},
                                                                 {"--report", "/dev/null/report"}}) {
    std::vector<std::string> words = {"run", "--offline", "--duration-s", "0.01"};
    words.insert(words.end(), wrong.begin(), wrong.end());
    if (wrong.front() != "--record") words.insert(words.end(), {"--record", "r.h5"});
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << wrong.front();
    EXPECT_EQ(lines(outcome.err), 1u) << outcome.err;
    EXPECT_NE(outcome.err.find(wrong.front()), std::string::npos) << outcome.err;
    EXPECT_TRUE(folder.names().empty()) << wrong.front();
  }
}

TEST(Program, ARunTellsWhatItWasLikeAndRecordsExactlyItsTicks) {
  const Folder folder;
  const Outcome outcome = run(
      folder, {"run", "--offline", "--duration-s", "0.3", "--rate-Hz", "1500", "--record", "r.h5", "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.front(), '{');
  EXPECT_NE(outcome.out.find("\"ticks\": 450"), std::string::npos) << outcome.out;
  EXPECT_EQ(run(folder, {"export", "r.h5", "--csv", "r.csv"}).exit_code, 0);
  EXPECT_EQ(lines(text_of(folder / "r.csv")), 451u);
}

TEST(Program, MaxMissedExceededExitsFourAndOtherwiseZero) {
  const Folder folder;
  EXPECT_EQ(run(folder, {"run", "--duration-s", "0.2", "--max-missed", "1000000"}).exit_code, 0);
  Program halted(folder.path(), {"run", "--duration-s", "1.5", "--max-missed", "0", "--record", "r.h5"});
  ASSERT_TRUE(appears(folder / "r.h5"));
  halted.signal(SIGSTOP);
  std::this_thread::sleep_for(100ms);
  halted.signal(SIGCONT);
  EXPECT_EQ(halted.wait().exit_code, 4) << "a tick came 100 ms late";
}

TEST(Program, CtrlCEndsTheRunInGoodOrderWithARecordingThatVerifies) {
  const Folder folder;
  Program program(folder.path(), {"run", "--duration-s", "600", "--record", "r.h5"});
  ASSERT_TRUE(appears(folder / "r.h5"));
  std::this_thread::sleep_for(300ms);
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("stopped before its end"), std::string::npos) << outcome.out;
  EXPECT_EQ(run(folder, {"replay", "r.h5", "--verify"}).exit_code, 0);
}

TEST(Program, KilledAtAnyMomentLeavesARecordingThatLacksAtMostTheLastSecond) {
  for (const auto moment : {50ms, 700ms, 1300ms, 2450ms}) {
    const Folder folder;
    Program program(folder.path(), {"run", "--duration-s", "600", "--record", "r.h5"});
    ASSERT_TRUE(appears(folder / "r.h5"));
    const auto seen = std::chrono::steady_clock::now();
    std::this_thread::sleep_for(moment);
    program.signal(SIGKILL);
    EXPECT_EQ(program.wait().exit_code, -1);
    const double ran = std::chrono::duration<double>(std::chrono::steady_clock::now() - seen).count();
    const Outcome exported = run(folder, {"export", "r.h5", "--csv", "r.csv"});
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
    EXPECT_GE(covered_seconds(text_of(folder / "r.csv")), ran - 1.0) << "after " << ran << " s";
  }
}

}  // namespace
}  // namespace palpate::tests
