#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>  // before Asio: Asio 1.74 does not include it
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

namespace palpate::websocket {

/// [any] Token bucket: limits the long-term rate of events per second and the size of a burst.
class RateLimit final {
 public:
  RateLimit(double per_second, double at_once) noexcept
      : per_ns_(per_second / 1e9), most_(at_once), left_(at_once) {}

  /// Whether one more event is within the limit; an event beyond it is not counted. @param now_ns monotonic
  /// time
  [[nodiscard]] bool allows(std::int64_t now_ns) noexcept {
    if (last_ns_ != 0) left_ = std::min(most_, left_ + per_ns_ * static_cast<double>(now_ns - last_ns_));
    last_ns_ = now_ns;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double per_ns_;
  double most_;
  double left_;
  std::int64_t last_ns_ = 0;
};

class Connection;

/// An HTTP request for a WebSocket or a page.
struct Request {
  bool upgrade = false;  // asks for a WebSocket
  bool get = false;      // its method
  std::string target;
  std::vector<std::string> origins;  // the values of its Origin fields
};

/// An HTTP answer.
struct Response {
  unsigned status = 200;
  std::vector<std::pair<std::string, std::string>> fields;  // names and values
  std::string body;
};

/// Why a connection is closed [RFC 6455, 7.4.1].
enum class CloseCode : std::uint16_t { kGoingAway = 1001, kPolicy = 1008, kTooBig = 1009, kTryLater = 1013 };

/// Callbacks of a connection to its server, on the server's thread.
class ConnectionHandler {
 public:
  virtual ~ConnectionHandler() = default;
  /// Nothing if the request may open a WebSocket, else the HTTP answer: an error, or the requested page.
  virtual std::optional<Response> refusal(const Connection& from, const Request& request) = 0;
  /// A message was received. @param excess it exceeds the rate limit
  virtual void received(Connection& from, std::string_view message, bool text, bool excess) = 0;
  /// The next frame of the client's stream; empty: no new tick.
  virtual std::string next_frame(Connection& to) = 0;
  /// The WebSocket has been opened; the connection has ended.
  virtual void opened(Connection& connection) = 0;
  virtual void ended(Connection& connection) = 0;
};

/// One connection: an HTTP request, then, if accepted, a WebSocket. Answers and events wait in a bounded
/// queue. Frames of a stream do not wait: if the client has not received the last frame, the next one is
/// dropped and counted. Every operation has a time limit. All members are called on the thread that runs the
/// context.
class Connection final {
 public:
  using tcp = boost::asio::ip::tcp;
  using error_code = boost::system::error_code;

  static constexpr double kMessagesPerSecond = 100.0;
  static constexpr double kMessagesAtOnce = 200.0;
  static constexpr int kMaxExcess = 100;           // more in a row above the rate limit end the connection
  static constexpr std::size_t kMaxWaiting = 256;  // answers and events; more end the connection
  static constexpr std::size_t kReadOnBelow = 32;  // nothing is read while more answers wait
  // Network bytes of a message divided by its largest size, at most. In fragments of one byte it takes 7.
  static constexpr std::uint64_t kMaxOverhead = 8;
  static constexpr std::chrono::seconds kOpening{5};   // for the request, and for the handshakes
  static constexpr std::chrono::seconds kSilence{30};  // without data from the client, pings included
  static constexpr int kSendBuffer = 65536;            // bytes that the system keeps for a slow client

  /// @param largest size of a message [bytes]
  Connection(std::uint64_t number, tcp::socket socket, ConnectionHandler& handler, std::size_t largest);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Reads the request and answers it.
  void begin();
  /// Queues a message; ignored when the connection is ending.
  void send(std::string text);
  /// Ends the connection after the queued messages are sent. @param why for the client, at most 123 bytes
  void close(CloseCode code, const std::string& why);
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
  /// Whether the current message exceeds the limit of network bytes, as endless empty fragments do.
  [[nodiscard]] bool is_endless() const noexcept;
  /// Number of frames dropped because the client had not yet received the previous frame.
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_; }

  // Used only by the server:
  bool greeted = false;
  std::pair<std::uint64_t, std::uint64_t> last_frame{0, 0};  // run and tick

 private:
  void on_request(const error_code& error);
  void answer_http(Response response);
  void read();
  void on_message(const error_code& error);
  void count_control();
  void write();
  void end() noexcept;
  void wait_for_frame();
  void on_frame_due();

  struct Socket;
  std::uint64_t number_;
  ConnectionHandler& handler_;
  std::size_t largest_;
  tcp::endpoint local_;
  boost::asio::ip::address peer_;
  std::unique_ptr<Socket> socket_;
  boost::asio::steady_timer alarm_;
  RateLimit limit_{kMessagesPerSecond, kMessagesAtOnce};
  std::deque<std::string> waiting_;
  std::string outgoing_;
  std::optional<std::pair<CloseCode, std::string>> closing_;
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

}  // namespace palpate::websocket
