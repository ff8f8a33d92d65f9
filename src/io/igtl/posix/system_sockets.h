#pragma once
// The sockets of POSIX systems, for igtl_socket.cc.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "io/system/clock.h"

namespace palpate::net {

using SocketHandle = int;
using ByteCount = std::size_t;

inline constexpr int kListenOption = SO_REUSEADDR;  // the port of a previous run is free at once
inline constexpr int kSendFlags = MSG_NOSIGNAL;
inline constexpr int kEndSending = SHUT_WR;

inline constexpr int kPortTaken = EADDRINUSE;
inline constexpr int kNotPermitted = EACCES;
inline constexpr const char* kNotPermittedText =
    "this user may not listen at that port; choose one from 1024 on";
inline constexpr int kNoSuchAddress = EADDRNOTAVAIL;

inline int socket_error() noexcept { return errno; }
/// Whether a call failed only because it would have waited.
inline bool would_wait(int error) noexcept { return error == EAGAIN || error == EINTR; }
inline std::string describe_socket_error(int error) { return std::strerror(error); }

/// [setup] A TCP socket that child programs do not inherit and whose calls do not wait.
inline SocketHandle open_socket() noexcept {
  return ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
}
inline SocketHandle accept_socket(SocketHandle listener) noexcept {
  return ::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
}
inline void close_socket(SocketHandle socket) noexcept { (void)::close(socket); }

/// Waits until a socket is ready or until a monotonic time [ns].
inline void poll_sockets(std::vector<pollfd>& sockets, std::int64_t deadline_ns) noexcept {
  const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - monotonic_ns());
  const timespec limit{left / 1'000'000'000, left % 1'000'000'000};
  (void)::ppoll(sockets.data(), sockets.size(), &limit, nullptr);
}

}  // namespace palpate::net
