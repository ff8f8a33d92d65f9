#pragma once
// Only the .cc files of this module and its tests include this file.
#include <chrono>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>  // before Asio, whose 1.74 forgets it

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "net/rate_limit.h"

namespace palpate::net {

class LiveConnection;

using HttpRequest = boost::beast::http::request<boost::beast::http::string_body>;
using HttpResponse = boost::beast::http::response<boost::beast::http::string_body>;

/// Callbacks of a connection to its server, on the server's thread.
class ConnectionHandler {
 public:
  virtual ~ConnectionHandler() = default;
  /// Nothing if the request may open a WebSocket, else the HTTP answer: an error, or the requested page.
  virtual std::optional<HttpResponse> refusal(const LiveConnection& from, const HttpRequest& request) = 0;
  /// A message was received. @param excess it exceeds the rate limit
  virtual void received(LiveConnection& from, std::string_view message, bool text, bool excess) = 0;
  /// The next frame of the client's stream; empty: no new tick.
  virtual std::string next_frame(LiveConnection& to) = 0;
  /// The WebSocket has been opened; the connection has ended.
  virtual void opened(LiveConnection& connection) = 0;
  virtual void ended(LiveConnection& connection) = 0;
};

/// Counts the bytes that a connection has read from the network. The WebSocket library silently skips empty
/// fragments, so that only this count shows a message that never ends.
class ReadCount {
 public:
  std::uint64_t bytes = 0;

 private:
  friend class boost::beast::rate_policy_access;
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  static std::size_t available_read_bytes() noexcept { return kAll; }
  static std::size_t available_write_bytes() noexcept { return kAll; }
  void transfer_read_bytes(std::size_t count) noexcept { bytes += count; }
  static void transfer_write_bytes(std::size_t /*count*/) noexcept {}
  static void on_timer() noexcept {}
};

/// One connection: an HTTP request, then, if accepted, a WebSocket. Answers and events wait in a bounded
/// queue. Frames of a stream do not wait: if the client has not received the last frame, the next one is
/// dropped and counted. Every operation has a time limit. All members are called on the thread that runs the
/// context.
class LiveConnection final {
 public:
  using tcp = boost::asio::ip::tcp;
  using error_code = boost::beast::error_code;

  static constexpr double kMessagesPerSecond = 100.0;
  static constexpr double kMessagesAtOnce = 200.0;
  static constexpr int kMaxExcess = 100;           // more in a row above the rate limit end the connection
  static constexpr std::size_t kMaxWaiting = 256;  // answers and events; more end the connection
  static constexpr std::size_t kReadOnBelow = 32;  // nothing is read while more answers wait
  // Network bytes of one message, at most. The largest message in fragments of one byte takes 114,688.
  static constexpr std::uint64_t kMaxMessageBytes = 131'072;
  static constexpr std::chrono::seconds kOpening{5};   // for the request, and for the handshakes
  static constexpr std::chrono::seconds kSilence{30};  // without data from the client, pings included
  static constexpr int kSendBuffer = 65536;            // bytes that the system keeps for a slow client

  LiveConnection(std::uint64_t number, tcp::socket socket, ConnectionHandler& handler);
  LiveConnection(const LiveConnection&) = delete;
  LiveConnection& operator=(const LiveConnection&) = delete;

  /// Reads the request and answers it.
  void begin();
  /// Queues a message; ignored when the connection is ending.
  void send(std::string text);
  /// Ends the connection after the queued messages are sent. @param why for the client, at most 123 bytes
  void close(boost::beast::websocket::close_code code, const std::string& why);
  /// Ends the connection at once, without the closing handshake.
  void drop() noexcept;
  /// Sets the rate of the stream [Hz]; 0: ends it.
  void stream(double rate_Hz);

  [[nodiscard]] std::uint64_t number() const noexcept { return number_; }
  [[nodiscard]] bool is_open() const noexcept { return open_ && !closing_ && !ended_; }
  /// Whether no operation is pending, so that the object can be destroyed.
  [[nodiscard]] bool is_over() const noexcept { return ended_ && under_way_ == 0; }
  /// Local endpoint and address of the client.
  [[nodiscard]] const tcp::endpoint& local() const noexcept { return local_; }
  [[nodiscard]] const boost::asio::ip::address& peer() const noexcept { return peer_; }
  /// When the connection was accepted, and when it began to close (0: open).
  [[nodiscard]] std::int64_t begun_ns() const noexcept { return begun_ns_; }
  [[nodiscard]] std::int64_t closing_ns() const noexcept { return closing_ns_; }
  /// Whether the current message exceeds kMaxMessageBytes network bytes, as endless empty fragments do.
  [[nodiscard]] bool is_endless() const noexcept {
    return open_ && boost::beast::get_lowest_layer(socket_).rate_policy().bytes > kMaxMessageBytes;
  }
  /// Number of frames dropped because the client had not yet received the previous frame.
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_; }

  // Used only by the server:
  bool greeted = false;
  std::pair<std::uint64_t, std::uint64_t> last_frame{0, 0};  // run and tick

 private:
  void on_request(const error_code& error);
  void answer_http(HttpResponse response);
  void read();
  void on_message(const error_code& error);
  void count_control();
  [[nodiscard]] std::uint64_t& read_bytes() noexcept {
    return boost::beast::get_lowest_layer(socket_).rate_policy().bytes;
  }
  void write();
  void end() noexcept;
  void wait_for_frame();
  void on_frame_due();

  std::uint64_t number_;
  ConnectionHandler& handler_;
  tcp::endpoint local_;
  boost::asio::ip::address peer_;
  boost::beast::websocket::stream<
      boost::beast::basic_stream<tcp, boost::beast::tcp_stream::executor_type, ReadCount>>
      socket_;
  boost::asio::steady_timer alarm_;
  boost::beast::flat_buffer incoming_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
  std::optional<HttpResponse> response_;
  RateLimit limit_{kMessagesPerSecond, kMessagesAtOnce};
  std::deque<std::string> waiting_;
  std::string outgoing_;
  std::optional<boost::beast::websocket::close_reason> closing_;
  std::chrono::nanoseconds period_{0};  // of the stream; 0: none
  std::chrono::steady_clock::time_point due_;
  std::uint64_t streams_ = 0;  // streams requested so far, to recognize the timer of an earlier one
  std::uint64_t left_out_ = 0;
  std::int64_t begun_ns_ = 0;
  std::int64_t closing_ns_ = 0;
  int under_way_ = 0;  // pending operations
  int excess_ = 0;     // consecutive messages above the rate limit
  bool reading_ = false;
  bool writing_ = false;
  bool close_begun_ = false;
  bool frame_due_ = false;
  bool open_ = false;
  bool ended_ = false;
};

}  // namespace palpate::net
