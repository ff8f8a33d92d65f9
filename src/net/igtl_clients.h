#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "net/igtl_messages.h"

namespace palpate::net {

/// Where a server listens.
struct IgtlAddress {
  std::string host = "127.0.0.1";  // IPv4 in numbers, one of this machine's; 0.0.0.0: all of them
  int port = 0;                    // 0: any that is free
};

/// [setup] Takes "PORT" or "ADDRESS:PORT" apart. @throws InputError naming --igtl and what would be right.
[[nodiscard]] IgtlAddress parse_igtl_address(const std::string& text);

/// A file descriptor that is closed with it.
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

/// The newest of one kind of thing that is sent. Its number rises with each; a client gets each at most once.
struct IgtlChannel {
  Bytes bytes;               // whole messages; empty: none
  std::uint64_t number = 0;  // 0: there was none yet
};

inline constexpr std::size_t kIgtlChannels = 4;
inline constexpr std::size_t kPoseChannel = 0;    // its frames are counted when they are left out
inline constexpr std::size_t kSensorChannel = 1;  // 3D Slicer does not get it
inline constexpr std::size_t kWordsChannel = 2;
inline constexpr std::size_t kSurfaceChannel = 3;
using IgtlChannels = std::array<IgtlChannel, kIgtlChannels>;

/// How serving went.
struct IgtlTally {
  std::uint64_t clients = 0;          // that were let in
  std::uint64_t refused = 0;          // that found all places taken
  std::uint64_t given_up = 0;         // that took nothing for so long that they were let go
  std::uint64_t frames = 0;           // of the poses, sent, over all clients
  std::uint64_t frames_left_out = 0;  // that a client was too slow for
  std::string failure;                // why serving ended early, in words; empty: it did not
};

/// The clients of a server, all on one thread. No call waits for a client: what one cannot take at once is
/// sent on when it can, and meanwhile it is offered nothing new. So a slow client gets the newest of each
/// channel, fewer times. What clients send is read, so that it does not pile up, and thrown away, but for
/// this: a client whose first message is a STATUS without a name is 3D Slicer's connector (or another of
/// OpenIGTLinkIO), which knows no SENSOR and would log an error for each, so it gets none.
/// All members: [setup], one thread.
class IgtlClients final {
 public:
  struct Limits {
    std::size_t most_clients = 16;
    std::int64_t patience_ns = 5'000'000'000;  // a client that takes nothing for so long is let go
  };

  /// Listens. @throws InputError in words when the port is taken, not allowed, or the address not this
  /// machine's.
  IgtlClients(const IgtlAddress& address, const Limits& limits);

  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] bool none() const noexcept { return clients_.empty(); }
  /// Whether one has not taken yet what it was offered.
  [[nodiscard]] bool busy() const noexcept;
  [[nodiscard]] const IgtlTally& tally() const noexcept { return tally_; }

  /// Lets in who waits, reads and forgets what clients sent, lets those go that are gone or stand still.
  void look_after();
  /// Begins to send every client that is not busy what it has not had yet.
  void offer(const IgtlChannels& channels);
  /// Sends on until that monotonic time [ns], or until `wake` can be read.
  void send_until(std::int64_t deadline_ns, int wake);
  /// Ends every connection, and listens no more.
  void close_all();

 private:
  static constexpr std::size_t kHeadBytes = 34;  // of a message: version 2, type 12, name 20

  struct Client {
    explicit Client(Descriptor connection) noexcept : socket(std::move(connection)) {}
    Descriptor socket;
    std::array<std::uint64_t, kIgtlChannels> had{};  // the last number of each channel
    Bytes pending;
    std::size_t sent = 0;                          // of pending
    std::int64_t last_progress_ns = 0;             // when it last took something, or had taken all
    std::array<unsigned char, kHeadBytes> head{};  // what it sent first
    std::size_t head_bytes = 0;
    bool talks = true;  // may still send something
    bool is_slicer = false;
    bool gone = false;
    [[nodiscard]] bool busy() const noexcept { return sent < pending.size(); }
  };

  void let_in();
  static void read_and_forget(Client& client);
  static void recognise(Client& client, std::span<const unsigned char> received);
  static void send_on(Client& client);
  void fill(Client& client, const IgtlChannels& channels);
  void forget_the_gone();

  Limits limits_;
  Descriptor listener_;
  int port_ = 0;
  std::vector<Client> clients_;
  IgtlTally tally_;
};

}  // namespace palpate::net
