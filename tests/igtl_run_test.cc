// A run whose hand is a client's OpenIGTLink messages, as of a tracker.
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "io/igtl/igtl_messages.h"
#include "io/igtl/igtl_socket.h"
#include "io/system/clock.h"
#include "net/test/igtl_received.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;
using net::test::Received;

/// The default press at four times its speed.
scene::ToolPath fast_press() { return scene::default_path(scene::load({}), 0).faster(4.0); }

/// A tracker of 50 Hz: the tool is at rest outside for 1.5 s, then presses, again and again. A second
/// TRANSFORM, of another name, is far away.
class PressingTracker final {
 public:
  explicit PressingTracker(int port)
      : client_(connected_to(port)), sending_([this] { send(); }), receiving_([this] { receive(); }) {}
  ~PressingTracker() {
    ending = true;
    sending_.join();
    receiving_.join();
  }
  PressingTracker(const PressingTracker&) = delete;
  PressingTracker& operator=(const PressingTracker&) = delete;

  using Force = std::array<double, 3>;
  /// All forces received so far.
  [[nodiscard]] std::vector<Force> forces() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return forces_;
  }
  /// Whether the newest `count` forces are as wanted.
  [[nodiscard]] bool newest_are(std::size_t count, const std::function<bool(double)>& wanted) {
    const std::vector<Force> all = forces();
    if (all.size() < count) return false;
    for (std::size_t i = all.size() - count; i < all.size(); ++i) {
      if (!wanted(std::hypot(all[i][0], all[i][1], all[i][2]))) return false;
    }
    return true;
  }

  std::atomic<bool> silent{false};
  std::atomic<bool> ending{false};

 private:
  static std::unique_ptr<net::test::Client> connected_to(int port) {
    for (int i = 0; i < 6000; ++i) {
      try {
        return std::make_unique<net::test::Client>(port);
      } catch (const std::runtime_error&) {
        std::this_thread::sleep_for(20ms);
      }
    }
    throw std::runtime_error("the program does not listen");
  }

  void send() {
    constexpr double kStill = 1.5;  // s
    const scene::ToolPath path = fast_press();
    for (double time = 0.0; !ending; time += 0.02) {
      const scene::PathRow row = path.at(std::fmod(time, kStill + path.end_time()) - kStill);
      net::IgtlMessages messages(unix_ns());
      messages.add_transform("Other", {Quat::Identity(), Vec3(0.0, 0.0, 1.0)});
      messages.add_transform("Hand", {row.orientation, row.position});
      if (!silent) client_->send(messages.bytes());
      std::this_thread::sleep_for(20ms);
    }
  }
  void receive() {
    while (!ending) {
      const std::optional<Received> received = client_->next();
      if (!received) return;
      if (received->type != "SENSOR" || received->name != "PalpateHandForce") continue;
      const std::vector<double> values = received->values();
      const std::lock_guard<std::mutex> lock(mutex_);
      forces_.push_back({values.at(0), values.at(1), values.at(2)});
    }
  }

  std::mutex mutex_;
  std::vector<Force> forces_;
  std::unique_ptr<net::test::Client> client_;
  std::thread sending_;
  std::thread receiving_;
};

/// Waits for 60 s at most. @return whether it came
bool wait_for(const std::function<bool()>& wanted) {
  for (int i = 0; i < 3000; ++i) {
    if (wanted()) return true;
    std::this_thread::sleep_for(20ms);
  }
  return false;
}

/// Waits until the client has pressed. A machine that halts for 0.1 s makes the stream stale, which is a
/// fault. It is reset, and the next press is used. palpate.exe cannot reset it. @return whether it pressed
bool await_force(const Program& program, PressingTracker& tracker) {
  bool stays = false;
  const bool came = wait_for([&] {
    if (takes_resets(program.id())) program.signal(SIGUSR1);
    stays = program.err_so_far().find("the force stays zero until the run ends") != std::string::npos;
    return stays || tracker.newest_are(10, [](double force) { return force > 0.1; });
  });
  return came && !stays;
}

bool await_zero_force(PressingTracker& tracker, std::size_t count) {
  return wait_for([&] { return tracker.newest_are(count, [](double force) { return force == 0.0; }); });
}

TEST(IgtlRun, AClientThatClosesIsAFaultAndTheNextOneReceivesZeroForceThroughAPress) {
  const Folder folder;
  const int port = net::port_of(net::listen_at({"127.0.0.1", 0}));
  Program program(folder.path(), {"run", "--device", "igtl:" + std::to_string(port) + "/Hand", "--headless"});
  {
    PressingTracker tracker(port);
    EXPECT_TRUE(await_force(program, tracker)) << program.err_so_far();
  }
  PressingTracker next(port);
  EXPECT_TRUE(await_zero_force(next, 400)) << "4 s, in which its tool presses";
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  // A client that closes before it has read all resets the connection.
  EXPECT_TRUE(outcome.err.find("the client closed the connection") != std::string::npos ||
              outcome.err.find("the connection broke: Connection reset by peer") != std::string::npos)
      << outcome.err;
}

TEST(IgtlRun, AClientMovesTheToolAndReceivesTheRecordedForceAndItsSilenceIsAFault) {
  const Folder folder;
  const int port = net::port_of(net::listen_at({"127.0.0.1", 0}));
  Program program(folder.path(), {"run", "--device", "igtl:" + std::to_string(port) + "/Hand", "--headless",
                                  "--no-noise", "--record", "run.h5"});
  Outcome outcome;
  std::vector<PressingTracker::Force> forces;
  {
    PressingTracker tracker(port);
    EXPECT_TRUE(await_force(program, tracker)) << program.err_so_far();
    net::test::Client second(port);
    EXPECT_FALSE(second.next()) << "refused";
    tracker.silent = true;
    EXPECT_TRUE(await_zero_force(tracker, 10));
    program.signal(SIGINT);
    outcome = program.wait();
    forces = tracker.forces();
  }
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("the run begins when a client sends poses"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("no TRANSFORM Hand came for"), std::string::npos) << outcome.err;

  const record::Recording recording = record::read_recording(folder / "run.h5");
  const scene::ToolPath path = fast_press();
  double lowest_path = path.at(0.0).position.z();
  for (const scene::PathRow& row : path.rows()) lowest_path = std::min(lowest_path, row.position.z());
  double lowest = 1.0;
  std::set<PressingTracker::Force> recorded{{0.0, 0.0, 0.0}};
  for (const haptics::TickRow& row : recording.rows) {
    recorded.insert(row.force);
    lowest = std::min(lowest, row.device[2]);
    ASSERT_NEAR(row.device[0], path.at(0.0).position.x(), 1e-6) << "the default press is along z";
    ASSERT_LT(row.device[2], path.at(0.0).position.z() + 1e-6) << "never where the other TRANSFORM is";
  }
  EXPECT_GE(lowest, lowest_path - 1e-6);
  EXPECT_LT(lowest, path.at(0.0).position.z() - 10e-3);
  for (const PressingTracker::Force& force : forces) {
    EXPECT_TRUE(recorded.count(force) == 1) << force[0] << ' ' << force[1] << ' ' << force[2];
  }
  const Outcome replayed = run(folder, {"replay", "run.h5", "--verify"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
}

}  // namespace
}  // namespace palpate::tests
