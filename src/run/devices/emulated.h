#pragma once
#include <atomic>
#include <cstdint>
#include <string>

#include "palpate/device.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"
#include "run/devices/fault_schedule.h"
#include "run/devices/hand_mass.h"

namespace palpate::devices {

/// An emulated hand that holds an emulated device. The grip, a spring and damper, pulls the device's mass
/// along a path; the commanded force acts on that mass. Time comes from the tick number, so runs in real time
/// and offline give the same rows. Ticks must be consecutive.
///
/// As in real devices, an encoder of finite resolution gives the position, and the velocity is the filtered
/// difference of its readings. Orientation and gripper follow the path; torque and gripper force are ignored.
class EmulatedDevice final : public haptics::Device {
 public:
  static constexpr double kVelocityFilter = 5e-3;  // s, time constant of the low-pass filter of the velocity
  /// When commands are refused, the device holds its last accepted force for this time, then gives zero
  /// force, as the watchdog in a real device does.
  static constexpr double kOwnWatchdog = 10e-3;  // s

  /// [setup] @param scene dynamics (else defaults) and emulated hand
  /// @throws ParameterError when a value is out of its range.
  EmulatedDevice(scene::ToolPath path, const scene::DeviceSetup& setup, double rate_Hz);

  /// [rt] Moves the hand by one period under the last accepted force, then samples it.
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] The force acts until the next command. @return false when a scheduled fault refuses it.
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  /// [any] Zero force until the next accepted command.
  void stop() noexcept override { stopped_.store(true, std::memory_order_relaxed); }
  /// [any] round((end of the path + 0.5 s) x rate).
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;

  /// [rt] The exact position and work of the hand, for tests and measurements; not for the tick.
  [[nodiscard]] const HandMass& hand() const noexcept { return hand_; }
  /// [rt] The force that acts on the hand now [N].
  [[nodiscard]] Vec3 force_on_hand() const noexcept;

 private:
  [[nodiscard]] Vec3 encoder_reading() const noexcept;

  scene::ToolPath path_;
  double resolution_;
  double rate_Hz_;
  double velocity_weight_;  // weight of a new difference in the filtered velocity, 0..1
  FaultSchedule faults_;
  HandMass hand_;
  Vec3 target_;
  Vec3 reading_ = Vec3::Zero();
  Vec3 velocity_ = Vec3::Zero();
  Vec3 force_ = Vec3::Zero();  // last accepted [N]
  std::uint64_t tick_ = 0;     // of the last read()
  bool started_ = false;
  std::uint64_t refused_ = 0;  // commands since the last accepted one
  std::atomic<bool> stopped_{false};
  std::atomic<int> last_fault_{-1};  // EmulatedFaultKind, for last_error()
};

}  // namespace palpate::devices
