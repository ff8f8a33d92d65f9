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

/// A hand on a device, both emulated: the hand wants to follow a path, its grip pulls the device's mass
/// there, and the force that is written moves that mass. Time is the tick's, never the wall's, so a run in
/// real time gives the same rows as one offline. Ticks must come one after the other.
///
/// The position is read through an encoder of finite resolution and the velocity is the filtered difference
/// of those readings, as in real devices. Orientation and gripper follow the path itself: nothing turns the
/// hand, torque and the gripper's force go nowhere.
class EmulatedDevice final : public haptics::Device {
 public:
  static constexpr double kVelocityFilter = 5e-3;  // s, time constant of the velocity's low pass
  /// A device that refuses commands keeps the last force it took for so long, then lets go by itself, as the
  /// watchdog of real devices does.
  static constexpr double kOwnWatchdog = 10e-3;  // s

  /// [setup] @param setup dynamics (defaults where it says nothing) and emulated hand
  /// @throws ParameterError when a figure is out of its range.
  EmulatedDevice(scene::ToolPath path, const scene::DeviceSetup& setup, double rate_Hz);

  /// [rt] Moves the hand by one period under the force last taken, then samples it.
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] The force acts until the next command. @return false when a scheduled fault refuses it.
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  /// [any] No force until the next command that is taken.
  void stop() noexcept override { stopped_.store(true, std::memory_order_relaxed); }
  /// [any] round((end of the path + 0.5 s) x rate).
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;

  /// [rt] The true place and work of the hand, for tests and measurements; not for the tick.
  [[nodiscard]] const HandMass& hand() const noexcept { return hand_; }
  /// [rt] The force that acts on the hand now [N].
  [[nodiscard]] Vec3 force_on_hand() const noexcept;

 private:
  [[nodiscard]] Vec3 encoder_reading() const noexcept;

  scene::ToolPath path_;
  double resolution_;
  double rate_Hz_;
  double velocity_share_;  // of a new difference in the filtered velocity
  FaultSchedule faults_;
  HandMass hand_;
  Vec3 target_;
  Vec3 reading_ = Vec3::Zero();
  Vec3 velocity_ = Vec3::Zero();
  Vec3 force_ = Vec3::Zero();  // last taken
  std::uint64_t tick_ = 0;     // last read
  bool started_ = false;
  std::uint64_t refused_ = 0;  // commands since the last that was taken
  std::atomic<bool> stopped_{false};
  std::atomic<int> last_fault_{-1};  // EmulatedFaultKind, for last_error()
};

}  // namespace palpate::devices
