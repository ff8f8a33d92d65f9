#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/haptics/gate.h"
#include "palpate/device.h"

namespace palpate::realtime {

/// Limits of a measurement on a held device. The gate limits force and slew; the rest ends the measurement.
struct PlayLimits {
  double max_force = 3.0;    // N
  double max_slew = 1000.0;  // N/s
  double max_travel = 0.06;  // m from the position at the start of a part
  double max_speed = 0.8;    // m/s
};

/// The clock of a measurement; another one than monotonic_ns() only in tests.
struct PlayClock {
  std::function<std::int64_t()> now;
  std::function<void(std::int64_t)> sleep_until;
  bool watched = true;  // the watchdog acts, which knows the real time only

  /// [setup] The computer's monotonic clock.
  [[nodiscard]] static PlayClock monotonic();
};

/// One tick of a measurement.
struct PlayedTick {
  double time = 0.0;             // s, tick / rate from the start of the part
  std::int64_t begin_ns = 0;     // when the tick began
  Vec3 position = Vec3::Zero();  // m, in the device's frame
  double age = 0.0;              // s, of the sample
  Vec3 force = Vec3::Zero();     // N, as the gate let it through and the device took it
};

/// A haptic loop without an organ: plays forces on one held device, through the gate, and keeps what the
/// device showed. A fault, a runaway (PlayLimits), a stop or a stalled loop (the watchdog) latches zero force
/// for good.
class HeldPlay final {
 public:
  /// Force [N] that a tick wants, from the tick's sample; nothing: the part ends here.
  using ForceOf = std::function<std::optional<Vec3>(const PlayedTick&)>;

  /// [setup] Max_force is lowered to what the device states. @param stop the user ends the measurement
  HeldPlay(haptics::Device& device, double rate_Hz, const PlayLimits& limits, PlayClock clock,
           const std::atomic<bool>* stop = nullptr);
  ~HeldPlay();
  HeldPlay(const HeldPlay&) = delete;
  HeldPlay& operator=(const HeldPlay&) = delete;

  /// [setup] Plays one part of at most `seconds`, then lowers the force to zero. Empty after a failure.
  std::vector<PlayedTick> play(double seconds, const ForceOf& force_of);

  /// [any] Why no force is displayed any more, in a sentence; empty: all is well.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  [[nodiscard]] double rate_Hz() const noexcept { return rate_Hz_; }
  [[nodiscard]] double max_force() const noexcept { return limits_.max_force; }

 private:
  /// [rt] One tick. @return false: the part ends
  bool advance(const ForceOf& force_of, PlayedTick& tick) noexcept;
  /// [rt] Whether travel, speed or the user end the measurement.
  void judge(const haptics::DeviceState& sample) noexcept;
  void describe_failure();

  haptics::Device& device_;
  double rate_Hz_;
  PlayLimits limits_;
  PlayClock clock_;
  const std::atomic<bool>* stop_;
  haptics::GateLimits gate_limits_;
  haptics::GateState gate_;
  std::uint64_t tick_ = 0;
  std::optional<Vec3> start_;  // m, position at the start of the part
  enum class Ending { kNone, kFault, kTravel, kSpeed, kStopped } ending_ = Ending::kNone;
  double ending_value_ = 0.0;
  std::string failure_;
};

}  // namespace palpate::realtime
