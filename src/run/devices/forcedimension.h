#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "palpate/device.h"
#include "run/devices/crash_stop.h"
#include "run/devices/forcedimension_library.h"
#include "run/devices/probe.h"

namespace palpate::devices {

/// A Force Dimension device (delta, omega, sigma, lambda) or a Novint Falcon through Force Dimension's
/// library.
///
/// The device's frame D is the vendor's own base frame: x towards the user, y to the user's right, z up [m];
/// a scene's `base` places it. Opening enables the force, at zero. The first write arms the firmware's
/// watchdog, if there is one, so that the force goes to zero when the program hangs. The vendor's library
/// limits how often it asks the device; between two queries it repeats the last sample ("time-guarded"),
/// whose age then grows. A saturated motor is not an error.
class ForceDimensionDevice final : public haptics::Device {
 public:
  /// Gripper angle [rad] of open jaws; 0 is closed. Its sign differs between left- and right-handed devices.
  static constexpr double kOpenAngle = 0.5;
  /// Period of the status queries [s]; each is a separate message to the device.
  static constexpr double kStatusPeriod = 2e-3;

  /// [setup] Opens the connected device number `ordinal` (0 is the first), enables its force at zero and
  /// waits at most 0.2 s for a sample.
  /// @param library path of the vendor's library; empty: the installed one
  /// @throws InputError when the library cannot be loaded (see DhdLibrary), the device does not exist, cannot
  /// be opened or read, is not calibrated, or its force cannot be enabled.
  ForceDimensionDevice(const std::string& library, std::size_t ordinal);
  ~ForceDimensionDevice() override;
  ForceDimensionDevice(const ForceDimensionDevice&) = delete;
  ForceDimensionDevice& operator=(const ForceDimensionDevice&) = delete;

  /// [rt] Calls only the vendor's library. Fault::kDevice: position, velocity or status cannot be read.
  /// Fault::kForceOff: the device has switched its force off.
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt]
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  /// [any]
  void stop() noexcept override;
  /// [any]
  [[nodiscard]] std::string last_error() const override;

  /// [setup] Looked up by the vendor's name of the device.
  [[nodiscard]] haptics::DeviceAbilities abilities() const override;

  /// [setup] The vendor's name of the device, and the library's version: "omega.7 (libdhd.so.3, 3.17.1.0)".
  [[nodiscard]] std::string description() const;

 private:
  void open(std::size_t ordinal);
  void begin();
  void require_calibrated() const;
  void close() noexcept;
  void switch_off() noexcept;
  bool set_force(const haptics::ForceCommand& command_D) noexcept;
  int read_pose(haptics::DeviceState& state) noexcept;
  void read_gripper() noexcept;
  [[nodiscard]] std::uint32_t read_buttons() const noexcept;
  bool ask_status() noexcept;
  void arm_watchdog(unsigned char steps) noexcept;
  [[nodiscard]] std::string calibration_text() const;
  void note(std::uint32_t what, int code) noexcept;

  DhdLibrary library_;
  std::string message_prefix_;  // prefix of messages
  char id_ = -1;
  bool falcon_ = false;
  bool has_wrist_ = true;
  bool has_gripper_ = false;
  bool watchdog_armed_ = false;
  bool force_off_ = false;
  double gripper_ = 0.0;                      // last reading, 0..1
  double sampled_ = 0.0;                      // time of the last new sample [s]
  double next_status_ = 0.0;                  // [s]
  std::atomic<std::uint32_t> last_error_{0};  // what << 16 | code; 0: none
  std::optional<CrashStop> crash_stop_;       // from the force's switching on to close()
};

/// [setup] Whether the library is installed and how many devices it finds. Opens none. @param library as in
/// ForceDimensionDevice's constructor
[[nodiscard]] Probe probe_forcedimension(const std::string& library);

}  // namespace palpate::devices
