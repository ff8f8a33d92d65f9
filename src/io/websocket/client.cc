#include "io/websocket/client.h"

#include <algorithm>
#include <chrono>
#include <utility>  // before Asio: Asio 1.74 does not include it
#include <vector>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/core.h>

#include "io/system/clock.h"
#include "io/websocket/stream.h"

namespace palpate::websocket {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using beast::error_code;

constexpr std::int64_t kPollPeriod = 5'000'000;  // ns between two checks whether to give up

std::string describe(const error_code& error) {
  if (error == asio::error::connection_refused) return "connection refused";
  if (error == beast::websocket::error::closed) return "the service closed the connection";
  if (error == beast::websocket::error::message_too_big ||
      error == beast::websocket::error::buffer_overflow) {
    return fmt::format("the service sent a message of more than {} bytes", Client::kLargestMessage);
  }
  if (error == asio::error::eof || error == asio::error::connection_reset ||
      error == asio::error::broken_pipe) {
    return "the connection broke off";
  }
  std::string text = error.message();  // the message of the system or of the library
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

std::string Address::text() const {
  const bool six = host.find(':') != std::string::npos;
  return fmt::format("ws://{}:{}", six ? "[" + host + "]" : host, port);
}

/// The connection through Boost.Beast. One thread starts the operations and runs their callbacks.
class Client::Socket final {
 public:
  Socket(const Address& address, const std::atomic<bool>& give_up)
      : give_up_(give_up), host_(address.text().substr(5)) {
    tcp::resolver resolver(context_);
    error_code error;
    for (const auto& found : resolver.resolve(address.host, address.port, error)) {
      endpoints_.push_back(found.endpoint());
    }
    if (error || endpoints_.empty()) throw Error("there is no host \"" + address.host + "\"");
  }
  ~Socket() { drop(); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void open(std::int64_t limit_ns) {
    drop();
    const std::int64_t deadline = monotonic_ns() + limit_ns;
    stream_.emplace(context_);
    connecting_.running = true;
    asio::async_connect(raw(), endpoints_,
                        [this](const error_code& error, const tcp::endpoint&) { connecting_.end(error); });
    finish(connecting_, deadline, "no connection within " + milliseconds(limit_ns));
    error_code ignored;
    raw().set_option(tcp::no_delay(true), ignored);  // small commands are sent without delay
    stream_->read_message_max(kLargestMessage);
    beast::websocket::response_type response;
    connecting_.running = true;
    stream_->async_handshake(response, host_, "/",
                             [this](const error_code& error) { connecting_.end(error); });
    try {
      finish(connecting_, deadline, "no answer to the WebSocket handshake within " + milliseconds(limit_ns));
    } catch (const Error&) {
      if (connecting_.error != beast::websocket::error::upgrade_declined) throw;
      throw Error("what listens there declines the WebSocket handshake with HTTP status " +
                  std::to_string(response.result_int()));
    }
    stream_->text(true);
    read();
  }

  [[nodiscard]] bool is_open() const noexcept { return stream_.has_value(); }
  [[nodiscard]] bool sending() const noexcept { return writing_.running; }

  void send(std::string message) {
    check(writing_);
    outgoing_ = std::move(message);
    writing_.running = true;
    stream_->async_write(asio::buffer(outgoing_),
                         [this](const error_code& error, std::size_t) { writing_.end(error); });
  }

  std::optional<std::string> received() {
    if (reading_.running) return std::nullopt;
    check(reading_);
    std::string message = beast::buffers_to_string(incoming_.data());
    incoming_.consume(incoming_.size());
    read();
    return message;
  }

  void wait_until(std::int64_t deadline_ns) {
    if (!alarm_set_ || deadline_ns < alarm_ns_) {
      alarm_set_ = true;
      alarm_ns_ = deadline_ns;
      alarm_.expires_at(std::chrono::steady_clock::time_point(std::chrono::nanoseconds(deadline_ns)));
      alarm_.async_wait([this](const error_code& error) {
        if (!error) alarm_set_ = false;
      });
    }
    run_one();
  }

  void close(std::int64_t limit_ns) {
    if (!is_open()) return;
    const std::int64_t deadline = monotonic_ns() + limit_ns;
    while (writing_.running && monotonic_ns() < deadline) wait_until(deadline);
    if (!writing_.running && !writing_.error) {
      closing_.running = true;
      stream_->async_close(beast::websocket::close_code::normal,
                           [this](const error_code& error) { closing_.end(error); });
      while (closing_.running && monotonic_ns() < deadline) wait_until(deadline);
    }
    drop();
  }

  void drop() noexcept {
    if (!stream_) return;
    error_code ignored;
    raw().close(ignored);
    // Closing the socket ends the pending operations. The buffers must outlive them.
    while (connecting_.running || reading_.running || writing_.running || closing_.running) run_one();
    stream_.reset();
    incoming_.clear();
    connecting_ = reading_ = writing_ = closing_ = {};
  }

 private:
  struct Operation {
    bool running = false;
    error_code error;
    void end(const error_code& how) {
      running = false;
      error = how;
    }
  };

  [[nodiscard]] tcp::socket& raw() noexcept { return beast::get_lowest_layer(*stream_).socket(); }

  static std::string milliseconds(std::int64_t ns) { return std::to_string(ns / 1'000'000) + " ms"; }

  void check(const Operation& operation) {
    if (!is_open()) throw Error("not connected");
    if (!operation.error) return;
    const std::string why = describe(operation.error);
    drop();
    throw Error(why);
  }

  void read() {
    reading_.running = true;
    stream_->async_read(incoming_, [this](const error_code& error, std::size_t) { reading_.end(error); });
  }

  void run_one() {
    context_.restart();  // io_context stops whenever it has no work
    context_.run_one();
  }

  /// Waits until an operation of open() ends. Closes the socket on an error or a timeout. @throws
  /// Error
  void finish(Operation& operation, std::int64_t deadline, const std::string& too_long) {
    while (operation.running) {
      const std::int64_t now = monotonic_ns();
      if (now >= deadline || give_up_.load(std::memory_order_relaxed)) {
        drop();
        throw Error(now >= deadline ? too_long : "given up");
      }
      wait_until(std::min(deadline, now + kPollPeriod));
    }
    if (!operation.error) return;
    const error_code error = operation.error;
    drop();
    operation.error = error;  // drop() cleared the error; open() may still read it
    throw Error(describe(error));
  }

  const std::atomic<bool>& give_up_;
  std::string host_;
  std::vector<tcp::endpoint> endpoints_;
  asio::io_context context_{1};
  asio::steady_timer alarm_{context_};
  bool alarm_set_ = false;
  std::int64_t alarm_ns_ = 0;
  std::optional<Stream> stream_;
  Operation connecting_, reading_, writing_, closing_;
  beast::flat_buffer incoming_;
  std::string outgoing_;
};

Client::Client(const Address& address, const std::atomic<bool>& give_up)
    : socket_(std::make_unique<Socket>(address, give_up)) {}
Client::~Client() = default;

void Client::open(std::int64_t limit_ns) { socket_->open(limit_ns); }
bool Client::is_open() const noexcept { return socket_->is_open(); }
void Client::send(std::string message) { socket_->send(std::move(message)); }
bool Client::sending() const noexcept { return socket_->sending(); }
std::optional<std::string> Client::received() { return socket_->received(); }
void Client::wait_until(std::int64_t deadline_ns) { socket_->wait_until(deadline_ns); }
void Client::drop() noexcept { socket_->drop(); }

void Client::close(std::int64_t limit_ns) noexcept {
  try {
    socket_->close(limit_ns);
  } catch (const std::exception&) {
    socket_->drop();
  }
}

}  // namespace palpate::websocket
