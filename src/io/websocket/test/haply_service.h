#pragma once
// A stand-in for Haply's Inverse Service on 127.0.0.1. A test can switch each fault on.
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "palpate/pose.h"

namespace palpate::devices::test {

/// JSON of a vector, of one arm and of one grip in a message.
inline nlohmann::json vector_json(const Vec3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }
inline nlohmann::json arm_json(const std::string& id, const Vec3& position,
                               const Vec3& velocity = Vec3::Zero()) {
  return {{"device_id", id},
          {"state", {{"cursor_position", vector_json(position)}, {"cursor_velocity", vector_json(velocity)}}},
          {"status", {{"power_supply", true}, {"ready", true}}}};
}
inline nlohmann::json grip_json(const std::string& id, const Quat& q, bool a) {
  return {{"device_id", id},
          {"state",
           {{"orientation", {{"w", q.w()}, {"x", q.x()}, {"y", q.y()}, {"z", q.z()}}},
            {"buttons", {{"a", a}, {"b", false}, {"c", false}}}}}};
}
/// A message with one arm, "04BA".
inline std::string one_arm(const Vec3& position = Vec3(0.01, 0.02, 0.03)) {
  return nlohmann::json{{"inverse3", {arm_json("04BA", position)}}}.dump();
}

/// The service's answer to a command.
struct Answer {
  std::optional<std::string> text;  // empty: no answer
  enum class Then { kGoOn, kClose, kBreakOff } then = Then::kGoOn;
};

class HaplyService final {
 public:
  enum class Manner { kWebSocket, kDeclines, kMute };  // kMute: accepts connections and never sends anything
  using Script = std::function<Answer(std::size_t command)>;

  struct Received {
    std::string arm;
    Vec3 force;
  };

  /// @param greeting first message; empty: the service sends none
  /// @param script called on a thread of the connection with the number of the command, from 0
  explicit HaplyService(
      std::string greeting, Script script = [](std::size_t) { return Answer{one_arm()}; },
      Manner manner = Manner::kWebSocket);
  ~HaplyService();

  [[nodiscard]] std::string address() const;
  [[nodiscard]] std::vector<Received> received() const;
  /// Newest force [N]. NaN before the first command.
  [[nodiscard]] Vec3 force() const;
  [[nodiscard]] std::size_t connections() const;
  [[nodiscard]] bool said_farewell() const;
  /// Holds the first message of new connections back while `holds` is true.
  void hold_back(bool holds);
  void greet_with(std::string greeting);

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace palpate::devices::test
