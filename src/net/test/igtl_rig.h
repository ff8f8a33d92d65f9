#pragma once
// Fixtures for tests of the server: organs, loops that publish, and clients.
#include <atomic>
#include <chrono>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <netinet/in.h>
#include <sys/socket.h>

#include "net/igtl_server.h"
#include "net/test/igtl_received.h"
#include "palpate/mesh.h"

namespace palpate::net::test {

inline const IgtlAddress kAnyFreePort{"127.0.0.1", 0};

/// A client with the system's own sockets, for behaviour that the library's client does not have.
class BareClient final {
 public:
  explicit BareClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const int small = 4096;  // bytes: a buffer that is full soon
    (void)setsockopt(handle(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(static_cast<std::uint16_t>(port));
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(handle(), reinterpret_cast<const sockaddr*>(&where), sizeof where) == 0;
  }
  [[nodiscard]] bool connected() const { return connected_; }
  /// Receives at most `most` bytes. @return their number; 0 at the end of the stream
  [[nodiscard]] ssize_t receive(std::size_t most) {
    Bytes bytes(most);
    return recv(handle(), bytes.data(), bytes.size(), 0);
  }
  /// Sends the bytes that the system takes without a wait. @return their number
  std::size_t send_what_goes(const Bytes& bytes) {
    const ssize_t sent = send(handle(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return sent < 0 ? 0 : static_cast<std::size_t>(sent);
  }
  /// Receives all bytes that have arrived.
  void receive_what_is_there() {
    Bytes bytes(1 << 16);
    while (recv(handle(), bytes.data(), bytes.size(), MSG_DONTWAIT) > 0) continue;
  }
  void send_no_more() { (void)shutdown(handle(), SHUT_WR); }

 private:
  [[nodiscard]] int handle() const { return static_cast<int>(socket_.handle()); }

  Socket socket_;
  bool connected_ = false;
};

inline scene::Scene block_setup() {
  scene::Scene scene;
  scene.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  scene.organ_pose.position = Vec3(0, 0, -0.02);
  return scene;
}

/// The block with a mesh so fine that its surface message has several MB, more than the system's buffers
/// take.
inline scene::Scene large_setup() {
  scene::Scene scene = block_setup();
  scene.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.0005);
  return scene;
}

/// Publishes a tick as the loop does. Its pose and force contain its number.
inline void publish(IgtlServer& server, std::uint64_t tick) {
  haptics::Snapshot snapshot;
  snapshot.tick = tick;
  snapshot.hands = 1;
  snapshot.tools[0].pose_W.position = Vec3(1e-6 * static_cast<double>(tick), 0, 0.05);
  snapshot.commands[0].force = Vec3(0, 0, static_cast<double>(tick));
  snapshot.results[0].distance = 0.01;
  server.publish(snapshot);
}

/// A loop that publishes every millisecond until it is destroyed.
class Publisher final {
 public:
  explicit Publisher(IgtlServer& server)
      : thread_([this, &server] {
          for (std::uint64_t tick = 1; !stop_.load(); ++tick) {
            publish(server, tick);
            ticks_.store(tick);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
          }
        }) {}
  ~Publisher() {
    stop_.store(true);
    thread_.join();
  }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;
  [[nodiscard]] std::uint64_t ticks() const { return ticks_.load(); }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> ticks_{0};
  std::thread thread_;
};

/// Reads on another thread until the stream ends. The result is the last message of each name.
using Newest = std::map<std::string, Received>;
inline std::future<Newest> newest_of(Client& client) {
  return std::async(std::launch::async, [&client] {
    Newest newest;
    while (std::optional<Received> received = client.next()) newest[received->name] = *received;
    return newest;
  });
}

inline std::unique_ptr<IgtlStream> block_stream() { return std::make_unique<IgtlStream>(block_setup()); }

}  // namespace palpate::net::test
