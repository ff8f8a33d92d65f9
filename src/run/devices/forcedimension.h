#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "palpate/device.h"
#include "run/devices/forcedimension_library.h"
#include "run/devices/probe.h"

namespace palpate::devices {

/// A Force Dimension device (delta, omega, sigma, lambda) or a Novint Falcon through Force Dimension's
/// library.
///
/// The device's frame D is the vendor's own base frame: x towards the user, y to the user's right, z up [m];
/// a scene's `base` places it. The force is on from the opening on, at zero, and with the first write the
/// firmware's own watchdog is armed where there is one, so that a program that hangs lets the force go.
/// A time-guarded sample (the vendor's limit of how often it asks the device) is the last one again: its age
/// grows. A saturated motor is no error: the device gives what it can.
class ForceDimensionDevice final : public haptics::Device {
 public:
  /// Gripper angle [rad] that counts as open; 0 is closed. The sign is that of left- or right-handed devices.
  static constexpr double kOpenAngle = 0.5;
  /// How often the device's status is asked for [s]: it is a message of its own to the device.
  static constexpr double kStatusEvery = 2e-3;

  /// [setup] Opens the device number `ordinal` (0 is the first) of those connected, switches its force on at
  /// zero force and waits until it can be read, 0.2 s at most.
  /// @param library path of the vendor's library; empty: where the system has it
  /// @throws InputError in one line: the library (see DhdLibrary), no such device, it cannot be opened or
  /// read, it is not calibrated, its force cannot be switched on.
  ForceDimensionDevice(const std::string& library, std::size_t ordinal);
  ~ForceDimensionDevice() override;
  ForceDimensionDevice(const ForceDimensionDevice&) = delete;
  ForceDimensionDevice& operator=(const ForceDimensionDevice&) = delete;

  /// [rt] Calls the vendor's library and nothing else. Fault::kDevice: position, velocity or status could not
  /// be read; Fault::kForceOff: the device switched its force off, as long as it stays off.
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt]
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  /// [any]
  void stop() noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;

  /// [setup] By the vendor's name of the device.
  [[nodiscard]] haptics::DeviceAbilities abilities() const override;

  /// [setup] The vendor's name of the device, and the library's version: "omega.7 (libdhd.so.3, 3.17.1.0)".
  [[nodiscard]] std::string description() const;

 private:
  void open(std::size_t ordinal);
  void begin();
  void require_calibrated() const;
  void close() noexcept;
  bool set_force(const haptics::ForceCommand& command_D) noexcept;
  int read_pose(haptics::DeviceState& state) noexcept;
  void read_gripper() noexcept;
  [[nodiscard]] std::uint32_t read_buttons() const noexcept;
  bool ask_status() noexcept;
  void arm_watchdog(unsigned char steps) noexcept;
  [[nodiscard]] std::string calibration_text() const;
  void note(std::uint32_t what, int code) noexcept;

  DhdLibrary library_;
  std::string place_;  // in front of messages
  char id_ = -1;
  bool falcon_ = false;
  bool has_wrist_ = true;
  bool has_gripper_ = false;
  bool watchdog_armed_ = false;
  bool force_off_ = false;
  double gripper_ = 0.0;                   // the last one that was read
  double sampled_ = 0.0;                   // time of the last new sample [s]
  double next_status_ = 0.0;               // [s]
  std::atomic<std::uint32_t> trouble_{0};  // what << 16 | code, 0: nothing yet
};

/// [setup] Whether the library is there and how many devices it sees; opens none. @param library as above
[[nodiscard]] Probe probe_forcedimension(const std::string& library);

}  // namespace palpate::devices
