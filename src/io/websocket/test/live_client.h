#pragma once
// Clients of the live interface for tests. Every wait for a WebSocket has a time limit.
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace palpate::net::test {

class LiveClient final {
 public:
  using Json = nlohmann::json;

  struct Knock {
    std::string origin;        // empty: the request states none
    std::string target = "/";  // of the request
    int receive_buffer = 0;    // bytes; 0: the system's choice
  };

  explicit LiveClient(std::uint16_t port);
  LiveClient(std::uint16_t port, const Knock& knock);
  ~LiveClient();

  [[nodiscard]] bool open() const;
  /// HTTP status of the server's answer. It is 101 when the server accepted the client.
  [[nodiscard]] unsigned status() const;
  /// Code with which the server closed the connection.
  [[nodiscard]] int close_code() const;

  void say(const std::string& text, bool binary = false);
  /// Sends raw bytes on the socket, such as frames that no WebSocket library makes. @return whether the
  /// connection is open
  bool say_raw(const std::string& bytes);
  /// Next message. Empty when the connection has ended instead.
  std::optional<Json> hear();
  /// First message that `wanted` accepts, of at most 100,000. Null when the connection ends first.
  Json hear_until(const std::function<bool(const Json&)>& wanted);
  /// Sends a message and reads until the answer to it.
  Json ask(const std::string& text);
  Json greet(const std::string& token = "");
  /// Closes the socket without a WebSocket close.
  void vanish();

 private:
  class Socket;
  std::unique_ptr<Socket> socket_;
};

/// The server's answer to an HTTP request.
struct HttpAnswer {
  unsigned status = 0;
  std::map<std::string, std::string> fields;
  std::string body;
};
HttpAnswer http_get(std::uint16_t port, const std::string& target);

}  // namespace palpate::net::test
