#pragma once
#include <cstdint>
#include <string>

#include "run/devices/window_device.h"

namespace palpate::devices {

/// State of the mouse that the window reads: the target of the tool, in the device's frame.
struct MouseInput {
  Vec3 target_D = Vec3::Zero();  // m
  double gripper = 0.0;          // 0 closed .. 1 open
  std::uint32_t buttons = 0;     // one bit per button
  bool present = true;           // false: the window is closed
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
