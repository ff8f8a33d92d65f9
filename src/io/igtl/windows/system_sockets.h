#pragma once
// The sockets of Windows, for igtl_socket.cc.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <winsock2.h>
#include <ws2tcpip.h>

#include "io/system/clock.h"

namespace palpate::net {

using SocketHandle = SOCKET;
using ByteCount = int;
using pollfd = WSAPOLLFD;

// With SO_REUSEADDR a second program could take over a port that a first one listens at.
inline constexpr int kListenOption = SO_EXCLUSIVEADDRUSE;
inline constexpr int kSendFlags = 0;
inline constexpr int kEndSending = SD_SEND;

inline constexpr int kPortTaken = WSAEADDRINUSE;
inline constexpr int kNotPermitted = WSAEACCES;
inline constexpr const char* kNotPermittedText =
    "Windows reserves that port; choose another one (netsh interface ipv4 show excludedportrange tcp)";
inline constexpr int kNoSuchAddress = WSAEADDRNOTAVAIL;

inline int socket_error() noexcept { return WSAGetLastError(); }
inline bool would_wait(int error) noexcept { return error == WSAEWOULDBLOCK; }
inline std::string describe_socket_error(int error) {
  if (error == WSAECONNRESET) return "Connection reset by peer";
  if (error == WSAECONNABORTED) return "Connection aborted by this computer";
  if (error == WSAETIMEDOUT) return "Connection timed out";
  return "Windows' error " + std::to_string(error);
}

/// Makes the calls of a socket not wait.
inline SocketHandle without_wait(SocketHandle socket) noexcept {
  unsigned long on = 1;
  if (socket != INVALID_SOCKET) (void)::ioctlsocket(socket, static_cast<long>(FIONBIO), &on);
  return socket;
}
inline SocketHandle open_socket() noexcept {
  WSADATA ignored{};
  [[maybe_unused]] static const int started = WSAStartup(MAKEWORD(2, 2), &ignored);
  return without_wait(
      ::WSASocketW(AF_INET, SOCK_STREAM, 0, nullptr, 0, WSA_FLAG_OVERLAPPED | WSA_FLAG_NO_HANDLE_INHERIT));
}
/// An accepted socket has the listener's properties.
inline SocketHandle accept_socket(SocketHandle listener) noexcept {
  return without_wait(::accept(listener, nullptr, nullptr));
}
inline void close_socket(SocketHandle socket) noexcept { (void)::closesocket(socket); }

/// Windows counts milliseconds; the last one is rounded up, so that no thread polls without a wait.
inline void poll_sockets(std::vector<pollfd>& sockets, std::int64_t deadline_ns) noexcept {
  constexpr std::int64_t kMillisecond = 1'000'000;  // ns
  const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - monotonic_ns());
  (void)::WSAPoll(sockets.data(), static_cast<ULONG>(sockets.size()),
                  static_cast<int>((left + kMillisecond - 1) / kMillisecond));
}

}  // namespace palpate::net
