#include "net/live_server.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>  // before Asio: Asio 1.74 does not include it

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/core.h>

#include "io/system/clock.h"
#include "io/websocket/connection.h"
#include "net/live_access.h"
#include "palpate/version.h"
#include "run/realtime/realtime.h"

namespace palpate::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using websocket::CloseCode;
using websocket::Connection;
using websocket::RateLimit;
using websocket::Request;
using websocket::Response;
using Json = nlohmann::ordered_json;

constexpr std::int64_t kHelloLimit = 5'000'000'000;  // ns from the connection to "hello"
constexpr std::int64_t kCloseLimit = 2'000'000'000;  // ns for a client to close its side
constexpr double kLogLines = 0.1;  // lines per second on average; kLogLinesAtOnce lines may come at once
constexpr double kLogLinesAtOnce = 20.0;
constexpr int kBacklog = 64;  // connections that wait in the system until they are accepted
constexpr std::int64_t kShutdownTime = 500'000'000;  // ns for clients to receive the last messages

/// Writes an address as in a URL, where brackets enclose an IPv6 address.
std::string in_url(const asio::ip::address& address) {
  return address.is_v6() ? "[" + address.to_string() + "]" : address.to_string();
}

asio::ip::address address_of(const LiveOptions& options) {
  error_code error;
  const auto address =
      asio::ip::make_address(options.address == "localhost" ? "127.0.0.1" : options.address, error);
  if (error) {
    throw InputError(
        "--listen " + options.address +
        ": must be an address of this machine as a number, such as 127.0.0.1, ::1 or 0.0.0.0 (all)");
  }
  if (!address.is_loopback() && options.token.empty()) {
    throw InputError("--listen " + options.address +
                     ": beyond this machine clients must show a token: --token-file FILE, or --new-token");
  }
  return address;
}

constexpr unsigned kOk = 200;
constexpr unsigned kForbidden = 403;
constexpr unsigned kNotFound = 404;
constexpr unsigned kUpgradeRequired = 426;
constexpr unsigned kUnavailable = 503;

Response plain_answer(unsigned status, const std::string& text) {
  return {status, {{"Content-Type", "text/plain; charset=utf-8"}}, text + "\n"};
}

/// Answers with a file of the page. The headers allow the page to use its own server alone, and forbid frames
/// around it.
Response page_answer(const PageFile& file) {
  return {kOk,
          {{"Content-Type", file.type},
           {"Content-Security-Policy",
            "default-src 'none'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; worker-src 'self'; "
            "style-src 'self' 'unsafe-inline'; img-src 'self' data:; connect-src 'self' ws:; "
            "frame-ancestors 'none'"},
           {"X-Content-Type-Options", "nosniff"},
           {"Cache-Control", "no-store"}},
          file.bytes};
}

}  // namespace

class LiveServer::Server final : public websocket::ConnectionHandler {
 public:
  Server(const LiveOptions& options, RunService& service) : options_(options), service_(service) {
    for (const std::string& origin : options.origins) check_origin(origin);
    const tcp::endpoint wanted(address_of(options), options.port);
    error_code error;
    acceptor_.open(wanted.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(wanted, error);
    if (!error) acceptor_.listen(kBacklog, error);
    if (error) {
      throw InputError(fmt::format("--listen {} --port {}: cannot be listened at: {}", options.address,
                                   options.port, error.message()));
    }
    endpoint_ = acceptor_.local_endpoint();
  }

  [[nodiscard]] const tcp::endpoint& endpoint() const noexcept { return endpoint_; }
  [[nodiscard]] const LiveStatistics& statistics() const noexcept { return statistics_; }

  void run(const std::atomic<bool>& stop) {
    realtime::yield_to_loop();
    accept();
    poll(stop);
    context_.run();
  }

  std::optional<Response> refusal(const Connection& from, const Request& request) override {
    std::optional<Response> answer = refusal_for(from, request);
    if (answer && answer->status != kOk) {
      log_refused(from, answer->body.substr(0, answer->body.find('\n')));
    }
    return answer;
  }

  void opened(Connection& /*connection*/) override {}

  void ended(Connection& connection) override { statistics_.left_out += connection.left_out(); }

  void received(Connection& from, std::string_view message, bool text, bool excess) override {
    ++statistics_.messages;
    LiveReference reference;
    try {
      if (excess) {
        throw LiveError("rate",
                        fmt::format("message: is one too many, there may be {} a second; it was not read",
                                    static_cast<int>(Connection::kMessagesPerSecond)));
      }
      if (!text) throw LiveError("json", "message: is binary, must be a text frame of JSON");
      const LiveCommand command = read_live_message(message, reference);
      obey(from, command, reference);
    } catch (const InputError& error) {
      ++statistics_.errors;
      from.send(error_text(reference, error));
      const auto* live = dynamic_cast<const LiveError*>(&error);
      if (live != nullptr &&
          (live->code() == "version" || live->code() == "token" || live->code() == "full")) {
        log_refused(from, live->what());
        from.close(live->code() == "full" ? CloseCode::kTryLater : CloseCode::kPolicy, live->code());
      }
    } catch (const std::exception& error) {  // one client's error must not end the others' service
      ++statistics_.errors;
      from.send(error_text(reference, LiveError("refused", error.what())));
    }
  }

  std::string next_frame(Connection& to) override {
    const LiveState state = service_.newest();
    if (state.tick == nullptr) return {};
    const std::pair<std::uint64_t, std::uint64_t> now{state.run, state.tick->tick};
    if (now == to.last_frame) return {};
    to.last_frame = now;
    if (now != written_) {
      written_ = now;
      written_text_ = text_of(state_json(state));
    }
    ++statistics_.frames;
    return frame_text(written_text_, to.left_out());
  }

 private:
  void accept() {
    acceptor_.async_accept([this](const error_code& error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) {  // such as no free descriptor: accept again after a pause
        accept_later_ = true;
        return;
      }
      ++statistics_.connections;
      const std::uint64_t number = statistics_.connections;
      auto made = std::make_unique<Connection>(number, std::move(socket), *this, kLargestRequest);
      Connection& connection = *made;
      make_room(connection.peer());
      connections_.emplace(number, std::move(made));
      connection.begin();
      accept();
    });
  }

  /// Drops the oldest connection without "hello" when too many of them wait: from this peer at
  /// kMaxPendingPerAddress, from all peers at kMaxPending.
  void make_room(const asio::ip::address& peer) {
    Connection* oldest = nullptr;
    Connection* oldest_of_peer = nullptr;
    std::size_t all = 0;
    std::size_t of_peer = 0;
    for (const auto& [number, connection] : connections_) {  // in the order of connection
      if (connection->greeted || connection->is_over()) continue;
      ++all;
      if (oldest == nullptr) oldest = connection.get();
      if (connection->peer() != peer) continue;
      ++of_peer;
      if (oldest_of_peer == nullptr) oldest_of_peer = connection.get();
    }
    Connection* leaves = of_peer >= kMaxPendingPerAddress ? oldest_of_peer
                         : all >= kMaxPending             ? oldest
                                                          : nullptr;
    if (leaves == nullptr) return;
    log_refused(*leaves, "it had not said hello, and others came");
    leaves->drop();
  }

  /// Counts a refused connection and writes a line to the log, at a limited rate.
  void log_refused(const Connection& from, const std::string& why) {
    ++statistics_.refused;
    if (!log_limit_.allows(monotonic_ns())) {
      ++unlogged_;
      return;
    }
    const std::uint64_t more = std::exchange(unlogged_, 0);
    if (!options_.log) return;
    options_.log(fmt::format("refused {}: {}{}", in_url(from.peer()), why,
                             more == 0 ? "" : fmt::format(" (and {} more before)", more)));
  }

  [[nodiscard]] bool is_full() const {
    const auto clients = std::count_if(connections_.begin(), connections_.end(), [](const auto& entry) {
      return entry.second->greeted && entry.second->is_open();
    });
    return static_cast<std::size_t>(clients) >= kMaxClients;
  }

  std::optional<Response> refusal_for(const Connection& from, const Request& request) const {
    if (!request.upgrade && request.get) {
      const auto file = options_.page.find(request.target);
      if (file != options_.page.end()) return page_answer(file->second);
    }
    if (request.target != "/") {
      return plain_answer(kNotFound, "There is nothing here; the live interface is at /.");
    }
    if (!request.upgrade) {
      return plain_answer(kUpgradeRequired, "This is palpate's live interface, which speaks WebSocket.");
    }
    const asio::ip::address& local = from.local().address();
    const std::vector<std::string>& origins = request.origins;
    if (origins.size() > 1 ||
        (origins.size() == 1 && !origin_allowed(origins.front(), in_url(local), endpoint_.port(),
                                                local.is_loopback(), options_.origins))) {
      return plain_answer(kForbidden, "A web page of this origin may not connect; --allow-origin lets it.");
    }
    if (is_full()) {
      return plain_answer(kUnavailable, fmt::format("There are {} clients already.", kMaxClients));
    }
    return std::nullopt;
  }

  void obey(Connection& from, const LiveCommand& command, const LiveReference& reference) {
    const auto* hello = std::get_if<Hello>(&command);
    if (from.greeted == (hello != nullptr)) {
      throw LiveError("hello", from.greeted ? "do = \"hello\": was said already"
                                            : "do: must be \"hello\" in the first message");
    }
    if (hello != nullptr) {
      greet(from, *hello, reference);
    } else if (const auto* stream = std::get_if<Stream>(&command)) {
      from.send(answer_text(reference, {{"rate_Hz", stream->rate_Hz}}));
      from.stream(stream->rate_Hz);
    } else if (std::holds_alternative<GetVersion>(command)) {
      from.send(answer_text(reference, version()));
    } else if (std::holds_alternative<GetState>(command)) {
      const LiveState state = service_.newest();
      from.send(
          answer_text(reference, {{"run", service_.about_run()},
                                  {"state", state.tick == nullptr ? Json(nullptr) : state_json(state)}}));
    } else if (const auto answer = service_.answer(command, {from.number(), reference})) {
      from.send(answer_text(reference, *answer));
    }
  }

  void greet(Connection& from, const Hello& hello, const LiveReference& reference) {
    if (!options_.token.empty() && !same_token(options_.token, hello.token)) {
      throw LiveError(
          "token",
          hello.token.empty() ? "token: missing, this server asks for one" : "token: is not this server's",
          "token");
    }
    if (is_full()) {
      throw LiveError(
          "full", fmt::format("do = \"hello\": there are {} clients already, try again later", kMaxClients));
    }
    from.greeted = true;
    someone_came_ = true;
    Json members = version();
    members["client"] = from.number();
    members["limits"] = {{"message_bytes", kLargestRequest},
                         {"messages_per_s", Connection::kMessagesPerSecond},
                         {"stream_Hz", kFastestStream},
                         {"clients", kMaxClients}};
    from.send(answer_text(reference, members));
  }

  static Json version() {
    return {{"palpate", kLiveProtocol}, {"program", std::string("palpate ") + kVersion}};
  }

  /// Runs every kPollPeriodMs. It sends the service's events, checks each connection, removes closed
  /// connections and stops the server when `stop` is set.
  void poll(const std::atomic<bool>& stop) {
    const bool ends = stop.load(std::memory_order_relaxed);  // read first, so that the service is polled once
                                                             // more after `stop` was set
    const auto present = std::count_if(connections_.begin(), connections_.end(), [](const auto& entry) {
      return entry.second->greeted && entry.second->is_open();
    });
    const std::size_t clients =
        std::max<std::size_t>(static_cast<std::size_t>(present), someone_came_ ? 1 : 0);
    someone_came_ = false;
    for (const Event& event : service_.poll(clients)) send_event(event);
    for (const auto& [number, connection] : connections_) watch(*connection);
    remove_closed();
    if (ends) return send_goodbye();
    if (std::exchange(accept_later_, false)) accept();
    timer_.expires_after(std::chrono::milliseconds(kPollPeriodMs));
    timer_.async_wait([this, &stop](const error_code&) { poll(stop); });
  }

  /// Ends a connection without "hello" within kHelloLimit, a connection whose message has too many fragments,
  /// and a connection that the client does not close within kCloseLimit.
  void watch(Connection& connection) {
    const std::int64_t now = monotonic_ns();
    if (connection.closing_ns() != 0) {
      if (now - connection.closing_ns() > kCloseLimit) connection.drop();
    } else if (connection.is_endless()) {
      log_refused(connection, "its message in fragments had no end");
      connection.close(CloseCode::kTooBig, "too many fragments");
    } else if (!connection.greeted && now - connection.begun_ns() > kHelloLimit) {
      if (!connection.is_open()) return connection.drop();
      log_refused(connection, "it said no hello within 5 s");
      connection.send(error_text({}, LiveError("hello", "do: must be \"hello\" within 5 s")));
      connection.close(CloseCode::kPolicy, "hello");
    }
  }

  void send_event(const Event& event) {
    if (!event.to) {
      const std::string text = event_text(event.name, event.members);
      for (const auto& [number, connection] : connections_) {
        if (connection->greeted) connection->send(text);
      }
      return;
    }
    const auto found = connections_.find(event.to->client);
    if (found == connections_.end()) return;
    if (event.error) ++statistics_.errors;
    found->second->send(event.error ? error_text(event.to->reference, *event.error)
                                    : answer_text(event.to->reference, event.members));
  }

  void remove_closed() {
    for (auto entry = connections_.begin(); entry != connections_.end();) {
      entry = entry->second->is_over() ? connections_.erase(entry) : std::next(entry);
    }
  }

  void send_goodbye() {
    error_code ignored;
    acceptor_.close(ignored);
    for (const auto& [number, connection] : connections_) {
      if (connection->is_open()) {
        connection->close(CloseCode::kGoingAway, "palpate serve ends");
      } else {
        connection->drop();
      }
    }
    farewell_until_ns_ = monotonic_ns() + kShutdownTime;
    wait_for_last_connection();
  }

  /// Ends run() when all connections are closed. Connections that are still open after kShutdownTime are
  /// dropped.
  void wait_for_last_connection() {
    remove_closed();
    if (connections_.empty()) return context_.stop();  // the library's timers may still be set
    if (monotonic_ns() >= farewell_until_ns_) {
      for (const auto& [number, connection] : connections_) connection->drop();
    }
    timer_.expires_after(std::chrono::milliseconds(kPollPeriodMs));
    timer_.async_wait([this](const error_code&) { wait_for_last_connection(); });
  }

  LiveOptions options_;
  RunService& service_;
  LiveStatistics statistics_;
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  tcp::endpoint endpoint_;
  asio::steady_timer timer_{context_};
  RateLimit log_limit_{kLogLines, kLogLinesAtOnce};
  std::uint64_t unlogged_ = 0;  // connections refused since the last log line
  bool accept_later_ = false;
  bool someone_came_ = false;  // a client came since the last poll()
  std::int64_t farewell_until_ns_ = 0;
  std::pair<std::uint64_t, std::uint64_t> written_{0, 0};  // run and tick of written_text_
  std::string written_text_;
  // The connections are the last member because they use the members above.
  std::map<std::uint64_t, std::unique_ptr<Connection>> connections_;
};

LiveServer::LiveServer(const LiveOptions& options, RunService& service)
    : server_(std::make_unique<Server>(options, service)) {}
LiveServer::~LiveServer() = default;

std::string LiveServer::host() const { return in_url(server_->endpoint().address()); }
std::uint16_t LiveServer::port() const { return server_->endpoint().port(); }
void LiveServer::run(const std::atomic<bool>& stop) { server_->run(stop); }
const LiveStatistics& LiveServer::statistics() const noexcept { return server_->statistics(); }

}  // namespace palpate::net
