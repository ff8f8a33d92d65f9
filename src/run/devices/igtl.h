#pragma once
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "io/igtl/igtl_messages.h"
#include "io/igtl/igtl_reader.h"
#include "io/igtl/igtl_socket.h"
#include "palpate/device.h"
#include "run/devices/crash_stop.h"
#include "run/devices/force_hand_over.h"
#include "run/devices/pose_stream.h"

namespace palpate::devices {

/// Where a client connects, and the name of the TRANSFORM messages that are the hand.
struct IgtlSource {
  net::IgtlAddress address;
  std::string name;
};

/// [setup] Parses "[ADDRESS:]PORT/NAME". @throws InputError naming the required form.
[[nodiscard]] IgtlSource parse_igtl_source(const std::string& text);

/// Times of the exchange with a client [ns].
struct IgtlTimes {
  std::int64_t opening = 30'000'000'000;    // for the client to connect and send its first poses
  std::int64_t period = 10'000'000;         // between two messages to the client
  std::int64_t write_timeout = 20'000'000;  // longest gap between write() calls before the force is zero
  std::int64_t replaced = 1'000'000'000;    // silence after which a new client replaces one
};

/// A hand that a client moves by OpenIGTLink: its TRANSFORM messages of one name are the pose of the tool,
/// through a PoseStream. The force goes back on the same connection, at most every IgtlTimes::period.
///
/// One client at a time. The device's own thread listens, receives and sends. A client that sends what is not
/// OpenIGTLink is disconnected, and another may connect. Whatever ends a stream of poses is a fault. A
/// message whose status is not OK is no pose, as if it had not come.
class IgtlDevice final : public haptics::Device {
 public:
  static constexpr const char* kForceName = "PalpateHandForce";    // SENSOR, N; TRANSFORM, 1 mm for 1 N
  static constexpr const char* kTorqueName = "PalpateHandTorque";  // SENSOR, N m

  /// [setup] Listens and waits until a client has sent enough poses. @param source [ADDRESS:]PORT/NAME
  /// @throws InputError when `source` is invalid, the port cannot be listened at, or no client sends poses
  /// within IgtlTimes::opening.
  explicit IgtlDevice(const std::string& source, const IgtlTimes& times = {}, const OnWait& on_wait = {});
  /// [setup] Sends zero force, closes the connection and joins the thread; a fifth of a second at most.
  ~IgtlDevice() override;
  IgtlDevice(const IgtlDevice&) = delete;
  IgtlDevice& operator=(const IgtlDevice&) = delete;

  /// [rt] The interpolated pose. Its fault is that of PoseStream::at().
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] Passes the force to the thread. @return false when it is not finite; zero force is then sent.
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  /// [any] Zero force until the next write().
  void stop() noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;
  /// [any] "TRANSFORM Hand at 127.0.0.1:18945".
  [[nodiscard]] std::string description() const;

 private:
  IgtlDevice(IgtlSource source, const IgtlTimes& times);  // listens, and starts the thread

  void wait_for_poses(const OnWait& on_wait);
  [[nodiscard]] std::string why_no_poses() const;
  void run() noexcept;
  void serve();
  void let_in(std::int64_t now);
  void receive(std::int64_t now);
  void take(const std::optional<Pose>& pose, const std::string& status, std::int64_t now);
  void send_if_due(std::int64_t now);
  void pack(const haptics::ForceCommand& command_D);
  void send_pending();
  void drop(const std::string& why);
  void let_go() noexcept;
  void set_error(const std::string& what);

  const IgtlTimes times_;
  const IgtlSource source_;
  std::atomic<bool> closing_{false};
  std::atomic<std::int64_t> heard_ns_{0};  // arrival of the newest pose of that name; 0: none yet
  PoseStream poses_;
  ForceHandover forces_;
  mutable std::mutex mutex_;
  std::string last_error_;           // this and the next three: guarded by mutex_
  bool usable_ = false;              // the newest message had a usable pose
  std::vector<std::string> others_;  // names of other TRANSFORM messages that the client sends
  bool connected_ = false;

  // Used only by the thread once it runs:
  net::Socket listener_;
  net::Socket client_;
  net::IgtlReader reader_;
  std::int64_t received_ns_ = 0;  // when the client last sent anything
  std::int64_t next_send_ns_ = 0;
  net::Bytes pending_;  // messages that are being sent
  std::size_t sent_ = 0;

  CrashStop crash_stop_;
  std::thread thread_;
};

}  // namespace palpate::devices
