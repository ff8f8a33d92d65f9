#pragma once
// A client of the live interface for tests. Every wait has a time limit.
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>  // before Asio: Asio 1.74 does not include it

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

namespace palpate::net::test {

class LiveClient final {
 public:
  using Json = nlohmann::json;

  struct Knock {
    std::string origin;        // empty: the request states none
    std::string target = "/";  // of the request
    int receive_buffer = 0;    // bytes; 0: the system's choice
  };

  explicit LiveClient(std::uint16_t port) : LiveClient(port, Knock()) {}
  LiveClient(std::uint16_t port, const Knock& knock) {
    auto& socket = boost::beast::get_lowest_layer(socket_).socket();
    socket.open(boost::asio::ip::tcp::v4());
    if (knock.receive_buffer > 0) {
      socket.set_option(boost::asio::socket_base::receive_buffer_size(knock.receive_buffer));
    }
    socket.connect({boost::asio::ip::make_address("127.0.0.1"), port});
    socket_.set_option(boost::beast::websocket::stream_base::decorator(
        [origin = knock.origin](boost::beast::websocket::request_type& request) {
          if (!origin.empty()) request.set(boost::beast::http::field::origin, origin);
        }));
    boost::beast::websocket::response_type response;
    bool done = false;
    socket_.async_handshake(response, "127.0.0.1:" + std::to_string(port), knock.target,
                            [&](const boost::beast::error_code& error) {
                              done = true;
                              open_ = !error;
                            });
    wait_for([&] { return done; });
    status_ = response.result_int();
  }

  [[nodiscard]] bool open() const { return open_; }
  /// HTTP status of the server's answer. It is 101 when the server accepted the client.
  [[nodiscard]] unsigned status() const { return status_; }
  /// Code with which the server closed the connection.
  [[nodiscard]] int close_code() const { return socket_.reason().code; }

  void say(const std::string& text, bool binary = false) {
    socket_.binary(binary);
    bool done = false;
    socket_.async_write(boost::asio::buffer(text), [&](const boost::beast::error_code& error, std::size_t) {
      done = true;
      open_ = open_ && !error;
    });
    wait_for([&] { return done; });
  }

  /// Sends raw bytes on the socket, such as frames that no WebSocket library makes. @return whether the
  /// connection is open
  bool say_raw(const std::string& bytes) {
    bool done = false;
    boost::asio::async_write(boost::beast::get_lowest_layer(socket_).socket(), boost::asio::buffer(bytes),
                             [&](const boost::beast::error_code& error, std::size_t) {
                               done = true;
                               open_ = open_ && !error;
                             });
    wait_for([&] { return done; });
    return open_;
  }

  /// Next message. Empty when the connection has ended instead.
  std::optional<Json> hear() {
    if (!open_) return std::nullopt;
    bool done = false;
    boost::beast::flat_buffer buffer;
    socket_.async_read(buffer, [&](const boost::beast::error_code& error, std::size_t) {
      done = true;
      open_ = !error;
    });
    wait_for([&] { return done; });
    if (!open_) return std::nullopt;
    return Json::parse(boost::beast::buffers_to_string(buffer.data()));
  }

  /// First message that `wanted` accepts, of at most 100,000. Null when the connection ends first.
  Json hear_until(const std::function<bool(const Json&)>& wanted) {
    for (int i = 0; i < 100'000; ++i) {
      const std::optional<Json> message = hear();
      if (!message) return nullptr;
      if (wanted(*message)) return *message;
    }
    return nullptr;
  }

  /// Sends a message and reads until the answer to it.
  Json ask(const std::string& text) {
    say(text);
    return hear_until([](const Json& message) { return message.contains("answer"); });
  }
  Json greet(const std::string& token = "") {
    return ask(Json{{"palpate", "1"}, {"do", "hello"}, {"token", token.empty() ? "none" : token}}.dump());
  }
  /// Closes the socket without a WebSocket close.
  void vanish() { boost::beast::get_lowest_layer(socket_).socket().close(); }

 private:
  void wait_for(const std::function<bool()>& done) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!done()) {
      context_.restart();
      context_.run_one_for(std::chrono::milliseconds(100));
      if (std::chrono::steady_clock::now() < until) continue;
      boost::beast::error_code ignored;
      boost::beast::get_lowest_layer(socket_).socket().close(ignored);  // ends the pending operations
    }
  }

  boost::asio::io_context context_{1};
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_{context_};
  bool open_ = false;
  unsigned status_ = 0;
};

}  // namespace palpate::net::test
