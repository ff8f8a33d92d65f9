#pragma once
#include <cstdint>
#include <limits>
#include <string>

#include "palpate/pose.h"

namespace palpate::haptics {

/// Why a fault was latched. The numbers are in recordings.
enum class Fault : std::uint8_t {
  kNone = 0,
  kNotFinite = 1,  // a sample or a force is not finite
  kDevice = 2,     // the device could not be read or refused a command
  kStale = 3,      // the device gave no new sample for kStaleAfter
  kStalled = 4,    // the loop made no tick for kStalledAfter
  kForceOff = 5,   // the device itself switched its force off
  kUnstable = 6,   // the passivity controller could not keep the energy bound
};
inline constexpr Fault kLastFault = Fault::kUnstable;

inline constexpr double kStaleAfter = 5e-3;     // s
inline constexpr double kStalledAfter = 20e-3;  // s

/// [any] The fault's name in CSV and JSON files: "none", "not-finite", "device", "stale-sample",
/// "stalled-loop", "force-off", "unstable".
[[nodiscard]] const char* name_of(Fault fault) noexcept;

/// [any] A readable description: "the device gave no new sample for 5 ms".
[[nodiscard]] const char* describe(Fault fault) noexcept;

/// Bits of DeviceState::events: requests of the user and reports of the device that come with a sample.
inline constexpr std::uint32_t kResetFault = 1U << 0;        // clear a latched fault
inline constexpr std::uint32_t kParameterUpdated = 1U << 1;  // tissue or noise parameters change at this tick
inline constexpr std::uint32_t kMotorsWarm = 1U << 2;        // the motors are warm: the gate lowers the force
inline constexpr std::uint32_t kIntervalBegan = 1U << 3;     // a stimulus interval began; set by the tick
inline constexpr std::uint32_t kIntervalEnded = 1U << 4;     // a stimulus interval ended; set by the tick
inline constexpr std::uint32_t kPuncture = 1U << 5;          // a needle punctured a layer; set by the tick
inline constexpr std::uint32_t kExit = 1U << 6;  // a needle left the tissue as it had come; set by the tick
/// The events that the tick sets, so that a sample's own are ignored.
inline constexpr std::uint32_t kEventsOfTick = kIntervalBegan | kIntervalEnded | kPuncture | kExit;

/// One sample of a device: all values belong to the same moment. SI units, in the device's frame D.
struct DeviceState {
  Vec3 position_D = Vec3::Zero();  // m
  Quat orientation_D = Quat::Identity();
  Vec3 velocity_D = Vec3::Zero();  // m/s
  double gripper = 0.0;            // 0 closed .. 1 open
  double age = 0.0;                // s since the device took this sample; 0: taken for this tick
  std::uint32_t buttons = 0;       // one bit per button
  Fault fault = Fault::kNone;  // kDevice (not readable) or kForceOff from the device; kStalled from the loop
  std::uint32_t events = 0;    // the loop sets kResetFault and kParameterUpdated, the device sets kMotorsWarm
};

/// Force and torque that the device displays to the hand. SI units. The tick computes them in the world
/// frame; the loop transforms them to the device's frame.
struct ForceCommand {
  Vec3 force = Vec3::Zero();   // N
  Vec3 torque = Vec3::Zero();  // N m
  double gripper_force = 0.0;  // N
};

/// Limits of a device, from its data sheet or as the device reports them; infinite where unknown.
struct DeviceAbilities {
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();

  std::string model{};                 // product name; empty: unknown
  double max_force = kUnknown;         // N
  double continuous_force = kUnknown;  // N, RMS force that it can give for an unlimited time
  double max_stiffness = kUnknown;     // N/m, largest stiffness that it displays without oscillation
  bool torque = true;                  // whether it can give torque

  bool operator==(const DeviceAbilities&) const = default;
};

/// An impedance display: the loop reads its motion and writes its force, once per tick.
class Device {
 public:
  virtual ~Device() = default;
  /// [rt] Returns one sample. Scripted and replayed devices sample at `time` = tick / rate [s], not at
  /// wall-clock time.
  virtual DeviceState read(std::uint64_t tick, double time) noexcept = 0;
  /// [rt] Displays the force that the gate has limited, in the device's frame. @return false when the device
  /// refuses the command.
  virtual bool write(const ForceCommand& command_D) noexcept = 0;
  /// [any] Sets the force to zero. Idempotent; may be called from any thread, during read() and write() too.
  virtual void stop() noexcept = 0;
  /// [any] Number of the tick at which the device has no more samples (0.5 s after the end of a path).
  /// 2^64-1: it always has more samples.
  [[nodiscard]] virtual std::uint64_t last_tick(double /*rate_Hz*/) const noexcept {
    return ~std::uint64_t{0};
  }
  /// [setup] The device's limits. They bound the forces of a run.
  [[nodiscard]] virtual DeviceAbilities abilities() const { return {}; }
  /// [any] Readable description of the device's last error; empty: no error. May allocate, so do not call it
  /// from the tick.
  [[nodiscard]] virtual std::string last_error() const { return {}; }
};

}  // namespace palpate::haptics
