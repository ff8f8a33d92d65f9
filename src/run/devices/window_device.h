#pragma once
#include <atomic>
#include <cstdint>
#include <string>

#include "palpate/device.h"
#include "palpate/triple_buffer.h"
#include "run/devices/target_follower.h"

namespace palpate::devices {

/// A tool that the window of a run moves. The window writes an Input into input(); the tick filters it to
/// hand motion (TargetFollower). Forces are ignored, so it is not a held device. It starts at the pose of the
/// scripted device.
template <typename Input>
class WindowDevice : public haptics::Device {
 public:
  /// [any] Only the window's thread writes.
  [[nodiscard]] TripleBuffer<Input>& input() noexcept { return input_; }
  /// [any] The tool's orientation.
  [[nodiscard]] const Quat& orientation() const noexcept { return hand_.orientation(); }

  /// [rt] Accepts and ignores every command.
  bool write(const haptics::ForceCommand& /*command*/) noexcept override { return true; }
  /// [any]
  void stop() noexcept override {}

 protected:
  /// [setup] @param start in the device's frame
  WindowDevice(const scene::PathRow& start, double rate_Hz) noexcept : hand_(start, 1.0 / rate_Hz) {
    wanted_.gripper = start.gripper;
  }
  /// [rt] The newest input.
  const Input& wanted() noexcept {
    if (input_.refresh()) wanted_ = input_.value();
    return wanted_;
  }
  /// [rt] The current sample. @param there whether the window and its input device are present
  haptics::DeviceState sample(bool there) noexcept {
    haptics::DeviceState state = hand_.state();
    state.buttons = wanted_.buttons;
    if (!there) state.fault = haptics::Fault::kDevice;
    gone_.store(!there, std::memory_order_relaxed);
    return state;
  }
  [[nodiscard]] bool gone() const noexcept { return gone_.load(std::memory_order_relaxed); }

  TargetFollower hand_;
  Input wanted_;  // used by the tick only

 private:
  TripleBuffer<Input> input_;
  std::atomic<bool> gone_{false};
};

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
