#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

namespace palpate::devices {

/// Where the service listens: ws://HOST:PORT.
struct HaplyAddress {
  std::string host;
  std::string port;
  [[nodiscard]] std::string text() const;
};

/// [setup] Takes an address apart; empty: ws://localhost:10001, where the service listens by default.
/// @throws InputError that says its form.
[[nodiscard]] HaplyAddress parse_haply_address(const std::string& text);

/// The connection cannot be made, or has ended; what() says why in words, without the address.
class HaplyLinkError final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One WebSocket to the service. Whatever it waits for has a time limit, and a message a greatest size, so
/// that a server cannot make it hang or fill the memory. For one thread at a time; never for the tick.
class HaplyLink final {
 public:
  static constexpr std::size_t kLargestMessage = std::size_t{1} << 20;  // bytes
  static constexpr std::int64_t kOpeningLimit = 3'000'000'000;  // ns, for the handshake and what is before it

  /// [setup] Looks the host's name up, once: later openings ask no name server.
  /// @param give_up ends every wait early when another thread sets it
  /// @throws HaplyLinkError when there is no such host.
  HaplyLink(const HaplyAddress& address, const std::atomic<bool>& give_up);
  ~HaplyLink();
  HaplyLink(const HaplyLink&) = delete;
  HaplyLink& operator=(const HaplyLink&) = delete;

  /// Connects and shakes hands, within `limit_ns`. @throws HaplyLinkError; it is closed then.
  void open(std::int64_t limit_ns = kOpeningLimit);
  [[nodiscard]] bool is_open() const noexcept;

  /// Begins to send a message; only when sending() is false. @throws HaplyLinkError when the last one failed.
  void send(std::string message);
  /// Whether a message is still on its way into the system's buffers.
  [[nodiscard]] bool sending() const noexcept;
  /// The next message that has come, if there is one. @throws HaplyLinkError when the connection has ended.
  [[nodiscard]] std::optional<std::string> received();
  /// Sleeps until something has come or gone, or until that monotonic time [ns].
  void wait_until(std::int64_t deadline_ns);

  /// Ends the connection as the protocol wants it, within `limit_ns`, else at once as drop() does.
  void close(std::int64_t limit_ns) noexcept;
  /// Ends the connection without a word.
  void drop() noexcept;

 private:
  class Socket;
  std::unique_ptr<Socket> socket_;
};

}  // namespace palpate::devices
