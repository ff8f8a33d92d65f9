// `mpirun palpate fit` and `sweep` give the same bytes on any number of ranks, and resume after a
// lost rank.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/mpi_program.h"

namespace palpate::tests {
namespace {

/// Writes `count` curves of 12 points, of different tissues.
void write_curves(const Folder& folder, int count) {
  for (int n = 0; n < count; ++n) {
    std::ofstream file(folder / ("s" + std::to_string(n) + ".csv"));
    file << "displacement_mm,force_N\n";
    for (int i = 1; i <= 12; ++i) {
      const double d = 1.0 * i;
      file << d << ',' << 0.05 * (std::exp(d / (3.6 + 0.2 * n)) - 1.0) + 1e-3 * std::sin(37.0 * i + n)
           << '\n';
    }
  }
}

std::string curves(int count) {
  std::string words;
  for (int n = 0; n < count; ++n) words += " s" + std::to_string(n) + ".csv";
  return words;
}

/// The children of a process.
std::vector<pid_t> children_of(pid_t parent) {
  const std::string id = std::to_string(parent);
  std::istringstream text(text_of("/proc/" + id + "/task/" + id + "/children"));
  std::vector<pid_t> children;
  for (pid_t child = 0; text >> child;) children.push_back(child);
  return children;
}

std::size_t results_in(const Folder& folder) {
  std::istringstream text(text_of(folder / "t.toml.fits.jsonl"));
  std::size_t count = 0;
  for (std::string line; std::getline(text, line);) count += line.empty() ? 0 : 1;
  return count;
}

TEST(Mpi, GivesTheSameBytesOnOneTwoAndFourRanks) {
  const Folder folder;
  write_curves(folder, 2);
  const std::string words =
      "fit" + curves(2) + " --bootstrap 4 --sweep q=0.3:1.2:3 --sweep-csv q.csv --json --out t.toml";
  ASSERT_EQ(shell(folder, "'" + std::string(PALPATE_PROGRAM) + "' " + words), 0) << text_of(folder / "err");
  const std::string alone = text_of(folder / "out");
  const std::string swept = text_of(folder / "q.csv");
  // Three values of each specimen and of both together, and the values added near the fit.
  EXPECT_GE(std::count(swept.begin(), swept.end(), '\n'), 1 + 3 * 3);
  const std::string tissue = text_of(folder / "t.toml");
  for (const int ranks : {1, 2, 4}) {  // four ranks share each specimen's bootstrap; two share specimens
    ASSERT_EQ(shell(folder, by_mpi(ranks, words)), 0) << text_of(folder / "err");
    EXPECT_EQ(text_of(folder / "out"), alone) << ranks << " ranks";
    EXPECT_EQ(text_of(folder / "t.toml"), tissue) << ranks << " ranks";
    EXPECT_EQ(text_of(folder / "q.csv"), swept) << ranks << " ranks";
  }
  EXPECT_FALSE(fs::exists(folder / "t.toml.fits.jsonl"));  // removed after success
}

TEST(Mpi, OnlyTheFirstRankTellsOfBadInput) {
  const Folder folder;
  EXPECT_EQ(shell(folder, by_mpi(2, "fit nowhere.csv")), 2);
  const std::string err = text_of(folder / "err");
  const std::size_t first = err.find("nowhere.csv: there is no such file");
  ASSERT_NE(first, std::string::npos) << err;
  EXPECT_EQ(err.find("nowhere.csv", first + 20), std::string::npos) << err;
}

TEST(Mpi, ASweepGoesOnWhereItWasBrokenOff) {
  const Folder folder;
  write_curves(folder, 1);
  const std::string words = "fit s0.csv --json --out t.toml";
  const std::string alone = "'" + std::string(PALPATE_PROGRAM) + "' " + words;
  const std::string sweeps = " --sweep q=0.3:1.2:4 --sweep beta=1:5:4";
  ASSERT_EQ(shell(folder, alone + sweeps), 0) << text_of(folder / "err");
  const std::string whole = text_of(folder / "out");
  fs::create_directories(folder / "r/report.html");
  // The page cannot be written because a folder has its name. The results are kept.
  ASSERT_EQ(shell(folder, alone + " --sweep q=0.3:1.2:4 --report r"), 2);
  EXPECT_EQ(results_in(folder), 3U);  // the fit and both halves of the sweep
  ASSERT_EQ(shell(folder, by_mpi(2, words + sweeps)), 0) << text_of(folder / "err");
  EXPECT_THAT(text_of(folder / "err"),
              testing::HasSubstr("2 parts of sweeps were finished in an earlier run"));
  EXPECT_EQ(text_of(folder / "out"), whole);
}

TEST(Mpi, ASweepOfASceneGivesTheSameTablesOnOneAndThreeRanks) {
  const Folder folder;
  std::ofstream(folder / "press.toml") << "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:3\"\n";
  const std::string words =
      "sweep press.toml --duration-s 1.5 --set tissue.k1=10:40:4 --set organ.tissue=liver,heart --json "
      "--out ";
  ASSERT_EQ(shell(folder, "'" + std::string(PALPATE_PROGRAM) + "' " + words + "d"), 0)
      << text_of(folder / "err");
  const std::string alone = text_of(folder / "out");
  const std::string csv = text_of(folder / "d/results.csv");
  const std::string hdf5 = text_of(folder / "d/results.h5");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 4 * 2);
  for (const int ranks : {1, 3}) {
    fs::remove_all(folder / "d");
    ASSERT_EQ(shell(folder, by_mpi(ranks, words + "d")), 0) << text_of(folder / "err");
    EXPECT_EQ(text_of(folder / "out"), alone) << ranks << " ranks";
    EXPECT_EQ(text_of(folder / "d/results.csv"), csv) << ranks << " ranks";
    EXPECT_EQ(text_of(folder / "d/results.h5"), hdf5) << ranks << " ranks";
  }
}

TEST(Mpi, ALostRankLosesOnlyWhatWasUnderWay) {
  const Folder folder;
  write_curves(folder, 3);
  const std::string words = "fit" + curves(3) + " --bootstrap 12 --json --out t.toml";
  const pid_t launcher = fork();
  if (launcher == 0) {
    if (chdir(folder.path().c_str()) != 0 || std::freopen("killed", "w", stderr) == nullptr) _exit(127);
    const std::string command = "exec " + by_mpi(2, words);
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  std::vector<pid_t> ranks;
  while (results_in(folder) < 1 && waitpid(launcher, nullptr, WNOHANG) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ranks = children_of(launcher);
  ASSERT_EQ(ranks.size(), 2U) << text_of(folder / "killed");
  kill(ranks[1], SIGKILL);
  int status = 0;
  waitpid(launcher, &status, 0);
  EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  const std::size_t kept = results_in(folder);
  ASSERT_GE(kept, 1U);
  ASSERT_EQ(shell(folder, by_mpi(2, words)), 0) << text_of(folder / "err");
  EXPECT_THAT(text_of(folder / "err"), testing::HasSubstr("of 3 specimens were fitted in an earlier run"));
  const std::string resumed = text_of(folder / "out");
  ASSERT_EQ(shell(folder, "'" + std::string(PALPATE_PROGRAM) + "' " + words), 0);
  EXPECT_EQ(resumed, text_of(folder / "out"));
}

}  // namespace
}  // namespace palpate::tests
