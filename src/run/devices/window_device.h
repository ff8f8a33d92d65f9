#pragma once
#include <atomic>
#include <cstdint>

#include "palpate/device.h"
#include "palpate/triple_buffer.h"
#include "run/devices/steady_hand.h"

namespace palpate::devices {

/// A tool that something in the window of a run moves. The window writes an Input into input(); the tick
/// follows it as a calm hand would (SteadyHand). Forces go nowhere, so it is not a held device. It starts
/// where the scripted device starts and keeps that orientation.
template <typename Input>
class WindowDevice : public haptics::Device {
 public:
  /// [any] One thread, the window's, writes.
  [[nodiscard]] TripleBuffer<Input>& input() noexcept { return input_; }
  /// [any] The tool's orientation.
  [[nodiscard]] const Quat& orientation() const noexcept { return hand_.orientation(); }

  /// [rt] Accepts every command: no hand feels it.
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
  /// [rt] Where the hand is now. @param there whether the window and what it reads are
  haptics::DeviceState sample(bool there) noexcept {
    haptics::DeviceState state = hand_.state();
    state.buttons = wanted_.buttons;
    if (!there) state.fault = haptics::Fault::kDevice;
    gone_.store(!there, std::memory_order_relaxed);
    return state;
  }
  [[nodiscard]] bool gone() const noexcept { return gone_.load(std::memory_order_relaxed); }

  SteadyHand hand_;
  Input wanted_;  // the tick's

 private:
  TripleBuffer<Input> input_;
  std::atomic<bool> gone_{false};
};

}  // namespace palpate::devices
