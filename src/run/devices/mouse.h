#pragma once
#include <atomic>
#include <cstdint>
#include <string>

#include "palpate/device.h"
#include "palpate/snapshot_cell.h"
#include "run/devices/steady_hand.h"

namespace palpate::devices {

/// What the window says of its mouse: where the tool is to go, in the device's frame.
struct MouseInput {
  Vec3 target_D = Vec3::Zero();  // m
  double gripper = 0.0;          // 0 closed .. 1 open
  std::uint32_t buttons = 0;     // a bit a button
  bool present = true;           // false: the window is gone
};

/// A tool that a mouse moves in the window of a run. The window writes what it wants into input(); the tick
/// follows it as a calm hand would (SteadyHand). Nothing reaches the user's hand: forces go nowhere, so it is
/// not a held device. It starts where the scripted device starts.
class MouseDevice final : public haptics::Device {
 public:
  /// [setup] @param start in the device's frame
  MouseDevice(const scene::PathRow& start, double rate_Hz) noexcept : hand_(start, 1.0 / rate_Hz) {
    wanted_.target_D = start.position;
    wanted_.gripper = start.gripper;
  }

  /// [any] One thread, the window's, writes.
  [[nodiscard]] SnapshotCell<MouseInput>& input() noexcept { return input_; }
  /// [any] Where the tool is before the first input.
  [[nodiscard]] const Vec3& start() const noexcept { return hand_.start(); }
  /// [any] The tool's orientation, which stays.
  [[nodiscard]] const Quat& orientation() const noexcept { return hand_.orientation(); }

  /// [rt]
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] Accepts every command: a mouse gives no force.
  bool write(const haptics::ForceCommand& /*command*/) noexcept override { return true; }
  /// [any]
  void stop() noexcept override {}
  /// [any] Never: the window says when.
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override;
  /// [any]
  [[nodiscard]] std::string trouble() const override;

 private:
  SnapshotCell<MouseInput> input_;
  MouseInput wanted_;  // the tick's
  SteadyHand hand_;
  std::atomic<bool> gone_{false};
};

}  // namespace palpate::devices
