#include "io/igtl/igtl_socket.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include <fmt/core.h>

#include "io/system/clock.h"
#include "palpate/error.h"

#include "system_sockets.h"

namespace palpate::net {
namespace {

constexpr int kLargestPort = 65535;

InputError wrong_address(const std::string& who, const std::string& text, const std::string& why) {
  return InputError(fmt::format("{} {}: {}", who, text, why));
}

/// The number of bytes of one call. Windows counts them by an int.
ByteCount count_of(std::size_t bytes) noexcept {
  return static_cast<ByteCount>(std::min(bytes, std::size_t{1} << 30U));
}

SocketHandle handle_of(const Socket& socket) noexcept { return static_cast<SocketHandle>(socket.handle()); }

Socket socket_of(SocketHandle handle) noexcept { return Socket(static_cast<std::intptr_t>(handle)); }

void set_option(const Socket& socket, int level, int name, int value) {
  (void)setsockopt(handle_of(socket), level, name, reinterpret_cast<const char*>(&value), sizeof value);
}

/// @param result of a call that sent or received: a number of bytes; negative: failed
Transfer transfer_of(std::ptrdiff_t result) {
  if (result >= 0) return {static_cast<std::size_t>(result), false, {}};
  const int error = socket_error();
  return {0, false, would_wait(error) ? std::string() : describe_socket_error(error)};
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
  if (error == kPortTaken) return "the port is taken by another program; choose another port";
  if (error == kNotPermitted) return kNotPermittedText;
  if (error == kNoSuchAddress) {
    return "this machine has no address " + address.host +
           "; 127.0.0.1 is this machine alone, 0.0.0.0 all its addresses";
  }
  return "the port cannot be listened at: " + describe_socket_error(error);
}

}  // namespace

Socket::~Socket() {
  if (is_open()) close_socket(handle_of(*this));
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

Socket listen_at(const IgtlAddress& address, const std::string& who) {
  const sockaddr_in where = socket_address(address, who);
  Socket listener = socket_of(open_socket());
  set_option(listener, SOL_SOCKET, kListenOption, 1);
  const SocketHandle handle = handle_of(listener);
  if (!listener.is_open() || bind(handle, reinterpret_cast<const sockaddr*>(&where), sizeof where) != 0 ||
      listen(handle, SOMAXCONN) != 0) {
    throw wrong_address(who, address.text(), describe(socket_error(), address));
  }
  return listener;
}

int port_of(const Socket& listener) {
  sockaddr_in where{};
  socklen_t size = sizeof where;
  (void)getsockname(handle_of(listener), reinterpret_cast<sockaddr*>(&where), &size);
  return ntohs(where.sin_port);
}

Socket accept_from(const Socket& listener, int send_buffer) {
  Socket socket = socket_of(accept_socket(handle_of(listener)));
  if (!socket.is_open()) return socket;
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(socket, SOL_SOCKET, SO_SNDBUF, send_buffer);
  return socket;
}

Transfer receive_from(const Socket& socket, std::span<unsigned char> bytes) {
  const std::ptrdiff_t got =
      recv(handle_of(socket), reinterpret_cast<char*>(bytes.data()), count_of(bytes.size()), 0);
  Transfer received = transfer_of(got);
  received.ended = got == 0;
  return received;
}

Transfer send_to(const Socket& socket, std::span<const unsigned char> bytes) {
  return transfer_of(send(handle_of(socket), reinterpret_cast<const char*>(bytes.data()),
                          count_of(bytes.size()), kSendFlags));
}

void end_sending(const Socket& socket) noexcept { (void)shutdown(handle_of(socket), kEndSending); }

void wait_for(std::span<const Awaited> sockets, std::int64_t deadline_ns) {
  std::vector<pollfd> polled;
  for (const Awaited& awaited : sockets) {
    if (!awaited.socket.is_open()) continue;
    polled.push_back({handle_of(awaited.socket), awaited.to_send ? short{POLLOUT} : short{POLLIN}, 0});
  }
  if (polled.empty()) return sleep_until_ns(deadline_ns);  // Windows cannot wait for no socket
  poll_sockets(polled, deadline_ns);
}

}  // namespace palpate::net
