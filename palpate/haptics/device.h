#pragma once
#include <cstdint>

#include "palpate/base/pose.h"

namespace palpate::haptics {

/// One reading of a device, taken as ONE sample, in the device's frame D. SI.
struct DeviceState {
  Vec3 position_D = Vec3::Zero();  // m
  Quat orientation_D = Quat::Identity();
  Vec3 velocity_D = Vec3::Zero();  // m/s
  double gripper = 0.0;            // 0 closed .. 1 open
  std::uint32_t buttons = 0;       // a bit a button
  bool valid = true;               // false: the device could not be read
};

/// What goes to the hand, world frame. SI.
struct ForceCommand {
  Vec3 force = Vec3::Zero();   // N
  Vec3 torque = Vec3::Zero();  // N m
  double gripper_force = 0.0;  // N
};

/// A force-feedback device as the loop sees it.
class Device {
 public:
  virtual ~Device() = default;
  /// [rt] One sample. Scripted and replayed devices sample at `time` = tick / rate [s], never at wall time.
  virtual DeviceState read(std::uint64_t tick, double time) noexcept = 0;
  /// [rt] Called by the gate only. @return false when the device refused it.
  virtual bool write(const ForceCommand& command) noexcept = 0;
  /// [any] Zero force; idempotent, from any thread.
  virtual void stop() noexcept = 0;
  /// [any] Tick number at which the device has nothing more to say (a path's end + 0.5 s), or 2^64-1.
  [[nodiscard]] virtual std::uint64_t last_tick(double rate_Hz) const noexcept = 0;
};

}  // namespace palpate::haptics
