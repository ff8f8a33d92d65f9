#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/igtl/igtl_messages.h"
#include "io/igtl/igtl_socket.h"

namespace palpate::net {

/// The newest data of one kind. Its number rises with each update; a client gets each number at most once.
struct IgtlChannel {
  Bytes bytes;               // complete messages; empty: none
  std::uint64_t number = 0;  // 0: no data yet
};

inline constexpr std::size_t kIgtlChannels = 4;
inline constexpr std::size_t kPoseChannel = 0;    // dropped frames of this channel are counted
inline constexpr std::size_t kSensorChannel = 1;  // 3D Slicer does not get it
inline constexpr std::size_t kStatusChannel = 2;
inline constexpr std::size_t kSurfaceChannel = 3;
using IgtlChannels = std::array<IgtlChannel, kIgtlChannels>;

/// Statistics of a server.
struct IgtlStatistics {
  std::uint64_t clients = 0;          // accepted
  std::uint64_t refused = 0;          // rejected, because the limit of clients was reached
  std::uint64_t given_up = 0;         // disconnected, because they read nothing for Limits::send_timeout_ns
  std::uint64_t frames = 0;           // pose frames sent, over all clients
  std::uint64_t frames_left_out = 0;  // pose frames dropped, because a client was too slow
  std::string failure;                // why the server ended early; empty: it did not
};

/// The clients of a server, on one thread. No call waits for a client. A client that is still receiving gets
/// nothing new, so a slow client gets the newest data of each channel at a lower rate. Data from clients is
/// read and discarded. One exception: if the first message is a STATUS without a name, the client is 3D
/// Slicer's connector (or another of OpenIGTLinkIO). It gets no SENSOR messages, because it logs an error for
/// each. All members: [setup], one thread.
class IgtlClients final {
 public:
  struct Limits {
    std::size_t most_clients = 16;
    std::int64_t send_timeout_ns = 5'000'000'000;  // ns without any read until a client is disconnected
  };

  /// Listens. @throws InputError when the port is in use or not permitted, or the address is not this
  /// machine's.
  IgtlClients(const IgtlAddress& address, const Limits& limits);

  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] bool none() const noexcept { return clients_.empty(); }
  /// Whether a client has not yet received all that was offered.
  [[nodiscard]] bool busy() const noexcept;
  [[nodiscard]] const IgtlStatistics& statistics() const noexcept { return statistics_; }

  /// Accepts new clients, discards what clients sent, removes closed and stalled clients.
  void poll();
  /// Starts to send new channel data to every client that is not busy.
  void offer(const IgtlChannels& channels);
  /// Continues sending until that monotonic time [ns].
  void send_until(std::int64_t deadline_ns);
  /// Closes all connections and stops listening.
  void close_all();

 private:
  static constexpr std::size_t kHeadBytes = 34;  // start of a message header: version 2, type 12, name 20

  struct Client {
    explicit Client(Socket connection) noexcept : socket(std::move(connection)) {}
    Socket socket;
    std::array<std::uint64_t, kIgtlChannels> had{};  // last number sent of each channel
    Bytes pending;
    std::size_t sent = 0;                          // of pending
    std::int64_t last_progress_ns = 0;             // when it last received data, or had received all
    std::array<unsigned char, kHeadBytes> head{};  // first bytes that the client sent
    std::size_t head_bytes = 0;
    bool talks = true;  // false: the client has closed its sending side
    bool is_slicer = false;
    bool gone = false;
    [[nodiscard]] bool busy() const noexcept { return sent < pending.size(); }
  };

  void let_in();
  static void discard_input(Client& client);
  static void recognise(Client& client, std::span<const unsigned char> received);
  static void send_on(Client& client);
  void fill(Client& client, const IgtlChannels& channels);
  void remove_closed();

  Limits limits_;
  Socket listener_;
  int port_ = 0;
  std::vector<Client> clients_;
  IgtlStatistics statistics_;
};

}  // namespace palpate::net
