#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "net/live_messages.h"
#include "net/live_protocol.h"

namespace palpate::net {

/// A client and its message, to which an answer is sent later.
struct ClientRef {
  std::uint64_t client = 0;
  LiveReference reference;
};

/// A message that the host sends by itself: a late answer to one client, or an event to all.
struct Event {
  std::optional<ClientRef> to;                    // none: all
  std::string name;                               // of the event; empty: an answer
  nlohmann::ordered_json members;                 // of the answer or event
  std::optional<LiveError> error = std::nullopt;  // in place of an answer
};

/// Runs the scenes that a server's clients control. All members: [setup], on the server's thread; each must
/// return quickly.
class RunService {
 public:
  virtual ~RunService() = default;
  /// Executes a command (except hello, version, state and stream, which the server executes). @return the
  /// members of the answer; nothing when poll() returns the answer later @throws InputError, LiveError:
  /// sent to the client; the command then has no effect.
  virtual std::optional<nlohmann::ordered_json> answer(const LiveCommand& command,
                                                       const ClientRef& client) = 0;
  /// Description of the newest run, for the answer to `state`.
  [[nodiscard]] virtual nlohmann::ordered_json about_run() = 0;
  /// The newest tick of the newest run; its `tick` is null before the first.
  [[nodiscard]] virtual LiveState newest() = 0;
  /// Called every LiveServer::kPollPeriodMs. @param clients number of authenticated clients; at least 1 if
  /// one connected since the last call, even if it has left
  virtual std::vector<Event> poll(std::size_t clients) = 0;
};

/// A file for browsers.
struct PageFile {
  std::string type;  // media type
  std::string bytes;
};

struct LiveOptions {
  std::string address = "127.0.0.1";              // numeric; "localhost" means 127.0.0.1
  std::uint16_t port = 0;                         // 0: the system chooses
  std::string token;                              // required in the hello of a client; empty: none
  std::vector<std::string> origins;               // allowed origins of web pages, besides the server's own
  std::map<std::string, PageFile> page;           // files for browsers by their path: "/", "/a/b.js"
  std::function<void(const std::string&)> log{};  // gets one line for a refused connection: who and why
};

/// Statistics of a server.
struct LiveStatistics {
  std::uint64_t connections = 0;
  std::uint64_t refused = 0;  // rejected or dropped connections, and clients without the token
  std::uint64_t messages = 0;
  std::uint64_t errors = 0;  // messages answered with an error
  std::uint64_t frames = 0;
  std::uint64_t left_out = 0;  // dropped frames, because clients were too slow
};

/// The live interface: a WebSocket server for several clients (docs/live-interface.md) on one thread, never
/// the haptic loop's.
class LiveServer final {
 public:
  static constexpr std::size_t kMaxClients = 16;  // clients after their "hello"
  // Limits of connections without a "hello", per address and in total. One more drops the oldest, so that
  // silent connections block nobody.
  static constexpr std::size_t kMaxPendingPerAddress = 16;
  static constexpr std::size_t kMaxPending = 64;
  static constexpr int kPollPeriodMs = 10;

  /// [setup] Listens; connections are answered during run(). @param service outlives this
  /// @throws InputError when the address is invalid, not local although no token is set, or in use, or when
  /// an origin is invalid.
  LiveServer(const LiveOptions& options, RunService& service);
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// [any] The address at which it listens, as in a URL: "127.0.0.1", "[::1]".
  [[nodiscard]] std::string host() const;
  [[nodiscard]] std::uint16_t port() const;
  /// [setup] Serves on this thread until `stop` is set, then closes all connections.
  void run(const std::atomic<bool>& stop);
  /// [setup] After run().
  [[nodiscard]] const LiveStatistics& statistics() const noexcept;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace palpate::net
