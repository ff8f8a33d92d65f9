#include "net/live_server.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <sched.h>

#include "io/websocket/test/live_client.h"

namespace palpate::net {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kToken = "a token for this test";

/// A service whose run has a new tick whenever the server reads it.
class Host final : public RunService {
 public:
  std::optional<nlohmann::ordered_json> answer(const LiveCommand& command, const ClientRef& client) override {
    if (std::holds_alternative<Start>(command)) {
      late_ = client;
      return std::nullopt;
    }
    if (std::holds_alternative<Stop>(command)) throw std::runtime_error("out of paper");
    if (std::holds_alternative<ResetFaults>(command)) throw LiveError("state", "nothing is running");
    return nlohmann::ordered_json{{"done", command.index()}};
  }
  nlohmann::ordered_json about_run() override { return {{"number", 1}}; }
  LiveState newest() override {
    ++tick_.tick;
    tick_.hands = 4;
    for (auto& row : tick_.rows) row.tick = tick_.tick;
    return {1, {}, &tick_};
  }
  std::vector<Event> poll(std::size_t clients) override {
    policy_ = sched_getscheduler(0);
    if (clients_.exchange(clients) == 0 && clients > 0) ++arrivals_;
    std::vector<Event> events;
    if (late_) events.push_back({std::exchange(late_, std::nullopt), "", {{"late", true}}});
    if (alarm_.exchange(false)) events.push_back({std::nullopt, "fault", {{"fault", 1}}});
    return events;
  }
  [[nodiscard]] std::size_t clients() const { return clients_; }
  [[nodiscard]] std::size_t arrivals() const { return arrivals_; }
  void alarm() { alarm_ = true; }
  /// Scheduling policy of the server's thread.
  [[nodiscard]] int policy() const { return policy_; }

 private:
  LiveTick tick_;
  std::optional<ClientRef> late_;
  std::atomic<std::size_t> clients_{0};
  std::atomic<std::size_t> arrivals_{0};  // changes from no client to some
  std::atomic<bool> alarm_{false};
  std::atomic<int> policy_{-1};
};

class Served : public testing::Test {
 protected:
  ~Served() override { end(); }
  void serve(const LiveOptions& options = {}) {
    server_ = std::make_unique<LiveServer>(options, host_);
    thread_ = std::thread([this] { server_->run(stop_); });
  }
  const LiveStatistics& end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    return server_->statistics();
  }
  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  /// Waits up to a minute until `count` clients have sent "hello". @return whether they have
  [[nodiscard]] bool clients_become(std::size_t count) const {
    for (int i = 0; i < 6000 && host_.clients() != count; ++i) std::this_thread::sleep_for(10ms);
    return host_.clients() == count;
  }

  Host host_;
  std::unique_ptr<LiveServer> server_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST_F(Served, AClientThatSaysHelloIsSentVersionAndLimits) {
  serve();
  test::LiveClient client(port());
  ASSERT_TRUE(client.open());
  const json hello = client.greet();
  EXPECT_EQ(hello["answer"], "hello");
  EXPECT_EQ(hello["palpate"], "1");
  EXPECT_THAT(hello["program"].get<std::string>(), HasSubstr("palpate "));
  EXPECT_EQ(hello["limits"]["message_bytes"], 16384);
  EXPECT_EQ(client.ask(R"({"do": "version", "id": "v"})")["id"], "v");
  EXPECT_EQ(client.ask(R"({"do": "state"})")["run"]["number"], 1);
  EXPECT_EQ(client.greet()["error"]["code"], "hello") << "once is enough";
}

TEST_F(Served, ItsThreadNeverInterruptsTheHapticLoop) {
  serve();
  test::LiveClient client(port());
  EXPECT_EQ(client.greet()["answer"], "hello");
  EXPECT_EQ(host_.policy(), SCHED_BATCH);
}

TEST_F(Served, NothingIsDoneBeforeHello) {
  serve();
  test::LiveClient client(port());
  EXPECT_EQ(client.ask(R"({"do": "scene"})")["error"]["code"], "hello");
  EXPECT_EQ(client.greet()["answer"], "hello") << "the connection goes on";
}

TEST_F(Served, AClientThatNeverSaysHelloIsLetGo) {
  serve();
  test::LiveClient client(port());
  EXPECT_EQ(client.hear().value_or(json())["error"]["code"], "hello") << "after five seconds";
  EXPECT_FALSE(client.hear());
  EXPECT_EQ(client.close_code(), 1008);
}

TEST_F(Served, AnotherVersionIsReportedAndLetGo) {
  serve();
  test::LiveClient client(port());
  EXPECT_EQ(client.ask(R"({"palpate": "9", "do": "hello"})")["error"]["code"], "version");
  EXPECT_FALSE(client.hear());
  EXPECT_EQ(client.close_code(), 1008);
}

TEST_F(Served, TheTokenIsAskedForAndAWrongOneEndsTheConnection) {
  LiveOptions options;
  options.token = kToken;
  serve(options);
  test::LiveClient right(port());
  EXPECT_EQ(right.greet(kToken)["answer"], "hello");
  test::LiveClient wrong(port());
  EXPECT_EQ(wrong.greet("a token for that test")["error"]["code"], "token");
  EXPECT_FALSE(wrong.hear());
  EXPECT_EQ(wrong.close_code(), 1008);
  test::LiveClient none(port());
  EXPECT_EQ(none.ask(R"({"palpate": "1", "do": "hello"})")["error"]["code"], "token");
  EXPECT_EQ(right.ask(R"({"do": "version"})")["answer"], "version");
  EXPECT_EQ(end().refused, 2U);
}

TEST_F(Served, APageOfAForeignOriginIsRefusedAndItsOwnAndAllowedOnesAreNot) {
  LiveOptions options;
  options.origins = {"http://lab.example:8000"};
  serve(options);
  const std::string own = "http://127.0.0.1:" + std::to_string(port());
  EXPECT_EQ(test::LiveClient(port(), {"http://evil.example"}).status(), 403U);
  EXPECT_EQ(test::LiveClient(port(), {"null"}).status(), 403U);
  EXPECT_EQ(test::LiveClient(port(), {own}).status(), 101U);
  EXPECT_EQ(test::LiveClient(port(), {"http://lab.example:8000"}).status(), 101U);
  EXPECT_EQ(test::LiveClient(port()).status(), 101U) << "a program says no origin";
  EXPECT_EQ(end().refused, 2U);
}

TEST_F(Served, OnlyThePathOfTheInterfaceIsThere) {
  serve();
  EXPECT_EQ(test::LiveClient(port(), {"", "/?token=abc"}).status(), 404U) << "no token stands in an address";
  EXPECT_EQ(test::LiveClient(port(), {"", "/other"}).status(), 404U);
}

TEST_F(Served, ABrowserGetsTheFilesOfThePageAndNothingElse) {
  LiveOptions options;
  options.page = {{"/", {"text/html", "<title>a page</title>"}}, {"/a/b.wasm", {"application/wasm", "code"}}};
  serve(options);
  const auto got = [&](const std::string& target) { return test::http_get(port(), target); };
  EXPECT_EQ(got("/").body, "<title>a page</title>");
  EXPECT_EQ(got("/a/b.wasm").body, "code");
  EXPECT_EQ(got("/a/b.wasm").fields["Content-Type"], "application/wasm");
  EXPECT_THAT(got("/").fields["Content-Security-Policy"], HasSubstr("frame-ancestors 'none'"));
  for (const char* other : {"/a", "/a/", "/a/../a/b.wasm", "/../etc/passwd", "//a/b.wasm", "/a/b.wasm?x"}) {
    EXPECT_EQ(got(other).status, 404U) << other;
  }
}

TEST_F(Served, ThereIsAnEndOfClientsAndRoomAgainWhenOneGoes) {
  serve();
  std::vector<std::unique_ptr<test::LiveClient>> clients;
  for (std::size_t i = 0; i < LiveServer::kMaxClients; ++i) {
    clients.push_back(std::make_unique<test::LiveClient>(port()));
    EXPECT_EQ(clients.back()->greet()["answer"], "hello");
  }
  EXPECT_EQ(test::LiveClient(port()).status(), 503U);
  clients.pop_back();
  EXPECT_TRUE(clients_become(LiveServer::kMaxClients - 1));
  EXPECT_EQ(test::LiveClient(port()).status(), 101U);
}

TEST_F(Served, PlacesAreCountedAfterTheHelloSoThatStrangersTakeNone) {
  LiveOptions options;
  options.token = kToken;
  serve(options);
  std::vector<std::unique_ptr<test::LiveClient>> strangers;
  std::vector<std::unique_ptr<test::LiveClient>> clients;
  for (std::size_t i = 0; i < LiveServer::kMaxClients; ++i) {
    for (int more = 0; more < 3; ++more) strangers.push_back(std::make_unique<test::LiveClient>(port()));
    clients.push_back(std::make_unique<test::LiveClient>(port()));
    EXPECT_EQ(clients.back()->status(), 101U);
    EXPECT_EQ(clients.back()->greet(kToken)["answer"], "hello") << i;
  }
  EXPECT_TRUE(clients_become(LiveServer::kMaxClients));
}

TEST_F(Served, AHelloForWhichThereIsNoPlaceIsReportedSo) {
  serve();
  std::vector<std::unique_ptr<test::LiveClient>> clients;
  for (std::size_t i = 0; i + 1 < LiveServer::kMaxClients; ++i) {
    clients.push_back(std::make_unique<test::LiveClient>(port()));
    clients.back()->greet();
  }
  test::LiveClient early(port());
  test::LiveClient last(port());
  EXPECT_EQ(last.greet()["answer"], "hello");
  EXPECT_EQ(early.greet()["error"]["code"], "full");
  EXPECT_FALSE(early.hear());
  EXPECT_EQ(early.close_code(), 1013);
}

TEST_F(Served, OfTooManyStrangersOfOneAddressTheOldestIsDroppedAndLogged) {
  LiveOptions options;
  options.token = kToken;
  std::vector<std::string> lines;  // of the server's thread
  options.log = [&lines](const std::string& line) { lines.push_back(line); };
  serve(options);
  test::LiveClient client(port());
  client.greet(kToken);
  test::LiveClient oldest(port());
  std::vector<std::unique_ptr<test::LiveClient>> others;
  for (std::size_t i = 0; i < LiveServer::kMaxPendingPerAddress; ++i) {
    others.push_back(std::make_unique<test::LiveClient>(port()));
  }
  EXPECT_FALSE(oldest.hear());
  EXPECT_EQ(oldest.close_code(), 0) << "without a word";
  EXPECT_EQ(client.ask(R"({"do": "version"})")["answer"], "version") << "who has said hello stays";
  EXPECT_EQ(others.front()->greet(kToken)["answer"], "hello");
  EXPECT_GE(end().refused, 1U);
  ASSERT_FALSE(lines.empty());
  EXPECT_EQ(lines.front(), "refused 127.0.0.1: it had not said hello, and others came");
}

TEST_F(Served, RefusalsAreLoggedAndAFloodOfThemIsCounted) {
  LiveOptions options;
  options.token = kToken;
  std::vector<std::string> lines;  // of the server's thread
  options.log = [&lines](const std::string& line) { lines.push_back(line); };
  serve(options);
  for (int i = 0; i < 60; ++i) test::LiveClient(port()).greet("a token for that test");
  EXPECT_EQ(end().refused, 60U);
  ASSERT_FALSE(lines.empty());
  EXPECT_EQ(lines.front(), "refused 127.0.0.1: token: is not this server's");
  EXPECT_LT(lines.size(), 40U);
}

TEST_F(Served, EmptyFragmentsWithoutEndCloseTheirConnection) {
  serve();
  test::LiveClient other(port());
  other.greet();
  test::LiveClient client(port());
  client.greet();
  const std::string text_begins("\x01\x80mask", 6);
  std::string goes_on;
  for (int i = 0; i < 1000; ++i) goes_on += std::string("\x00\x80mask", 6);
  bool open = client.say_raw(text_begins);
  const auto until = std::chrono::steady_clock::now() + 30s;
  while (open && std::chrono::steady_clock::now() < until) open = client.say_raw(goes_on);
  EXPECT_FALSE(open);
  EXPECT_EQ(other.ask(R"({"do": "version"})")["answer"], "version");
  EXPECT_EQ(end().refused, 1U);
}

TEST_F(Served, AMessageInManyFragmentsIsTakenAlsoAfterManyPings) {
  serve();
  test::LiveClient client(port());
  client.greet();
  const std::string none(4, '\0');  // a WebSocket mask of zeros, which changes nothing
  const std::string command = R"({"do": "version"})";
  for (int message = 0; message < 3; ++message) {
    std::string frames;
    for (int i = 0; i < 20; ++i) frames += "\x89\xfd" + none + std::string(125, 'p');
    for (std::size_t i = 0; i < command.size(); ++i) {
      const char head = static_cast<char>((i == 0 ? 1 : 0) + (i + 1 == command.size() ? 0x80 : 0));
      frames += std::string(1, head) + "\x81" + none + command[i];
    }
    EXPECT_TRUE(client.say_raw(frames));
    EXPECT_EQ(client.hear_until([](const json& heard) { return heard.contains("answer"); })["answer"],
              "version");
  }
}

TEST_F(Served, AStreamComesAtTheChosenRateAndEndsWhenAsked) {
  serve();
  test::LiveClient client(port());
  client.greet();
  EXPECT_EQ(client.ask(R"({"do": "stream", "rate_Hz": 50})")["rate_Hz"], 50);
  const auto begun = std::chrono::steady_clock::now();
  std::uint64_t last = 0;
  std::uint64_t left_out = 0;
  constexpr int kFrames = 100;
  for (int i = 0; i < kFrames; ++i) {
    const json frame = client.hear().value_or(json());
    ASSERT_TRUE(frame.contains("state")) << frame;
    ASSERT_GT(frame["state"]["tick"].get<std::uint64_t>(), last);
    last = frame["state"]["tick"];
    left_out = frame["left_out"];
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
  // A busy machine may leave frames out, and counts them. No frame comes before it is due.
  EXPECT_GE(taken.count(), (kFrames - 2) / 50.0 * 0.95);
  EXPECT_LE(taken.count(), (kFrames + static_cast<double>(left_out)) / 50.0 + 10.0);
  EXPECT_EQ(client.ask(R"({"do": "stream", "rate_Hz": 0})")["rate_Hz"], 0);
  client.say(R"({"do": "version"})");
  EXPECT_EQ(client.hear().value_or(json())["answer"], "version") << "no frame comes any more";
}

TEST_F(Served, MalformedMessagesAreAnsweredAndSurvived) {
  serve();
  test::LiveClient client(port());
  client.greet();
  EXPECT_EQ(client.ask("{")["error"]["code"], "json");
  EXPECT_EQ(client.ask(std::string(9000, '['))["error"]["code"], "json");
  EXPECT_EQ(client.ask(R"({"do": "fly", "id": 3})")["error"]["code"], "command");
  const json field = client.ask(R"({"do": "stream", "id": 4, "rate_Hz": "much"})");
  EXPECT_EQ(field["error"]["code"], "field");
  EXPECT_EQ(field["id"], 4);
  EXPECT_EQ(client.ask(R"({"do": "reset_faults"})")["error"]["code"], "state");
  EXPECT_EQ(client.ask(R"({"do": "stop"})")["error"]["words"], "out of paper") << "whatever a host throws";
  client.say("\x01\x02", true);
  const json binary = client.hear().value_or(json());
  EXPECT_EQ(binary["error"]["code"], "json");
  EXPECT_THAT(binary["error"]["words"].get<std::string>(), HasSubstr("binary"));
  EXPECT_EQ(client.ask(R"({"do": "version"})")["answer"], "version");
  EXPECT_EQ(end().errors, 7U);
}

TEST_F(Served, ATooLargeMessageEndsItsConnectionAndNoOther) {
  serve();
  test::LiveClient other(port());
  other.greet();
  test::LiveClient client(port());
  client.greet();
  const std::string command = R"({"do": "version"})";
  EXPECT_EQ(client.ask(command + std::string(kLargestRequest - command.size(), ' '))["answer"], "version");
  client.say(command + std::string(kLargestRequest - command.size() + 1, ' '));
  EXPECT_FALSE(client.hear());
  EXPECT_EQ(client.close_code(), 1009);
  EXPECT_EQ(other.ask(command)["answer"], "version");
}

TEST_F(Served, TooManyMessagesAreReportedAndThenEndTheConnection) {
  serve();
  test::LiveClient client(port());
  client.greet();
  for (int i = 0; i < 2000 && client.open(); ++i) client.say(R"({"do": "version"})");
  int answers = 0;
  int refused = 0;
  while (const auto message = client.hear()) {
    ++(message->contains("error") ? refused : answers);
    if (message->contains("error")) {
      EXPECT_EQ((*message)["error"]["code"], "rate");
    }
  }
  EXPECT_GE(answers, 1);
  EXPECT_LT(answers, 1900);
  test::LiveClient next(port());
  EXPECT_EQ(next.greet()["answer"], "hello");
}

TEST_F(Served, ASlowClientLosesFramesThatAreCountedAndTheOthersDoNot) {
  serve();
  test::LiveClient slow(port(), {"", "/", 4096});
  slow.greet();
  test::LiveClient quick(port());
  quick.greet();
  slow.say(R"({"do": "stream", "rate_Hz": 1000})");
  quick.ask(R"({"do": "stream", "rate_Hz": 20})");
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(quick.hear()) << "two seconds in which the slow one reads nothing";
  quick.ask(R"({"do": "stream", "rate_Hz": 0})");
  const json frame = slow.hear_until([](const json& message) {
    return message.contains("state") && message["left_out"].get<std::uint64_t>() > 100;
  });
  EXPECT_FALSE(frame.is_null());
  slow.vanish();
  EXPECT_TRUE(clients_become(1));
  EXPECT_GT(end().left_out, 100U);
}

TEST_F(Served, AClientThatVanishesIsForgotten) {
  serve();
  test::LiveClient stays(port());
  stays.greet();
  test::LiveClient goes(port());
  goes.greet();
  goes.ask(R"({"do": "stream", "rate_Hz": 1000})");
  EXPECT_TRUE(clients_become(2));
  goes.vanish();
  EXPECT_TRUE(clients_become(1));
  EXPECT_EQ(stays.ask(R"({"do": "version"})")["answer"], "version");
}

TEST_F(Served, AClientThatComesAndGoesAtOnceIsSeenByTheHost) {
  serve();
  for (std::size_t i = 1; i <= 20; ++i) {
    test::LiveClient client(port());
    client.greet();
    client.vanish();
    for (int wait = 0; wait < 6000 && host_.arrivals() < i; ++wait) std::this_thread::sleep_for(10ms);
    ASSERT_EQ(host_.arrivals(), i);
    ASSERT_TRUE(clients_become(0));
  }
}

TEST_F(Served, ALateAnswerReachesItsAskerAndAnEventReachesAll) {
  serve();
  test::LiveClient one(port());
  one.greet();
  test::LiveClient two(port());
  two.greet();
  test::LiveClient stranger(port());
  EXPECT_TRUE(clients_become(2));
  const json late = one.ask(R"({"do": "start", "id": 11})");
  EXPECT_EQ(late["late"], true);
  EXPECT_EQ(late["id"], 11);
  host_.alarm();
  EXPECT_EQ(one.hear().value_or(json())["event"], "fault");
  EXPECT_EQ(two.hear().value_or(json())["event"], "fault") << "and no answer of another's";
  EXPECT_EQ(stranger.greet()["answer"], "hello") << "events go only to clients that have said hello";
}

TEST_F(Served, AtTheEndClientsAreInformedAndTheServerDoesNotWaitForThem) {
  serve();
  test::LiveClient polite(port());
  polite.greet();
  test::LiveClient silent(port());
  silent.greet();
  const auto begun = std::chrono::steady_clock::now();
  stop_ = true;
  EXPECT_FALSE(polite.hear());
  EXPECT_EQ(polite.close_code(), 1001);
  end();
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 20s);
}

TEST(LiveServer, BeyondThisMachineItDoesNotStartWithoutAToken) {
  Host host;
  LiveOptions options;
  options.address = "0.0.0.0";
  EXPECT_THAT([&] { const LiveServer server(options, host); },
              ThrowsMessage<InputError>(HasSubstr("--token-file")));
  options.token = kToken;
  EXPECT_NO_THROW(LiveServer(options, host));
}

TEST(LiveServer, AnAddressOrPortThatCannotBeHadIsRefusedInWords) {
  Host host;
  LiveOptions options;
  options.address = "my.machine";
  EXPECT_THAT([&] { const LiveServer server(options, host); },
              ThrowsMessage<InputError>(HasSubstr("--listen my.machine: must be an address")));
  options.address = "localhost";
  const LiveServer first(options, host);
  EXPECT_EQ(first.host(), "127.0.0.1");
  options.port = first.port();
  EXPECT_THAT([&] { const LiveServer server(options, host); },
              ThrowsMessage<InputError>(HasSubstr("cannot be listened at")));
  options.origins = {"*"};
  EXPECT_THAT([&] { const LiveServer server(options, host); },
              ThrowsMessage<InputError>(HasSubstr("--allow-origin *")));
}

}  // namespace
}  // namespace palpate::net
