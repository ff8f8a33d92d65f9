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
  kStalled = 4,    // the loop stood still for kStalledAfter
  kForceOff = 5,   // the device itself switched its force off
};

inline constexpr double kStaleAfter = 5e-3;     // s
inline constexpr double kStalledAfter = 20e-3;  // s

/// [any] As in CSV and JSON: "none", "not-finite", "device", "stale-sample", "stalled-loop", "force-off".
[[nodiscard]] const char* name_of(Fault fault) noexcept;

/// [any] For people: "the device gave no new sample for 5 ms".
[[nodiscard]] const char* describe(Fault fault) noexcept;

/// What a user or the device adds to a sample; bits of DeviceState::events.
inline constexpr std::uint32_t kResetFault = 1U << 0;        // clear a latched fault
inline constexpr std::uint32_t kParameterUpdated = 1U << 1;  // from this tick on: a change of tissue or noise
inline constexpr std::uint32_t kMotorsWarm = 1U << 2;  // the device's motors are: the gate lowers the force

/// One reading of a device, taken as ONE sample, in the device's frame D. SI.
struct DeviceState {
  Vec3 position_D = Vec3::Zero();  // m
  Quat orientation_D = Quat::Identity();
  Vec3 velocity_D = Vec3::Zero();  // m/s
  double gripper = 0.0;            // 0 closed .. 1 open
  double age = 0.0;                // s since the device took this sample; 0: for this tick
  std::uint32_t buttons = 0;       // a bit a button
  Fault fault = Fault::kNone;      // kDevice: could not be read; kForceOff; kStalled (set by the loop)
  std::uint32_t events = 0;  // kResetFault and kParameterUpdated are the loop's, kMotorsWarm is the device's
};

/// What goes to the hand. SI. World frame from the tick; the loop turns it into the device's frame.
struct ForceCommand {
  Vec3 force = Vec3::Zero();   // N
  Vec3 torque = Vec3::Zero();  // N m
  double gripper_force = 0.0;  // N
};

/// Limits of a device, by its maker or as the device reports them; infinite where unknown.
struct DeviceAbilities {
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();

  std::string model{};                 // as people know it; empty: not known
  double max_force = kUnknown;         // N
  double continuous_force = kUnknown;  // N, root mean square, without end
  double max_stiffness = kUnknown;     // N/m that it renders without trembling
  bool torque = true;                  // it can give torque

  bool operator==(const DeviceAbilities&) const = default;
};

/// A force-feedback device as the loop sees it.
class Device {
 public:
  virtual ~Device() = default;
  /// [rt] One sample. Scripted and replayed devices sample at `time` = tick / rate [s], never at wall time.
  virtual DeviceState read(std::uint64_t tick, double time) noexcept = 0;
  /// [rt] Called by the loop with what the gate let through, in the device's frame. @return false when the
  /// device refused it.
  virtual bool write(const ForceCommand& command_D) noexcept = 0;
  /// [any] Zero force; idempotent, from any thread.
  virtual void stop() noexcept = 0;
  /// [any] Tick number at which the device has nothing more to say (a path's end + 0.5 s), or 2^64-1: never.
  [[nodiscard]] virtual std::uint64_t last_tick(double /*rate_Hz*/) const noexcept {
    return ~std::uint64_t{0};
  }
  /// [setup] What it can give: the limits of a run follow it.
  [[nodiscard]] virtual DeviceAbilities abilities() const { return {}; }
  /// [any] What was last wrong with the device, in words for its user; empty: nothing. Not for the tick: may
  /// allocate.
  [[nodiscard]] virtual std::string last_error() const { return {}; }
};

}  // namespace palpate::haptics
