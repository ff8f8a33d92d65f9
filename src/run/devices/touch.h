#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "palpate/device.h"
#include "run/devices/crash_stop.h"
#include "run/devices/probe.h"
#include "run/devices/touch_scheduler.h"

namespace palpate::devices {

/// A 3D Systems Touch, Touch X, Phantom Omni or Phantom through OpenHaptics' HD library.
///
/// The vendor's library reads state and writes force only in the callback of its scheduler. The tick
/// exchanges both with that thread without waiting (TouchScheduler). Frame D: x to the right, y forward, away
/// from the user, z up [m]. Button 1 of the stylus closes the jaws. Torques and gripper forces are ignored:
/// these arms have none. Without a write for 20 ms the callback gives zero force.
class TouchDevice final : public haptics::Device {
 public:
  static constexpr double kJawSpeed = 4.0;  // 1/s: from open to closed in 0.25 s

  /// [setup] Opens the arm, calibrates it unless that needs the user's hand, and waits at most 2 s for a
  /// sample.
  /// @param name as Touch_Setup has it; empty: the default device
  /// @param library as HdLibrary takes it
  /// @throws InputError when the library cannot be loaded, the arm cannot be opened or calibrated, or the
  /// scheduler gives no sample.
  explicit TouchDevice(const std::string& name, const std::string& library = HdLibrary::kName);
  /// [setup] Zero force, force output off, the arm closed; 50 ms at most.
  ~TouchDevice() override;
  TouchDevice(const TouchDevice&) = delete;
  TouchDevice& operator=(const TouchDevice&) = delete;

  /// [rt] The newest sample; its age is the time since the vendor's scheduler took it. Fault::kForceOff: the
  /// stylus is in the inkwell or not held, or the arm switched its force off. Fault::kDevice: another error
  /// of the vendor's library.
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] Passes the force to the callback. @return false when it is not finite; zero force is then applied.
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  /// [any] Zero force until the next write().
  void stop() noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;

  /// [setup] "Touch (serial number 123, driver 4.0), at most 3.3 N".
  [[nodiscard]] std::string description() const;
  /// [setup] From the table of models and from what the arm reports.
  [[nodiscard]] haptics::DeviceAbilities abilities() const override { return arm_.abilities; }

 private:
  void wait_until_ready();

  CrashStop crash_stop_;
  TouchArm arm_;
  std::shared_ptr<TouchScheduler> scheduler_;
  double gripper_ = 1.0;
  double read_time_ = 0.0;  // of the last read [s]
};

/// [setup] Whether the vendor's library is installed. Opens no arm. @param library as HdLibrary takes it
[[nodiscard]] Probe probe_touch(const std::string& library = HdLibrary::kName);

}  // namespace palpate::devices
