// A run with a simulated service of Haply. However the run ends, the last command to the service is zero
// force.
#include <chrono>
#include <cmath>
#include <csignal>
#include <functional>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "io/websocket/test/haply_service.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using devices::test::Answer;
using devices::test::HaplyService;
using Clock = std::chrono::steady_clock;

/// The arm is at rest outside, then follows the default press, repeatedly, until it breaks. It is faster than
/// the default: a busy machine makes samples stale, and a press gives force where no sample did for all of
/// it.
class PressedArm final {
 public:
  PressedArm() : path_(scene::default_path(scene::load({}), 0)) {}

  Answer operator()() {
    if (broken) return Answer{"{\"inverse3\": ["};
    const double since = std::chrono::duration<double>(Clock::now() - begin_.load()).count();
    const double time = std::fmod(since, kStill + path_.end_time() / kFaster) - kStill;
    const scene::PathRow row = path_.at(std::max(0.0, kFaster * time));
    return Answer{nlohmann::json{{"inverse3", {devices::test::arm_json("04BA", row.position)}},
                                 {"verse_grip", {devices::test::grip_json("77", row.orientation, false)}}}
                      .dump()};
  }
  void begin() { begin_ = Clock::now(); }
  [[nodiscard]] bool over() const { return Clock::now() - begin_.load() > std::chrono::seconds(20); }

  std::atomic<bool> broken{false};

 private:
  static constexpr double kStill = 1.0;  // s; the force ramp takes 0.75 s
  static constexpr double kFaster = 5.0;
  scene::ToolPath path_;
  std::atomic<Clock::time_point> begin_{Clock::now()};
};

/// Runs until the hand has pressed, then calls `end` and checks the last command to the service. A machine
/// that halts for 5 ms makes samples stale, which is a fault. It is reset, and the next press is used.
int exit_code_after(const std::function<void(PressedArm&, Program&, const HaplyService&)>& end) {
  PressedArm arm;
  HaplyService service(*arm().text, [&](std::size_t command) {
    if (command == 0) arm.begin();
    return arm();
  });
  const Folder folder;
  Program program(folder.path(),
                  {"run", "--device", "haply:" + service.address(), "--headless", "--no-noise"});
  while (!(service.force().norm() > 0.1) && !program.ended() && !arm.over()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (takes_resets(program.id())) program.signal(SIGUSR1);
  }
  end(arm, program, service);
  const Outcome outcome = program.wait();
  EXPECT_EQ(service.force(), Vec3::Zero()) << outcome.err;
  EXPECT_FALSE(service.received().empty());
  while (!service.said_farewell() && !arm.over()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(service.said_farewell()) << outcome.err;
  return outcome.exit_code;
}

TEST(HaplyRun, EndedBySigtermLeavesTheServiceWithZeroForce) {
  const int code =
      exit_code_after([](PressedArm&, Program& program, const HaplyService&) { program.signal(SIGTERM); });
  EXPECT_TRUE(code == 0 || code == 3) << code;
}

TEST(HaplyRun, EndedByACrashLeavesTheServiceWithZeroForce) {
  PressedArm arm;
  HaplyService service(*arm().text, [&](std::size_t command) {
    if (command == 0) arm.begin();
    return arm();
  });
  const Folder folder;
  Program program(folder.path(),
                  {"run", "--device", "haply:" + service.address(), "--headless", "--no-noise"});
  while (!(service.force().norm() > 0.1) && !program.ended() && !arm.over()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (takes_resets(program.id())) program.signal(SIGUSR1);
  }
  program.signal(SIGSEGV);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, -1) << "it dies of the signal";
  EXPECT_EQ(service.force(), Vec3::Zero()) << outcome.err;
}

TEST(HaplyRun, EndedAfterAFaultLeavesTheServiceWithZeroForce) {
  const int code = exit_code_after([](PressedArm& arm, Program& program, const HaplyService& service) {
    arm.broken = true;
    while (service.force() != Vec3::Zero() && !arm.over()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    program.signal(SIGINT);
  });
  EXPECT_EQ(code, 3);
}

}  // namespace
}  // namespace palpate::tests
