#pragma once
#include <string>

#include "io/system/files.h"
#include "palpate/device.h"

namespace palpate::devices {

// Constants of OpenHaptics' HD interface, from its programming examples; the names are Palpate's.
inline constexpr unsigned kHdSuccess = 0;
inline constexpr unsigned kHdInvalidHandle = 0xFFFFFFFFU;
inline constexpr unsigned kHdCallbackContinue = 1;
inline constexpr unsigned short kHdDefaultPriority = 0x7FFF;  // of 0 to 0xFFFF

inline constexpr unsigned kHdButtons = 0x2000;
inline constexpr unsigned kHdSafetySwitch = 0x2001;   // closed (1): the stylus is held
inline constexpr unsigned kHdInkwellSwitch = 0x2002;  // open (0): the stylus is in the inkwell
inline constexpr unsigned kHdPosition = 0x2050;       // 3 doubles, mm
inline constexpr unsigned kHdVelocity = 0x2051;       // 3 doubles, mm/s
inline constexpr unsigned kHdTransform = 0x2052;      // 16 doubles, by columns
inline constexpr unsigned kHdModel = 0x2501;
inline constexpr unsigned kHdDriverVersion = 0x2502;
inline constexpr unsigned kHdSerialNumber = 0x2504;
inline constexpr unsigned kHdCalibrationStyle = 0x2555;    // one bit per style
inline constexpr unsigned kHdMaxForce = 0x2603;            // N
inline constexpr unsigned kHdMaxContinuousForce = 0x2604;  // N
inline constexpr unsigned kHdMotorTemperature = 0x2605;    // one double per motor, 0 cold, 1 too warm
inline constexpr unsigned kHdForce = 0x2700;               // 3 doubles, N
inline constexpr unsigned kHdForceOutput = 0x4000;

inline constexpr unsigned kHdCalibrated = 0x5000;
inline constexpr unsigned kHdNeedsUpdate = 0x5001;
inline constexpr unsigned kHdNeedsManualInput = 0x5002;
inline constexpr unsigned kHdStyleEncoderReset = 1;
inline constexpr unsigned kHdStyleAuto = 2;
inline constexpr unsigned kHdStyleInkwell = 4;

/// One error, which the vendor's library returns by value.
struct HdErrorInfo {
  unsigned code;
  int internal_code;
  unsigned device;
};

/// Called by the vendor's scheduler on its own thread once per frame. @return whether to continue
using HdCallback = unsigned (*)(void* data);

/// OpenHaptics' HD library, loaded at run time; the functions' names are the vendor's without "hd". State is
/// read and force written only in a callback, between BeginFrame and EndFrame.
struct HdFunctions {
  // Required.
  unsigned (*InitDevice)(const char* name);  // null: the default device
  void (*DisableDevice)(unsigned device);
  void (*MakeCurrentDevice)(unsigned device);
  void (*BeginFrame)(unsigned device);
  void (*EndFrame)(unsigned device);
  HdErrorInfo (*GetError)();  // returns and clears the newest
  void (*Enable)(unsigned what);
  void (*Disable)(unsigned what);
  unsigned char (*IsEnabled)(unsigned what);
  void (*GetBooleanv)(unsigned what, unsigned char* values);
  void (*GetIntegerv)(unsigned what, int* values);
  void (*GetDoublev)(unsigned what, double* values);
  const char* (*GetString)(unsigned what);
  void (*SetDoublev)(unsigned what, const double* values);
  unsigned (*CheckCalibration)();
  void (*UpdateCalibration)(unsigned style);
  void (*StartScheduler)();
  void (*StopScheduler)();
  unsigned long (*ScheduleAsynchronous)(HdCallback callback, void* data, unsigned short priority);
  void (*Unschedule)(unsigned long handle);
  // Null where the library has none.
  void (*SetSchedulerRate)(unsigned long rate_Hz);
  const char* (*GetErrorString)(unsigned code);
};

/// OpenHaptics' HD library. It stays loaded until the process ends, because its scheduler's threads may go
/// on.
class HdLibrary final {
 public:
  /// Name that the system's loader searches for; it does not search the current folder.
  static constexpr const char* kName = kIsWindows ? "hd.dll" : "libHD.so";

  /// [setup] @param file kName, or a file in tests. @throws InputError when it is not installed, not a
  /// library or lacks a function.
  explicit HdLibrary(const std::string& file);

  /// [any]
  [[nodiscard]] const HdFunctions& call() const noexcept { return functions_; }
  /// [any] The newest error; clears all errors. Code kHdSuccess: none.
  HdErrorInfo take_error() const noexcept;

 private:
  HdFunctions functions_{};
};

/// [any] The fault for an OpenHaptics error: kForceOff when the arm has switched its force off (0x0200 to
/// 0x0204), else kDevice.
[[nodiscard]] haptics::Fault fault_of_hd_error(unsigned code) noexcept;

/// [any] The meaning of an error and its remedy: "its motors are too warm (OpenHaptics error 0x0200):
/// let ...". Allocates.
[[nodiscard]] std::string describe_hd_error(unsigned code);

}  // namespace palpate::devices
