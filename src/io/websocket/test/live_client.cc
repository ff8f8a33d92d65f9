#include "io/websocket/test/live_client.h"

#include <chrono>
#include <utility>  // before Asio: Asio 1.74 does not include it

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace palpate::net::test {

class LiveClient::Socket final {
 public:
  Socket(std::uint16_t port, const Knock& knock) {
    auto& socket = tcp_socket();
    socket.open(boost::asio::ip::tcp::v4());
    if (knock.receive_buffer > 0) {
      socket.set_option(boost::asio::socket_base::receive_buffer_size(knock.receive_buffer));
    }
    socket.connect({boost::asio::ip::make_address("127.0.0.1"), port});
    stream_.set_option(boost::beast::websocket::stream_base::decorator(
        [origin = knock.origin](boost::beast::websocket::request_type& request) {
          if (!origin.empty()) request.set(boost::beast::http::field::origin, origin);
        }));
    boost::beast::websocket::response_type response;
    bool done = false;
    stream_.async_handshake(response, "127.0.0.1:" + std::to_string(port), knock.target,
                            [&](const boost::beast::error_code& error) {
                              done = true;
                              open_ = !error;
                            });
    wait_for(done);
    status_ = response.result_int();
  }

  [[nodiscard]] bool open() const { return open_; }
  [[nodiscard]] unsigned status() const { return status_; }
  [[nodiscard]] int close_code() const { return stream_.reason().code; }

  void write(const std::string& text, bool binary) {
    stream_.binary(binary);
    bool done = false;
    stream_.async_write(boost::asio::buffer(text), [&](const boost::beast::error_code& error, std::size_t) {
      done = true;
      open_ = open_ && !error;
    });
    wait_for(done);
  }

  void write_raw(const std::string& bytes) {
    bool done = false;
    boost::asio::async_write(tcp_socket(), boost::asio::buffer(bytes),
                             [&](const boost::beast::error_code& error, std::size_t) {
                               done = true;
                               open_ = open_ && !error;
                             });
    wait_for(done);
  }

  std::optional<std::string> read() {
    if (!open_) return std::nullopt;
    bool done = false;
    boost::beast::flat_buffer buffer;
    stream_.async_read(buffer, [&](const boost::beast::error_code& error, std::size_t) {
      done = true;
      open_ = !error;
    });
    wait_for(done);
    if (!open_) return std::nullopt;
    return boost::beast::buffers_to_string(buffer.data());
  }

  boost::asio::ip::tcp::socket& tcp_socket() { return boost::beast::get_lowest_layer(stream_).socket(); }

 private:
  void wait_for(const bool& done) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!done) {
      context_.restart();
      context_.run_one_for(std::chrono::milliseconds(100));
      if (std::chrono::steady_clock::now() < until) continue;
      boost::beast::error_code ignored;
      tcp_socket().close(ignored);  // ends the pending operations
    }
  }

  boost::asio::io_context context_{1};
  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_{context_};
  bool open_ = false;
  unsigned status_ = 0;
};

LiveClient::LiveClient(std::uint16_t port) : LiveClient(port, Knock()) {}
LiveClient::LiveClient(std::uint16_t port, const Knock& knock)
    : socket_(std::make_unique<Socket>(port, knock)) {}
LiveClient::~LiveClient() = default;

bool LiveClient::open() const { return socket_->open(); }
unsigned LiveClient::status() const { return socket_->status(); }
int LiveClient::close_code() const { return socket_->close_code(); }

void LiveClient::say(const std::string& text, bool binary) { socket_->write(text, binary); }

bool LiveClient::say_raw(const std::string& bytes) {
  socket_->write_raw(bytes);
  return open();
}

std::optional<LiveClient::Json> LiveClient::hear() {
  const std::optional<std::string> text = socket_->read();
  if (!text) return std::nullopt;
  return Json::parse(*text);
}

LiveClient::Json LiveClient::hear_until(const std::function<bool(const Json&)>& wanted) {
  for (int i = 0; i < 100'000; ++i) {
    const std::optional<Json> message = hear();
    if (!message) return nullptr;
    if (wanted(*message)) return *message;
  }
  return nullptr;
}

LiveClient::Json LiveClient::ask(const std::string& text) {
  say(text);
  return hear_until([](const Json& message) { return message.contains("answer"); });
}

LiveClient::Json LiveClient::greet(const std::string& token) {
  return ask(Json{{"palpate", "1"}, {"do", "hello"}, {"token", token.empty() ? "none" : token}}.dump());
}

void LiveClient::vanish() { socket_->tcp_socket().close(); }

HttpAnswer http_get(std::uint16_t port, const std::string& target) {
  namespace http = boost::beast::http;
  boost::asio::io_context context;
  boost::beast::tcp_stream stream(context);
  stream.connect({boost::asio::ip::make_address("127.0.0.1"), port});
  http::write(stream, http::request<http::empty_body>(http::verb::get, target, 11));
  boost::beast::flat_buffer buffer;
  http::response<http::string_body> response;
  http::read(stream, buffer, response);
  HttpAnswer answer{response.result_int(), {}, response.body()};
  for (const auto& field : response)
    answer.fields.emplace(std::string(field.name_string()), std::string(field.value()));
  return answer;
}

}  // namespace palpate::net::test
