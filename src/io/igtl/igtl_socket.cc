#include "io/igtl/igtl_socket.h"

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "palpate/error.h"

namespace palpate::net {
namespace {

constexpr int kLargestPort = 65535;

InputError wrong_address(const std::string& who, const std::string& text, const std::string& why) {
  return InputError(fmt::format("{} {}: {}", who, text, why));
}

void set_option(int socket, int level, int name, int value) {
  (void)setsockopt(socket, level, name, &value, sizeof value);
}

sockaddr_in socket_address(const IgtlAddress& address, const std::string& who) {
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(static_cast<std::uint16_t>(address.port));
  if (inet_pton(AF_INET, address.host.c_str(), &where.sin_addr) != 1) {
    throw wrong_address(who, address.host, "no address such as 127.0.0.1 or 0.0.0.0");
  }
  return where;
}

/// Describes why the server cannot listen at a port.
std::string describe(int error, const IgtlAddress& address) {
  switch (error) {
    case EADDRINUSE:
      return "the port is taken by another program; choose another port";
    case EACCES:
      return "this user may not listen at that port; choose one from 1024 on";
    case EADDRNOTAVAIL:
      return "this machine has no address " + address.host +
             "; 127.0.0.1 is this machine alone, 0.0.0.0 all its addresses";
    default:
      return std::string("the port cannot be listened at: ") + std::strerror(error);
  }
}

}  // namespace

Descriptor::~Descriptor() {
  if (number_ >= 0) close(number_);
}

IgtlAddress parse_igtl_address(const std::string& text, const std::string& who) {
  const std::string want =
      "must be a port from 1 to 65535, or an address of this machine and a port, as in 0.0.0.0:18944";
  IgtlAddress address;
  const std::size_t colon = text.rfind(':');
  if (colon != std::string::npos) address.host = text.substr(0, colon);
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  const char* end = digits.data() + digits.size();
  const auto [stopped_at, error] = std::from_chars(digits.data(), end, address.port);
  if (error != std::errc() || stopped_at != end || address.port < 1 || address.port > kLargestPort) {
    throw wrong_address(who, text, want);
  }
  in_addr ignored{};
  if (inet_pton(AF_INET, address.host.c_str(), &ignored) != 1) throw wrong_address(who, text, want);
  return address;
}

Descriptor listen_at(const IgtlAddress& address, const std::string& who) {
  const sockaddr_in where = socket_address(address, who);
  Descriptor listener(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  set_option(listener.number(), SOL_SOCKET, SO_REUSEADDR, 1);  // the port of a previous run is free at once
  if (listener.number() < 0 ||
      bind(listener.number(), reinterpret_cast<const sockaddr*>(&where), sizeof where) != 0 ||
      listen(listener.number(), SOMAXCONN) != 0) {
    throw wrong_address(who, address.text(), describe(errno, address));
  }
  return listener;
}

int port_of(const Descriptor& listener) {
  sockaddr_in where{};
  socklen_t size = sizeof where;
  (void)getsockname(listener.number(), reinterpret_cast<sockaddr*>(&where), &size);
  return ntohs(where.sin_port);
}

Descriptor accept_from(const Descriptor& listener, int send_buffer) {
  Descriptor socket(accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (socket.number() < 0) return socket;
  set_option(socket.number(), IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(socket.number(), SOL_SOCKET, SO_SNDBUF, send_buffer);
  return socket;
}

}  // namespace palpate::net
