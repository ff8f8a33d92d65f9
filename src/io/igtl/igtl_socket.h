#pragma once
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

/// Owns a file descriptor and closes it.
class Descriptor final {
 public:
  explicit Descriptor(int number) noexcept : number_(number) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  int number_;
};

/// [setup] Listens for TCP connections; accepting does not wait. @param who begins the message, "--igtl"
/// @throws InputError when the port is in use or not permitted, or the address is not this machine's.
[[nodiscard]] Descriptor listen_at(const IgtlAddress& address, const std::string& who = "--igtl");

/// [setup] The port of a socket that listens.
[[nodiscard]] int port_of(const Descriptor& listener);

/// [any] Accepts a waiting connection, without Nagle's delay; its calls do not block. The descriptor is
/// negative if no connection waits.
/// @param send_buffer bytes that the system keeps for the client
[[nodiscard]] Descriptor accept_from(const Descriptor& listener, int send_buffer);

}  // namespace palpate::net
