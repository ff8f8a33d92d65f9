// `palpate bench`: rejected arguments, form of the output, and search for palpate-bench. No test depends on
// times.
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/program.h"

namespace palpate::tests {
namespace {

/// Copy of the program in a folder that is neither an installation nor a build tree.
class MovedProgram : public testing::Test {
 protected:
  void SetUp() override { fs::copy_file(PALPATE_PROGRAM, folder_ / "palpate"); }

  /// Both output streams of `palpate bench` in that folder, with palpate-bench in the search path.
  Outcome bench(const std::string& flags) { return in_shell("./palpate bench " + flags); }

  /// Both output streams of a command line in that folder.
  Outcome in_shell(const std::string& line) {
    const std::string command =
        "cd '" + folder_.path().string() + "' && PATH=\"$PWD/on_path:$PATH\" " + line + " 2>&1";
    std::FILE* output = popen(command.c_str(), "r");
    Outcome outcome;
    std::array<char, 256> part{};
    while (std::fgets(part.data(), part.size(), output) != nullptr) outcome.out += part.data();
    outcome.exit_code = WEXITSTATUS(pclose(output));
    return outcome;
  }

  Folder folder_;
};

TEST_F(MovedProgram, ExecutesPalpateBenchInItsOwnFolder) {
  fs::copy_file(PALPATE_BENCH, folder_ / "palpate-bench");
  const Outcome outcome = bench("--help");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.out.find("palpate bench [OPTIONS]"), std::string::npos) << outcome.out;
}

TEST_F(MovedProgram, WithoutPalpateBenchExitsTwoAndSaysHowToGetItWhateverIsOnThePath) {
  fs::create_directory(folder_ / "on_path");
  fs::copy_file(PALPATE_BENCH, folder_ / "on_path/palpate-bench");
  const Outcome outcome = bench("--help");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(lines(outcome.out), 1U) << outcome.out;
  EXPECT_NE(outcome.out.find("--target palpate_bench"), std::string::npos) << outcome.out;
}

TEST_F(MovedProgram, ExecutesAProgramInLibexec) {
  fs::create_directories(folder_ / "bin");
  fs::create_directories(folder_ / "libexec/palpate");
  fs::copy_file(PALPATE_PROGRAM, folder_ / "bin/palpate");
  fs::copy_file(PALPATE_BENCH, folder_ / "libexec/palpate/palpate-bench");
  EXPECT_EQ(in_shell("bin/palpate bench --help").exit_code, 0);
}

TEST_F(MovedProgram, WithoutTheProgramOfAComponentItsCommandsExitTwoAndNameThePackage) {
  const std::vector<std::pair<std::string, std::string>> packages = {
      {"fit", "palpate-fit"},     {"validate", "palpate-fit"},      {"sweep", "palpate-fit"},
      {"study", "palpate-study"}, {"generate", "palpate-learning"}, {"ros", "palpate-ros"}};
  for (const auto& [command, package] : packages) {
    const Outcome outcome = in_shell("./palpate " + command + " --help");
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(lines(outcome.out), 1U) << outcome.out;
    EXPECT_NE(outcome.out.find(command + ": needs the program"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("install the package " + package), std::string::npos) << outcome.out;
  }
}

TEST_F(MovedProgram, ACommandOfAComponentIsTheFirstWord) {
  const Outcome outcome = in_shell("./palpate -- fit a.csv");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(lines(outcome.out), 1U) << outcome.out;
}

TEST(Bench, BadOptionsExitTwoInOneLineAndWriteNothing) {
  const Folder folder;
  for (const auto& wrong : std::vector<std::vector<std::string>>{{"--nonsense"},
                                                                 {"--quick", "--full"},
                                                                 {"--hands", "0"},
                                                                 {"--hands", "-3"},
                                                                 {"--hands", "many"},
                                                                 {"--hands", "1000000000"},
                                                                 {"--csv", "no/such/folder.csv"},
                                                                 {"--csv", "."}}) {
    std::vector<std::string> words = {"bench"};
    words.insert(words.end(), wrong.begin(), wrong.end());
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << wrong.front();
    EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(folder.names().empty()) << wrong.front();
  }
}

TEST(Bench, PartsAloneAreMeasuredAloneAndWrittenAsCsvToo) {
  const Folder folder;
  const Outcome outcome = run(folder, {"bench", "--parts", "--json", "--csv", "b.csv"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(json["law_ns"].is_number());
  EXPECT_TRUE(json["tick"].empty());
  EXPECT_TRUE(json["hands_per_core"].is_null());
  EXPECT_EQ(json["command"], "palpate bench --parts --json --csv b.csv");
  EXPECT_NE(text_of(folder / "b.csv").find("part,noise sample by number"), std::string::npos);
}

TEST(Bench, SaysWhatItMeasuresWhereNoTerminalIs) {
  const Folder folder;
  EXPECT_EQ(run(folder, {"bench", "--parts"}).err.rfind("bench: 0 % ", 0), 0U);
}

TEST(Bench, QuickHasTheDocumentedKeys) {
  const Folder folder;
  const Outcome outcome = run(folder, {"bench", "--quick", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json["tick"].size(), 2U);
  for (const auto& tick : json["tick"]) {
    for (const char* key : {"organ_triangles", "tool_triangles", "p50_us", "p99_us", "p999_us", "max_us"})
      EXPECT_TRUE(tick.at(key).is_number()) << key;
    EXPECT_GT(tick["ticks"], 1000);
    EXPECT_GT(tick["approach_ticks"], 1000);
  }
  for (const char* key : {"machine", "law_ns", "inverse_ns", "noise_ns", "preparation", "peers"})
    EXPECT_TRUE(json.contains(key)) << key;
}

}  // namespace
}  // namespace palpate::tests
