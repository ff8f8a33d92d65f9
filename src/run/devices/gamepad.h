#pragma once
#include <cstdint>
#include <string>

#include "run/devices/window_device.h"

namespace palpate::devices {

/// State of the gamepad that the window reads, in the device's frame.
struct GamepadInput {
  Vec3 velocity_D = Vec3::Zero();  // m/s, commanded by the sticks
  Vec3 advance_D = Vec3::Zero();   // m, offset that the trigger adds to the position of the sticks
  double gripper = 0.0;            // 0 closed .. 1 open
  std::uint32_t buttons = 0;       // one bit per button
  bool connected = true;           // false: unplugged, or the window is closed
};

/// A tool that a gamepad moves in the window of a run: the sticks command a velocity, the trigger a depth.
/// The window drives the rumble motors from the newest snapshot.
class GamepadDevice final : public WindowDevice<GamepadInput> {
 public:
  /// [setup] @param start in the device's frame
  GamepadDevice(const scene::PathRow& start, double rate_Hz) noexcept
      : WindowDevice(start, rate_Hz), period_(1.0 / rate_Hz), led_to_(start.position) {}

  /// [rt]
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;

 private:
  double period_;
  Vec3 led_to_;  // position integrated from the sticks [m]
};

}  // namespace palpate::devices
