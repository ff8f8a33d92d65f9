#pragma once
#include <array>
#include <filesystem>
#include <string>

namespace palpate::devices {

// Constants of the vendor's interface, from its documentation; the names are Palpate's.
inline constexpr int kDhdTimeGuarded = 1;  // returned instead of 0: the last sample is repeated
inline constexpr int kDhdStatusSize = 32;  // 16 entries are documented; the others are spare
inline constexpr int kDhdStatusPower = 0;
inline constexpr int kDhdStatusReset = 3;  // not calibrated
inline constexpr int kDhdStatusForce = 5;
inline constexpr int kDhdStatusForceOffCause = 14;
inline constexpr int kDhdButtons = 16;
inline constexpr int kDhdFalcon = 60;  // the type of a Novint Falcon

/// Force Dimension's library, loaded at run time by its documented C interface; the functions' names are the
/// vendor's without "dhd". The last argument identifies the device.
struct DhdFunctions {
  // Required.
  int (*GetDeviceCount)();
  int (*Close)(char id);
  int (*Stop)(char id);  // force off, brakes on
  void (*GetSDKVersion)(int* major, int* minor, int* release, int* revision);
  const char* (*GetSystemName)(char id);
  int (*GetStatus)(int* status, char id);
  int (*EnableForce)(unsigned char on, char id);
  int (*SetBrakes)(int on, char id);
  int (*GetPositionAndOrientationFrame)(double* x, double* y, double* z, double (*rotation)[3], char id);
  int (*GetLinearVelocity)(double* x, double* y, double* z, char id);
  int (*GetButton)(int index, char id);
  int (*SetForceAndTorqueAndGripperForce)(double fx, double fy, double fz, double tx, double ty, double tz,
                                          double gripper, char id);
  int (*ErrorGetLast)();
  const char* (*ErrorGetLastStr)();
  // Null where the library has none.
  int (*Open)();
  int (*OpenID)(char index);
  unsigned (*GetButtonMask)(char id);
  int (*GetSystemType)(char id);
  bool (*HasWrist)(char id);
  bool (*HasGripper)(char id);
  int (*GetPosition)(double* x, double* y, double* z, char id);
  int (*GetGripperAngleRad)(double* angle, char id);
  const char* (*ErrorGetStr)(int error);
  int (*EnableExpertMode)();
  int (*DisableExpertMode)();
  int (*SetWatchdog)(unsigned char steps, char id);
};

/// Force Dimension's library, loaded while this object exists. Objects of one file use one loaded copy.
class DhdLibrary final {
 public:
  /// [setup] @param path the library's file, absolute; empty: libdhd.so.3, else libdhd.so, in the user's
  /// configuration folder (user_config_folder()) or where the system's loader finds it. The current folder is
  /// never searched, because the library's code runs with the user's rights. @throws InputError when the path
  /// is relative, the library is not installed or not a library, lacks a function, or has a wrong version.
  explicit DhdLibrary(const std::string& path);
  ~DhdLibrary();
  DhdLibrary(const DhdLibrary&) = delete;
  DhdLibrary& operator=(const DhdLibrary&) = delete;

  /// [any]
  [[nodiscard]] const DhdFunctions& call() const noexcept { return functions_; }
  /// [setup] As the library reports it: "3.17.1.0".
  [[nodiscard]] std::string version() const;
  /// [setup] The path that the user gave, or the name under which it was found.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// [setup] The vendor's message for the last failed call of this thread.
  [[nodiscard]] std::string last_error() const;

 private:
  void open(const std::string& path);
  void open_file(const std::filesystem::path& file);
  void load();
  void check_version() const;
  [[nodiscard]] std::array<int, 4> version_numbers() const;

  std::string name_;
  void* handle_ = nullptr;
  DhdFunctions functions_{};
};

}  // namespace palpate::devices
