#pragma once
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "io/websocket/client.h"
#include "palpate/device.h"
#include "palpate/triple_buffer.h"
#include "run/devices/crash_stop.h"
#include "run/devices/force_hand_over.h"
#include "run/devices/haply_messages.h"
#include "run/devices/models.h"
#include "run/devices/probe.h"

namespace palpate::devices {

/// [setup] Parses the service's address; empty: ws://localhost:10001, its default.
/// @throws InputError that states the required form.
[[nodiscard]] websocket::Address parse_haply_address(const std::string& text);

/// Times of the exchange with the service [ns].
struct HaplyTimes {
  std::int64_t opening =
      websocket::Client::kOpeningLimit;     // for connection and handshake; then for the first message
  std::int64_t period = 500'000;            // between two commands, when replies come at once
  std::int64_t reply = 1'000'000'000;       // longest wait for a reply before the connection is closed
  std::int64_t retry = 1'000'000'000;       // from the end of a connection to the next attempt
  std::int64_t write_timeout = 20'000'000;  // longest gap between write() calls before the force is zero
};

/// A Haply Inverse3 behind Haply's Inverse Service: JSON over a WebSocket, one state message a command.
///
/// The device's own thread sends the newest force and receives the newest state. The tick exchanges both with
/// it without waiting. Zero force is sent at once, without waiting for the reply to the last command. Torques
/// and gripper forces are ignored: an Inverse3 has no actuators for them.
class HaplyDevice final : public haptics::Device {
 public:
  /// [setup] Connects, and takes the service's arm number `place` (from 0) and grip number `place`, if there
  /// is one. @param address ws://HOST:PORT; empty: ws://localhost:10001
  /// @throws InputError when the address is invalid, no service answers, the arm is missing or a message is
  /// invalid.
  HaplyDevice(const std::string& address, std::size_t place, const HaplyTimes& times = {});
  /// [setup] Sends zero force, closes the connection and joins the thread; about half a second at most.
  ~HaplyDevice() override;
  HaplyDevice(const HaplyDevice&) = delete;
  HaplyDevice& operator=(const HaplyDevice&) = delete;

  /// [rt] The newest sample; its age is the time since it was received. Fault::kDevice: no connection, or the
  /// newest message is invalid. Fault::kForceOff: the arm reports that its force is off.
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] Passes the force to the thread. @return false when it is not finite; zero force is then sent.
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  /// [any] Zero force until the next write().
  void stop() noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;
  /// [setup] Those of an Inverse3.
  [[nodiscard]] haptics::DeviceAbilities abilities() const override { return abilities_of_model("Inverse3"); }
  /// [any] Which devices of the service it is: "Inverse3 04BA with verse grip 77 at ws://localhost:10001".
  [[nodiscard]] std::string description() const;

 private:
  struct Sample {
    haptics::DeviceState state;
    std::int64_t received_ns = 0;
  };
  /// State of the message exchange, owned by the thread.
  struct Exchange {
    std::int64_t next_send_ns = 0;
    std::int64_t waiting_since_ns = 0;  // for a reply, while awaited > 0
    std::int64_t awaited = 0;           // replies
    Vec3 sent_D = Vec3::Zero();         // last force
  };

  void greet(std::size_t place);
  void run() noexcept;
  void exchange();
  void take_replies(Exchange& exchange);
  void send_if_due(Exchange& exchange);
  void take(const std::string& message, std::int64_t now);
  void publish(const haptics::DeviceState& state, std::int64_t received_ns);
  void fail(const std::string& why);
  void set_error(const std::string& what);
  void pause() const noexcept;
  void let_go() noexcept;

  const HaplyTimes times_;
  const websocket::Address address_;
  std::atomic<bool> closing_{false};
  TripleBuffer<Sample> samples_;  // thread to loop
  ForceHandover forces_;          // loop to thread
  mutable std::mutex mutex_;      // of last_error_
  std::string last_error_;

  // Used only by the thread once it runs:
  websocket::Client link_;
  std::string arm_;   // device_id, from the first connection on
  std::string grip_;  // empty: none
  HaplyForceField force_field_ = HaplyForceField::kValues;
  Sample newest_;

  CrashStop crash_stop_;
  std::thread thread_;
};

/// [setup] Whether the service answers and which devices it has, or why not. Takes at most
/// websocket::Client::kOpeningLimit. Never throws InputError: an invalid address is reported in the result.
[[nodiscard]] Probe probe_haply(const std::string& address);

}  // namespace palpate::devices
