#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "palpate/device.h"
#include "palpate/triple_buffer.h"

namespace palpate::devices {

/// Called every few milliseconds while a device waits for its first poses. It may throw to give up.
using OnWait = std::function<void()>;

/// One pose of a tracked tool, as a message gives it, in the device's frame D.
struct StreamedPose {
  Vec3 position_D = Vec3::Zero();  // m
  Quat orientation_D = Quat::Identity();
  double gripper = 0.0;  // 0 closed .. 1 open
};

/// Turns poses that arrive 20 to 1000 times a second at a network thread into one sample per tick. The tick
/// gets the pose of a moment shortly ago, interpolated between two received poses: positions linear,
/// orientations by slerp, velocity constant between two poses. Neither thread waits for the other.
///
/// The delay is twice the mean period of the first kLearned messages, so that one late message does not stop
/// the tool. After a later one the tool goes on from where it rests, without a jump. Samples are a function
/// of the poses, their times and the ticks' times.
///
/// Each of these is a fault (Fault::kDevice, or Fault::kStale by the sample's age) until kLearned poses have
/// come again and the delay has passed:
/// - no pose for kSilence. Between the newest pose and this time the tool rests at the newest pose;
/// - a pose that is not finite, has no unit quaternion, is out of reach or too far from the previous pose;
/// - break_off(), as when the connection ends.
class PoseStream final {
 public:
  /// As the usual timeout of commands in MoveIt Servo, 0.1 s. A sender of 30 Hz may lose one message.
  static constexpr std::int64_t kSilence = 100'000'000;  // ns
  static constexpr std::size_t kLearned = 8;             // messages that give the period
  static constexpr std::int64_t kShortestDelay = 10'000'000;
  static constexpr std::int64_t kLongestDelay = kSilence;  // ns: two periods at 20 Hz
  static constexpr double kReach = 5.0;                    // m from the origin of D, along each axis
  static constexpr double kLargestStep = 0.1;              // m between two poses: 2 m/s at 20 Hz
  static constexpr double kLargestTurn = 1.0472;           // rad between two poses, 60 degrees
  static constexpr double kUnitSlack = 0.01;               // deviation of a quaternion's norm from 1
  /// Poses that arrive within this time of a kept one replace its pose, so that two that were delivered
  /// together do not give a jump.
  static constexpr std::int64_t kShortestStep = 4'000'000;  // ns

  /// [any] Network thread: adds a pose that arrived at a monotonic time [ns], not before the last one.
  /// @return why the pose is refused, as text; empty: it is used
  [[nodiscard]] std::string add(const StreamedPose& pose, std::int64_t arrived_ns);
  /// [any] Network thread: the connection ended or a message cannot be read. No pose is usable until the
  /// stream has restarted.
  void break_off() noexcept;

  /// [rt] The sample for a tick at a monotonic time [ns] that never decreases. While it is a fault, the pose
  /// is the last one without fault. Called by one thread at a time.
  [[nodiscard]] haptics::DeviceState at(std::int64_t now_ns) noexcept;

 private:
  struct Kept {
    StreamedPose pose;
    std::int64_t time_ns = 0;  // arrival of the first pose that it stands for
  };
  static constexpr std::size_t kKept = 32;  // more than kLongestDelay / kShortestStep, and the pose before
  struct Window {
    std::array<Kept, kKept> kept{};
    std::size_t count = 0;
    std::int64_t newest_ns = 0;  // arrival of the newest pose
    std::int64_t delay_ns = 0;   // 0: not known yet
  };

  [[nodiscard]] std::string refusal(const StreamedPose& pose) const;
  void restart() noexcept;
  void keep(const StreamedPose& pose, std::int64_t arrived_ns) noexcept;
  void publish() noexcept;
  [[nodiscard]] haptics::DeviceState interpolated(const Window& window, std::int64_t time_ns) const noexcept;

  // Used only by the network thread:
  Window window_;
  StreamedPose newest_;        // the newest pose, when window_.count > 0
  std::size_t learned_ = 0;    // messages since the stream began
  std::int64_t began_ns_ = 0;  // arrival of the first of them

  TripleBuffer<Window> windows_;  // network thread to tick

  // Used only by the tick:
  haptics::DeviceState last_;  // the last sample without fault
  std::int64_t last_ns_ = 0;   // its moment
  bool running_ = false;       // the last tick had no fault
};

}  // namespace palpate::devices
