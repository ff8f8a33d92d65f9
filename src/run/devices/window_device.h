#pragma once
#include <atomic>
#include <cstdint>

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

}  // namespace palpate::devices
