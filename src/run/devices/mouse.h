#pragma once
#include <cstdint>
#include <string>

#include "run/devices/window_device.h"

namespace palpate::devices {

/// Where the window's pointer wants the tool, in the device's frame and lengths.
struct MouseInput {
  Vec3 target_D = Vec3::Zero();  // m, of the held point
  double gripper = 0.0;          // 0 closed .. 1 open
  std::uint32_t buttons = 0;     // one bit per button
  bool present = true;           // false: the window is closed
  Vec3 held = Vec3::Zero();      // m, point of the tool that moves to target_D, handle frame
  bool turns = false;            // the tool turns to orientation_D, about the held point
  Quat orientation_D = Quat::Identity();
};

/// A tool that a mouse moves in the window of a run.
class MouseDevice final : public WindowDevice<MouseInput> {
 public:
  /// [setup] @param start in the device's frame
  MouseDevice(const scene::PathRow& start, double rate_Hz) noexcept : WindowDevice(start, rate_Hz) {
    wanted_.target_D = start.position;
  }

  /// [any] Where the tool is before the first input.
  [[nodiscard]] const Vec3& start() const noexcept { return hand_.start(); }
  /// [rt]
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;
};

}  // namespace palpate::devices
