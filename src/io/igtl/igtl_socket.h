#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace palpate::net {

/// Address at which a program listens.
struct IgtlAddress {
  std::string host = "127.0.0.1";  // numeric IPv4 address of this machine; 0.0.0.0: all addresses
  int port = 0;                    // 0: any free port

  [[nodiscard]] std::string text() const { return host + ":" + std::to_string(port); }
};

/// [setup] Parses "PORT" or "ADDRESS:PORT". @param who begins the message, "--igtl"
/// @throws InputError naming the required form.
[[nodiscard]] IgtlAddress parse_igtl_address(const std::string& text, const std::string& who = "--igtl");

/// Owns a TCP socket of the system, whose calls do not wait, and closes it.
class Socket final {
 public:
  Socket() = default;
  explicit Socket(std::intptr_t handle) noexcept : handle_(handle) {}
  ~Socket();
  Socket(Socket&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  [[nodiscard]] bool is_open() const noexcept { return handle_ != -1; }
  [[nodiscard]] std::intptr_t handle() const noexcept { return handle_; }

 private:
  std::intptr_t handle_ = -1;
};

/// [setup] Listens for TCP connections. @param who begins the message, "--igtl"
/// @throws InputError when the port is in use or not permitted, or the address is not this machine's.
[[nodiscard]] Socket listen_at(const IgtlAddress& address, const std::string& who = "--igtl");

/// [setup] The port of a socket that listens.
[[nodiscard]] int port_of(const Socket& listener);

/// [any] Accepts a waiting connection, without Nagle's delay. The socket is not open if no connection waits.
/// @param send_buffer bytes that the system keeps for the client
[[nodiscard]] Socket accept_from(const Socket& listener, int send_buffer);

/// What a call sent or received without a wait.
struct Transfer {
  std::size_t bytes = 0;
  bool ended = false;  // the other side has ended its sending; it may still receive
  std::string broken;  // why the connection is broken; empty: it is not
};

/// [any] Receives bytes that have arrived.
[[nodiscard]] Transfer receive_from(const Socket& socket, std::span<unsigned char> bytes);
/// [any] Sends what the system takes. A broken connection raises no signal.
[[nodiscard]] Transfer send_to(const Socket& socket, std::span<const unsigned char> bytes);
/// [any] Ends the sending; the socket may still receive.
void end_sending(const Socket& socket) noexcept;

/// A socket that a thread waits for.
struct Awaited {
  const Socket& socket;  // ignored if it is not open
  bool to_send = false;  // false: to receive or to accept
};

/// [any] Waits until one of the sockets is ready, or until a monotonic time [ns].
void wait_for(std::span<const Awaited> sockets, std::int64_t deadline_ns);

}  // namespace palpate::net
