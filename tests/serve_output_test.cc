// `palpate serve` whose outputs nobody reads.
#include <array>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "io/websocket/test/live_client.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using net::test::LiveClient;
using nlohmann::json;

/// The serving program with pipes as its outputs, of one page each. Nobody reads them but the test.
class PipedServe final {
 public:
  /// In long.toml lumps with long names coincide. Each summary has a remark of 500 bytes for each
  /// two.
  PipedServe() {
    std::string scene = "[organ]\nmesh = \"box\"\ntissue = \"liver\"\n[tool]\nmesh = \"sphere:5\"\n";
    for (const char lump : {'1', '2', '3', '4', '5', '6', '7', '8'}) {
      scene += "[[organ.inclusion]]\npreset = \"nodule\"\ndepth_mm = 10\nname = \"" + std::string(255, 'x') +
               lump + "\"\n";
    }
    (void)folder_.write("long.toml", scene);
    for (auto& ends : pipes_) {
      if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
      (void)fcntl(ends[1], F_SETPIPE_SZ, 4096);
    }
    child_ = fork();
    if (child_ != 0) {
      for (auto& ends : pipes_) close(ends[1]);
      return;
    }
    if (chdir(folder_.path().c_str()) != 0) _exit(127);
    setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1);  // one preparation of the organ is enough
    if (dup2(pipes_[0][1], 1) == 1 && dup2(pipes_[1][1], 2) == 2) {
      execl(PALPATE_PROGRAM, PALPATE_PROGRAM, "serve", "long.toml", "--scenes", ".", "--port", "0", "--json",
            nullptr);
    }
    _exit(127);
  }
  ~PipedServe() {
    for (auto& ends : pipes_) close(ends[0]);
    if (child_ > 0) kill(child_, SIGKILL);
    if (child_ > 0) waitpid(child_, nullptr, 0);
  }
  PipedServe(const PipedServe&) = delete;
  PipedServe& operator=(const PipedServe&) = delete;

  /// The first line of standard output.
  [[nodiscard]] std::string first_line() const {
    std::string line;
    for (char letter = 0; read(pipes_[0][0], &letter, 1) == 1 && letter != '\n';) line += letter;
    return line;
  }
  /// Ends the program, and reads all of its outputs. @return its exit code
  int end(std::string& out, std::string& err) {
    kill(child_, SIGINT);
    out = rest_of(pipes_[0][0]);
    err = rest_of(pipes_[1][0]);
    int status = 0;
    waitpid(std::exchange(child_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  static std::string rest_of(int pipe) {
    std::string text;
    std::array<char, 4096> some{};
    for (ssize_t got = 0; (got = read(pipe, some.data(), some.size())) > 0;) {
      text.append(some.data(), static_cast<std::size_t>(got));
    }
    return text;
  }

  Folder folder_;
  std::array<std::array<int, 2>, 2> pipes_{};  // of output and error
  pid_t child_ = -1;
};

TEST(Serve, OutputsThatNobodyReadKeepNoClientWaitingAndTheLostLinesAreCounted) {
  constexpr int kLoads = 30;
  PipedServe serve;  // the summaries are more than the pipe and the queue take
  LiveClient client(json::parse(serve.first_line())["listening"]["port"]);
  client.greet();
  for (int i = 0; i < kLoads; ++i) {
    const json run = client.ask(R"({"do": "load", "scene": "long.toml"})");
    ASSERT_EQ(run["run"]["number"], i + 2) << run;
  }
  EXPECT_EQ(client.ask(R"({"do": "stop"})")["run"]["state"], "ended");
  std::string out;
  std::string err;
  EXPECT_EQ(serve.end(out, err), 2) << "results are missing";
  const std::string words = " lines are missing, because nobody read the stream in time";
  const std::size_t at = err.rfind(words);
  ASSERT_NE(at, std::string::npos) << err;
  const std::string count = err.substr(err.rfind(' ', at - 1) + 1, at - err.rfind(' ', at - 1) - 1);
  EXPECT_EQ(lines(out) + std::stoul(count), kLoads + 2U) << "each run's summary, and what was served";
}

}  // namespace
}  // namespace palpate::tests
