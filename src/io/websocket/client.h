#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

namespace palpate::websocket {

/// Where a service listens.
struct Address {
  std::string host;
  std::string port;
  [[nodiscard]] std::string text() const;  // ws://HOST:PORT
};

/// The connection failed or has ended. what() gives the cause, without the address.
class Error final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A WebSocket to a service, as its client. Every wait has a time limit and every message a size limit, so
/// that a server cannot make it hang or exhaust memory. For one thread at a time; never for the tick.
class Client final {
 public:
  static constexpr std::size_t kLargestMessage = std::size_t{1} << 20;  // bytes
  static constexpr std::int64_t kOpeningLimit = 3'000'000'000;          // ns, for connection and handshake

  /// [setup] Resolves the host name once; open() asks no name server.
  /// @param give_up ends every wait early when another thread sets it
  /// @throws Error when there is no such host.
  Client(const Address& address, const std::atomic<bool>& give_up);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Connects and completes the handshake within `limit_ns`. @throws Error; the link is then closed.
  void open(std::int64_t limit_ns = kOpeningLimit);
  [[nodiscard]] bool is_open() const noexcept;

  /// Starts to send a message; requires sending() to be false. @throws Error when the last one
  /// failed.
  void send(std::string message);
  /// Whether a message is not yet completely in the system's buffers.
  [[nodiscard]] bool sending() const noexcept;
  /// The next received message, if there is one. @throws Error when the connection has ended.
  [[nodiscard]] std::optional<std::string> received();
  /// Sleeps until data is received or sent, or until that monotonic time [ns].
  void wait_until(std::int64_t deadline_ns);

  /// Closes the connection with the closing handshake within `limit_ns`, else at once as drop() does.
  void close(std::int64_t limit_ns) noexcept;
  /// Ends the connection at once, without the closing handshake.
  void drop() noexcept;

 private:
  class Socket;
  std::unique_ptr<Socket> socket_;
};

}  // namespace palpate::websocket
