#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "net/live_messages.h"
#include "net/live_protocol.h"

namespace palpate::net {

/// Who asked: the client's number and its message.
struct Asker {
  std::uint64_t client = 0;
  LiveReference reference;
};

/// Something that a host has to say without being asked: a late answer to one client, or an event to all.
struct News {
  std::optional<Asker> to;                        // none: all
  std::string event;                              // its name, of an event
  nlohmann::ordered_json members;                 // of the answer or event
  std::optional<LiveError> error = std::nullopt;  // in place of an answer
};

/// What plays the scenes that a server's clients drive. All members: [setup], the server's thread; none may
/// take long.
class LiveHost {
 public:
  virtual ~LiveHost() = default;
  /// Does a command (not hello, version, state or stream: they are the server's). @return the members of the
  /// answer; nothing when it comes later as news @throws InputError, LiveError: the client is told, and
  /// nothing has changed.
  virtual std::optional<nlohmann::ordered_json> answer(const LiveCommand& command, const Asker& asker) = 0;
  /// What the newest run is about, for the answer to `state`.
  [[nodiscard]] virtual nlohmann::ordered_json about_run() = 0;
  /// The newest tick of the newest run; its `tick` is null before the first.
  [[nodiscard]] virtual LiveState newest() = 0;
  /// Called every LiveServer::kLookAfterMs. @param clients that have said hello; one that came and went since
  /// the last call counts this once
  virtual std::vector<News> look_after(std::size_t clients) = 0;
};

struct LiveOptions {
  std::string address = "127.0.0.1";              // a number, not a name; "localhost" is taken as 127.0.0.1
  std::uint16_t port = 0;                         // 0: the system chooses
  std::string token;                              // what a client's hello must have; empty: none is asked for
  std::vector<std::string> origins;               // of web pages, beside the server's own
  std::string page;                               // HTML that a browser gets; empty: there is none
  std::function<void(const std::string&)> log{};  // gets one line for a refused connection: who and why
};

/// What a server has seen.
struct LiveAccount {
  std::uint64_t connections = 0;
  std::uint64_t refused =
      0;  // connections that were not let in or were dropped, and clients without the token
  std::uint64_t messages = 0;
  std::uint64_t errors = 0;  // messages answered with an error
  std::uint64_t frames = 0;
  std::uint64_t left_out = 0;  // frames that clients were too slow for
};

/// The live interface: a WebSocket server for several clients (docs/live-interface.md), on one thread, which
/// never is the haptic loop's.
class LiveServer final {
 public:
  static constexpr std::size_t kMostClients = 16;  // that have said hello
  // Connections that have not said hello: from one address, and in all. With one more the oldest is dropped,
  // so that strangers who connect and say nothing lock nobody out.
  static constexpr std::size_t kMostStrangersOfPeer = 16;
  static constexpr std::size_t kMostStrangers = 64;
  static constexpr int kLookAfterMs = 10;

  /// [setup] Listens; nobody is answered before run(). @param host outlives this
  /// @throws InputError when the address is none, beyond this machine without a token, or cannot be listened
  /// at, or an origin is none.
  LiveServer(const LiveOptions& options, LiveHost& host);
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// [any] Where it listens; as in a URL: "127.0.0.1", "[::1]".
  [[nodiscard]] std::string host() const;
  [[nodiscard]] std::uint16_t port() const;
  /// [setup] Serves on this thread until `stop` is set; then clients are told, and are let go.
  void run(const std::atomic<bool>& stop);
  /// [setup] After run().
  [[nodiscard]] const LiveAccount& account() const noexcept;

 private:
  class Desk;
  std::unique_ptr<Desk> desk_;
};

}  // namespace palpate::net
