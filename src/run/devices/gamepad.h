#pragma once
#include <cstdint>
#include <string>

#include "run/devices/window_device.h"

namespace palpate::devices {

/// What the window says of its gamepad, in the device's frame.
struct GamepadInput {
  Vec3 velocity_D = Vec3::Zero();  // m/s, what the sticks ask for
  Vec3 advance_D = Vec3::Zero();   // m, how far the trigger presses beyond where the sticks have led
  double gripper = 0.0;            // 0 closed .. 1 open
  std::uint32_t buttons = 0;       // a bit a button
  bool connected = true;           // false: it was unplugged, or the window is gone
};

/// A tool that a gamepad moves in the window of a run: the sticks give a speed, the trigger a depth. The
/// window makes the pad rumble by what the newest snapshot says.
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
  Vec3 led_to_;  // where the sticks have led
};

}  // namespace palpate::devices
