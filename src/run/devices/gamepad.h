#pragma once
#include <atomic>
#include <cstdint>
#include <string>

#include "palpate/device.h"
#include "palpate/snapshot_cell.h"
#include "run/devices/steady_hand.h"

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
/// window writes into input(); the tick follows as a calm hand would (SteadyHand). Forces go nowhere (the
/// window makes the pad rumble by what the newest snapshot says), so it is not a held device. It starts where
/// the scripted device starts.
class GamepadDevice final : public haptics::Device {
 public:
  /// [setup] @param start in the device's frame
  GamepadDevice(const scene::PathRow& start, double rate_Hz) noexcept
      : hand_(start, 1.0 / rate_Hz), period_(1.0 / rate_Hz), led_to_(start.position) {
    wanted_.gripper = start.gripper;
  }

  /// [any] One thread, the window's, writes.
  [[nodiscard]] SnapshotCell<GamepadInput>& input() noexcept { return input_; }
  /// [any] The tool's orientation, which stays.
  [[nodiscard]] const Quat& orientation() const noexcept { return hand_.orientation(); }

  /// [rt]
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] Accepts every command: it is no hand's force.
  bool write(const haptics::ForceCommand& /*command*/) noexcept override { return true; }
  /// [any]
  void stop() noexcept override {}
  /// [any] Never: the window says when.
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override;
  /// [any]
  [[nodiscard]] std::string trouble() const override;

 private:
  SnapshotCell<GamepadInput> input_;
  GamepadInput wanted_;  // the tick's
  SteadyHand hand_;
  double period_;
  Vec3 led_to_;  // where the sticks have led
  std::atomic<bool> gone_{false};
};

}  // namespace palpate::devices
