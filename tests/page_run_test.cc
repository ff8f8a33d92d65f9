// `palpate run --page` with a client in place of the browser.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "net/test/live_client.h"
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
    std::this_thread::sleep_for(300ms);
  }
  EXPECT_TRUE(await_lines(program, 2)) << "the run goes on without its page";
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("/#" + place["token"].get<std::string>()), std::string::npos) << outcome.err;
  EXPECT_GT(record::read_recording(folder / "run.h5").rows.size(), 0U);
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
