#include "io/websocket/test/haply_service.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>
#include <utility>  // before Asio: Asio 1.74 does not include it

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <sys/socket.h>

namespace palpate::devices::test {

class HaplyService::Server final {
 public:
  Server(std::string greeting, Script script, Manner manner)
      : greeting_(std::move(greeting)), script_(std::move(script)), manner_(manner) {
    thread_ = std::thread([this] { serve(); });
  }
  ~Server() {
    ending_ = true;
    ::shutdown(acceptor_.native_handle(), SHUT_RDWR);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      for (const int open : open_) ::shutdown(open, SHUT_RDWR);
    }
    thread_.join();
    for (std::thread& connection : threads_) connection.join();
  }

  [[nodiscard]] std::string address() const {
    return "ws://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port());
  }
  [[nodiscard]] std::vector<Received> received() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return received_;
  }
  [[nodiscard]] Vec3 force() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return received_.empty() ? Vec3::Constant(std::nan("")) : received_.back().force;
  }
  [[nodiscard]] std::size_t connections() const { return connections_; }
  [[nodiscard]] bool said_farewell() const { return farewell_; }
  void hold_back(bool holds) { holds_back_ = holds; }
  void greet_with(std::string greeting) {
    const std::lock_guard<std::mutex> lock(mutex_);
    greeting_ = std::move(greeting);
  }

 private:
  using tcp = boost::asio::ip::tcp;
  using Socket = boost::beast::websocket::stream<tcp::socket>;
  using error_code = boost::beast::error_code;

  void serve() {
    while (!ending_) {
      error_code error;
      tcp::socket socket(context_);
      acceptor_.accept(socket, error);
      if (error) return;
      threads_.emplace_back([this, connection = std::move(socket)]() mutable {
        const int handle = connection.native_handle();
        {
          const std::lock_guard<std::mutex> lock(mutex_);
          open_.push_back(handle);
        }
        ++connections_;
        if (!ending_) talk(connection, handle);
        forget(handle);
      });
    }
  }

  void forget(int handle) {
    const std::lock_guard<std::mutex> lock(mutex_);
    open_.erase(std::remove(open_.begin(), open_.end(), handle), open_.end());
  }

  void talk(tcp::socket& socket, int handle) {
    error_code error;
    if (manner_ == Manner::kMute) {
      char byte = 0;
      while (!error) socket.read_some(boost::asio::buffer(&byte, 1), error);
      return;
    }
    if (manner_ == Manner::kDeclines) {
      boost::beast::flat_buffer buffer;
      boost::beast::http::request<boost::beast::http::string_body> request;
      boost::beast::http::read(socket, buffer, request, error);
      boost::beast::http::response<boost::beast::http::string_body> response(
          boost::beast::http::status::forbidden, request.version());
      response.prepare_payload();
      boost::beast::http::write(socket, response, error);
      return;
    }
    Socket stream(std::move(socket));
    stream.accept(error);
    converse(stream, handle, error);
    error_code ignored;
    stream.next_layer().close(ignored);
  }

  void converse(Socket& stream, int handle, error_code error) {
    stream.text(true);
    while (holds_back_ && !ending_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::string greeting;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      greeting = greeting_;
    }
    if (!error && !greeting.empty()) stream.write(boost::asio::buffer(greeting), error);
    for (std::size_t command = 0; !error; ++command) {
      boost::beast::flat_buffer buffer;
      stream.read(buffer, error);
      if (error) break;
      keep(boost::beast::buffers_to_string(buffer.data()));
      const Answer answer = script_(command);
      if (answer.text) stream.write(boost::asio::buffer(*answer.text), error);
      if (answer.then == Answer::Then::kGoOn) continue;
      forget(handle);
      if (answer.then == Answer::Then::kClose)
        stream.close(boost::beast::websocket::close_code::normal, error);
      return;
    }
    if (error == boost::beast::websocket::error::closed) farewell_ = true;
  }

  void keep(const std::string& text) {
    const nlohmann::json arm = nlohmann::json::parse(text).at("inverse3").at(0);
    const nlohmann::json v = arm.at("commands").at("set_cursor_force").begin().value();
    const std::lock_guard<std::mutex> lock(mutex_);
    received_.push_back({arm.at("device_id"), Vec3(v.at("x"), v.at("y"), v.at("z"))});
  }

  boost::asio::io_context context_;
  tcp::acceptor acceptor_{context_, tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0)};
  mutable std::mutex mutex_;
  std::string greeting_;
  std::vector<Received> received_;
  std::vector<int> open_;
  const Script script_;
  const Manner manner_;
  std::atomic<bool> ending_{false};
  std::atomic<bool> farewell_{false};
  std::atomic<bool> holds_back_{false};
  std::atomic<std::size_t> connections_{0};
  std::vector<std::thread> threads_;
  std::thread thread_;
};

HaplyService::HaplyService(std::string greeting, Script script, Manner manner)
    : server_(std::make_unique<Server>(std::move(greeting), std::move(script), manner)) {}
HaplyService::~HaplyService() = default;

std::string HaplyService::address() const { return server_->address(); }
std::vector<HaplyService::Received> HaplyService::received() const { return server_->received(); }
Vec3 HaplyService::force() const { return server_->force(); }
std::size_t HaplyService::connections() const { return server_->connections(); }
bool HaplyService::said_farewell() const { return server_->said_farewell(); }
void HaplyService::hold_back(bool holds) { server_->hold_back(holds); }
void HaplyService::greet_with(std::string greeting) { server_->greet_with(std::move(greeting)); }

}  // namespace palpate::devices::test
