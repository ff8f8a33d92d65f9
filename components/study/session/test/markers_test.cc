#include "study/session/markers.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "io/system/clock.h"
#include "io/system/output_file.h"
#include "io/system/temporary.h"

#include "study/session/folder.h"
#include "study/session/run_session.h"
#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// Takes bytes from a descriptor on a thread, each with its time.
class Receiver {
 public:
  struct Byte {
    char byte;
    std::int64_t unix_ns;
  };

  explicit Receiver(int descriptor) : descriptor_(descriptor), thread_([this] { run(); }) {}
  virtual ~Receiver() {
    over_ = true;
    thread_.join();
    ::close(descriptor_);
  }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;
  [[nodiscard]] std::vector<Byte> bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
  }

 private:
  void run() {
    while (!over_) {
      pollfd ready{descriptor_, POLLIN, 0};
      if (::poll(&ready, 1, 20) <= 0) continue;
      std::array<char, 4096> read{};
      const ssize_t count = ::read(descriptor_, read.data(), read.size());
      const std::int64_t now = unix_ns();
      if (count <= 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      const std::lock_guard lock(mutex_);
      for (ssize_t i = 0; i < count; ++i) bytes_.push_back({read[static_cast<std::size_t>(i)], now});
    }
  }

  int descriptor_;
  mutable std::mutex mutex_;
  std::vector<Byte> bytes_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

/// A stand-in for a serial port: a pseudo terminal.
struct SerialStandIn {
  int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  std::string slave;
  SerialStandIn() {
    EXPECT_EQ(::grantpt(master), 0);
    EXPECT_EQ(::unlockpt(master), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(::ptsname_r(master, name.data(), name.size()), 0);
    slave = name.data();
  }
};

/// A TCP server at a free port of this machine.
struct TcpStandIn {
  int listener = ::socket(AF_INET, SOCK_STREAM, 0);
  int port = 0;
  TcpStandIn() {
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&where), sizeof where), 0);
    EXPECT_EQ(::listen(listener, 4), 0);
    socklen_t size = sizeof where;
    EXPECT_EQ(::getsockname(listener, reinterpret_cast<sockaddr*>(&where), &size), 0);
    port = ntohs(where.sin_port);
  }
  ~TcpStandIn() { ::close(listener); }
  TcpStandIn(const TcpStandIn&) = delete;
  TcpStandIn& operator=(const TcpStandIn&) = delete;
  [[nodiscard]] std::string target() const { return "tcp:127.0.0.1:" + std::to_string(port); }
};

/// Screens that only take time, as a display does. The experimenter goes on without markers.
class SlowScreens final : public SessionScreens {
 public:
  void show(const ScreenContent& /*content*/) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(16));
  }
  std::optional<ScreenInput> take_input() override {
    return std::exchange(pressed_, !pressed_) ? std::nullopt : std::optional(ScreenInput::kNext);
  }
  std::string take_note() override { return {}; }
  std::optional<std::size_t> ask(const Question& question) override {
    if (question.text.starts_with("Markers failed")) return failures.push_back(question.text), 1;
    return 0;
  }
  std::optional<bool> audible_trial(const AudibleTrial& /*trial*/,
                                    const std::function<void(bool)>& /*noise*/) override {
    return std::nullopt;
  }
  std::vector<std::string> failures;

 private:
  bool pressed_ = false;
};

class MarkedSession : public testing::Test {
 protected:
  explicit MarkedSession() {
    const std::filesystem::path file = scratch_.path() / "s.toml";
    write_output(file,
                 "[study]\nname = \"s\"\nscene = \"box\"\n[breaks]\nevery_trials = 2\nleast_s = 0\n"
                 "[markers]\nto = [\"serial:/dev/nowhere\"]\n[[task]]\nname = \"weak\"\n"
                 "kind = \"force-detection\"\nforce_mN = { from = 5, to = 500 }\ninterval_s = 0.3\n"
                 "gap_s = 0.2\ntrials = 4\n");
    prepare_study(file, scratch_.path() / "study", 1);
    study_ = open_study(scratch_.path() / "study");
    mark_simulated(study_);
  }
  SessionOutcome run(std::optional<std::vector<std::string>> markers) {
    SessionOptions options;
    options.participant = study_.ids[0];
    options.observer = "ideal";
    options.screens = &screens_;
    options.markers = std::move(markers);
    return run_session(study_, study_.key, options);
  }
  [[nodiscard]] std::vector<EventRecord> events(const std::string& name) const {
    std::vector<EventRecord> found;
    for (const EventRecord& event : study_.read(study_.ids[0]).events) {
      if (event.event == name) found.push_back(event);
    }
    return found;
  }

  ScratchFolder scratch_{"palpate-markers"};
  StudyFolder study_;
  SlowScreens screens_;
};

std::vector<std::pair<nlohmann::json, std::int64_t>> lines_of(const std::vector<Receiver::Byte>& bytes) {
  std::vector<std::pair<nlohmann::json, std::int64_t>> lines;
  std::string line;
  for (const Receiver::Byte& byte : bytes) {
    line += byte.byte;
    if (byte.byte == '\n') lines.emplace_back(nlohmann::json::parse(std::exchange(line, {})), byte.unix_ns);
  }
  return lines;
}

/// Prints the median and the largest time from the tick to the arrival [ms].
double median_of(std::vector<double> late, const char* what) {
  std::sort(late.begin(), late.end());
  std::printf("%s: %zu markers, arrival after the tick: median %.3f ms, 95 %% %.3f ms, largest %.3f ms\n",
              what, late.size(), late[late.size() / 2], late[late.size() * 95 / 100], late.back());
  return late[late.size() / 2];
}

TEST_F(MarkedSession, SendsEachIntervalAndAnswerAtTheTimeOfItsTick) {
  const SerialStandIn serial;
  const TcpStandIn server;
  Receiver bytes(serial.master);
  const SessionOutcome outcome = run({{"serial:" + serial.slave + "@9600", server.target()}});
  EXPECT_TRUE(outcome.complete);
  EXPECT_EQ(outcome.markers_failure, "");
  Receiver lines(::accept(server.listener, nullptr, nullptr));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto messages = lines_of(lines.bytes());
  const auto pulses = bytes.bytes();
  ASSERT_EQ(messages.size(), pulses.size());
  std::vector<double> late;
  std::size_t next = 0;
  for (const TrialRecord& trial : study_.read(study_.ids[0]).trials) {
    std::vector<std::uint64_t> ticks;
    for (const IntervalCues& cues : trial.intervals) {
      if (cues.from_tick > 0) ticks.push_back(cues.from_tick);
    }
    if (ticks.empty()) continue;  // the force was not reached
    if (trial.answer != 0) {
      ticks.push_back(trial.intervals[1].to_tick +
                      static_cast<std::uint64_t>(std::llround(1000.0 * trial.response_time)));
    }
    for (std::size_t i = 0; i < ticks.size(); ++i, ++next) {
      ASSERT_LT(next, messages.size());
      const auto& [line, arrival] = messages[next];
      const std::size_t code = i < 2 ? i + 1 : 2 + static_cast<std::size_t>(trial.answer);
      EXPECT_EQ(line["marker"], code);
      EXPECT_EQ(pulses[next].byte, static_cast<char>(code));
      EXPECT_EQ(line["tick"], ticks[i]) << line;
      EXPECT_EQ(line["block"], trial.block);
      EXPECT_EQ(line["trial"], trial.number);
      late.push_back(1e-6 * static_cast<double>(pulses[next].unix_ns - line["unix_ns"].get<std::int64_t>()));
    }
    if (trial.answer == 0) ++next;  // "no answer"
  }
  EXPECT_EQ(next, messages.size());
  EXPECT_GE(late.size(), 12U);
  EXPECT_LT(median_of(late, "serial stand-in"), 5.0);
  EXPECT_GT(*std::min_element(late.begin(), late.end()), -0.01) << "before its tick";
  std::size_t sent = 0;
  for (const EventRecord& block : events("block")) sent += std::stoul(block.value("markers"));
  EXPECT_EQ(sent, messages.size());
  EXPECT_THAT(events("session")[0].value("markers"), HasSubstr(server.target()));
}

TEST(Markers, AMarkerWhoseTickIsDelayedWhileItWaitsLeavesAtItsNewTime) {
  const TcpStandIn server;
  std::int64_t due = 0;
  {
    Markers markers({parse_marker_target(server.target(), "")});
    markers.begin_block(1000.0);
    const std::int64_t began = monotonic_ns();
    markers.note_tick(0, began);
    markers.send({MarkerCode::kFirstInterval, 30, 1, 1, "weak", 1, false});
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    due = began + 130'000'000;
    markers.note_tick(10, due - 20'000'000);  // 100 ms late
    EXPECT_EQ(markers.finish_block().sent, 1U);
    EXPECT_GE(monotonic_ns(), due);
  }
  Receiver lines(::accept(server.listener, nullptr, nullptr));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto messages = lines_of(lines.bytes());
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NEAR(messages[0].first["unix_ns"].get<double>(), static_cast<double>(wall_time_of(due)), 1e6);
}

TEST_F(MarkedSession, AServerThatGoesAwayIsLoggedAndTheExperimenterIsAsked) {
  const TcpStandIn server;
  std::thread away([&] {
    const int client = ::accept(server.listener, nullptr, nullptr);
    std::array<char, 400> some{};
    for (std::size_t got = 0; got < some.size();) {
      got += static_cast<std::size_t>(::read(client, some.data(), some.size() - got));
    }
    ::close(client);
  });
  const SessionOutcome outcome = run({{server.target()}});
  away.join();
  EXPECT_TRUE(outcome.complete);
  EXPECT_THAT(outcome.markers_failure,
              AllOf(HasSubstr(server.target() + ": "), HasSubstr("without markers")));
  ASSERT_EQ(screens_.failures.size(), 1U);
  const std::vector<EventRecord> noted = events("markers");
  ASSERT_EQ(noted.size(), 2U);
  EXPECT_EQ(noted[0].value("state"), "failed");
  EXPECT_EQ(noted[0].value("block"), "1");
  EXPECT_EQ(noted[1].value("state"), "off");
}

TEST_F(MarkedSession, APortThatIsMissingIsRefusedBeforeTheSession) {
  EXPECT_EQ(error_of([&] { run(std::nullopt); }),
            "markers serial:/dev/nowhere: cannot be opened: No such file or directory");
  std::string closed;
  {
    const TcpStandIn server;
    closed = server.target();
  }
  EXPECT_EQ(error_of([&] { run({{closed}}); }),
            "markers " + closed + ": cannot be connected: Connection refused");
  const std::string file = (scratch_.path() / "s.toml").string();
  const auto size = std::filesystem::file_size(file);
  EXPECT_EQ(error_of([&] { run({{"serial:" + file}}); }), "markers serial:" + file + ": is no serial port");
  EXPECT_EQ(std::filesystem::file_size(file), size);
  EXPECT_TRUE(events("session").empty());
}

TEST(Markers, TargetsAreReadAndOthersRefused) {
  EXPECT_EQ(parse_marker_target("serial:/dev/ttyUSB0", "").number, 115200);
  EXPECT_EQ(parse_marker_target("serial:/dev/a:b@9600", "").name, "/dev/a:b");
  EXPECT_EQ(parse_marker_target("tcp:localhost:5678", "").number, 5678);
  for (const char* wrong : {"", "tcp:", "tcp:host", "tcp::5", "tcp:host:0", "tcp:host:70000",
                            "serial:", "serial:/dev/a@1", "udp:host:5", "tcp:host:5.5"}) {
    EXPECT_THAT(error_of([&] { static_cast<void>(parse_marker_target(wrong, "--markers")); }),
                AllOf(StartsWith("--markers "), HasSubstr("must be serial:PATH")))
        << wrong;
  }
  EXPECT_THAT(error_of([] {
                static_cast<void>(parse_study(
                    replaced(kStudyText, "[safety]", "[markers]\nto = [\"x\"]\n[safety]"), "s.toml"));
              }),
              StartsWith("s.toml: markers.to x: must be serial:PATH"));
}

}  // namespace
}  // namespace palpate::study
