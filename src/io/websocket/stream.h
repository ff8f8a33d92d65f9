#pragma once
// Boost.Beast, for the sources of this module alone: it takes long to compile.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>  // before Asio: Asio 1.74 does not include it

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

namespace palpate::websocket {

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

/// Both sides of a connection use this type, so that its templates are compiled once.
using Stream = boost::beast::websocket::stream<
    boost::beast::basic_stream<boost::asio::ip::tcp, boost::beast::tcp_stream::executor_type, ReadCount>>;

}  // namespace palpate::websocket
