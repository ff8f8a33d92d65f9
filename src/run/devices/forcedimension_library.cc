#include "run/devices/forcedimension_library.h"

#include <fmt/core.h>

#include "io/system/cache_folder.h"
#include "io/system/file_exists.h"
#include "io/system/files.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "io/system/shared_library.h"
#include "palpate/error.h"
#include "run/devices/vendor_library.h"

namespace palpate::devices {
namespace {

constexpr int kMajor = 3;
constexpr int kOldestMinor = 3;  // first minor version with dhdSetForceAndTorqueAndGripperForce

// The vendor's SDK has the same functions under these names.
constexpr std::array<const char*, 2> kNames = kIsWindows
                                                  ? std::array<const char*, 2>{"dhd64.dll", "dhd64.dll"}
                                                  : std::array<const char*, 2>{"libdhd.so.3", "libdhd.so"};
constexpr const char* kExample = kIsWindows ? "C:\\vendor\\dhd64.dll" : "/path/libdhd.so";
constexpr const char* kAbsoluteExample = kIsWindows ? "C:\\vendor\\dhd64.dll" : "/opt/vendor/lib/libdhd.so.3";

std::string advice() {
  return fmt::format("(the vendor's SDK; give its path with --device forcedimension:{})", kExample);
}

std::string in_front(const std::string& name) { return "device forcedimension: " + name + ": "; }

}  // namespace

DhdLibrary::DhdLibrary(const std::string& path) {
  open(path);
  try {
    load();
    check_version();
  } catch (...) {
    close_library(handle_);
    throw;
  }
}

DhdLibrary::~DhdLibrary() { close_library(handle_); }

void DhdLibrary::open_file(const std::filesystem::path& file) {
  name_ = to_text(file);
  if (is_special_file(file)) {  // the loader would block on a FIFO
    throw InputError(in_front(name_) + "is no regular file, must be the vendor's " + kNames[1] +
                     " for this computer");
  }
  const SharedLibrary library = open_library(file);
  handle_ = library.handle;
  if (handle_ != nullptr) return;
  throw InputError(in_front(name_) + "cannot be loaded (" + library.error + "), must be the vendor's " +
                   kNames[1] + " for this computer");
}

void DhdLibrary::open(const std::string& path) {
  if (!path.empty()) {
    if (to_path(path).is_absolute()) return open_file(to_path(path));
    throw InputError(in_front(path) + "must be an absolute path, such as " + kAbsoluteExample);
  }
  const std::filesystem::path folder = user_config_folder();
  for (const char* name : kNames) {
    if (!folder.empty() && file_exists(folder / name)) {
      const std::string doubt = distrust_reason(folder);
      if (!doubt.empty()) throw InputError(in_front(to_text(folder / name)) + "is not loaded: " + doubt);
      return open_file(folder / name);
    }
    name_ = name;
    const SharedLibrary library = open_library(name);
    handle_ = library.handle;
    if (handle_ != nullptr) return;
    // A library that exists but cannot be loaded gets the loader's message. A missing library gets a plainer
    // message below.
    if (!library.is_missing) {
      throw InputError(fmt::format("{}cannot be loaded ({}) {}", in_front(name_), library.error, advice()));
    }
  }
  throw InputError(fmt::format("device forcedimension: {} is not installed {}", kNames[0], advice()));
}

void DhdLibrary::load() {
  VendorFunctions lookup(handle_);
  DhdFunctions& f = functions_;
  lookup.required(f.GetSDKVersion, "dhdGetSDKVersion");
  lookup.required(f.GetDeviceCount, "dhdGetDeviceCount");
  lookup.required(f.Close, "dhdClose");
  lookup.required(f.Stop, "dhdStop");
  lookup.required(f.GetSystemName, "dhdGetSystemName");
  lookup.required(f.GetStatus, "dhdGetStatus");
  lookup.required(f.EnableForce, "dhdEnableForce");
  lookup.required(f.SetBrakes, "dhdSetBrakes");
  lookup.required(f.GetPositionAndOrientationFrame, "dhdGetPositionAndOrientationFrame");
  lookup.required(f.GetLinearVelocity, "dhdGetLinearVelocity");
  lookup.required(f.GetButton, "dhdGetButton");
  lookup.required(f.SetForceAndTorqueAndGripperForce, "dhdSetForceAndTorqueAndGripperForce");
  lookup.required(f.ErrorGetLast, "dhdErrorGetLast");
  lookup.required(f.ErrorGetLastStr, "dhdErrorGetLastStr");
  lookup.optional(f.OpenID, "dhdOpenID");
  lookup.optional(f.Open, "dhdOpen");
  if (f.OpenID == nullptr) lookup.required(f.Open, "dhdOpen");
  lookup.optional(f.GetButtonMask, "dhdGetButtonMask");
  lookup.optional(f.GetSystemType, "dhdGetSystemType");
  lookup.optional(f.HasWrist, "dhdHasWrist");
  lookup.optional(f.HasGripper, "dhdHasGripper");
  lookup.optional(f.GetPosition, "dhdGetPosition");
  lookup.optional(f.GetGripperAngleRad, "dhdGetGripperAngleRad");
  lookup.optional(f.ErrorGetStr, "dhdErrorGetStr");
  lookup.optional(f.EnableExpertMode, "dhdEnableExpertMode");
  lookup.optional(f.DisableExpertMode, "dhdDisableExpertMode");
  lookup.optional(f.SetWatchdog, "dhdSetWatchdog");
  if (lookup.missing().empty()) return;
  std::string found;
  if (f.GetSDKVersion != nullptr) found = " (its version is " + version() + ")";
  throw InputError(fmt::format("{}has no function {}{}, must be version {}.{} or a later 3.x",
                               in_front(name_), lookup.missing(), found, kMajor, kOldestMinor));
}

std::array<int, 4> DhdLibrary::version_numbers() const {
  std::array<int, 4> v{};
  functions_.GetSDKVersion(&v[0], &v[1], &v[2], &v[3]);
  return v;
}

std::string DhdLibrary::version() const {
  const std::array<int, 4> v = version_numbers();
  return fmt::format("{}.{}.{}.{}", v[0], v[1], v[2], v[3]);
}

void DhdLibrary::check_version() const {
  const std::array<int, 4> v = version_numbers();
  if (v[0] == kMajor && v[1] >= kOldestMinor) return;
  throw InputError(fmt::format("{}is version {}, must be {}.{} or a later 3.x", in_front(name_), version(),
                               kMajor, kOldestMinor));
}

std::string DhdLibrary::last_error() const {
  const char* reason = functions_.ErrorGetLastStr();
  return reason == nullptr ? "error " + std::to_string(functions_.ErrorGetLast()) : reason;
}

}  // namespace palpate::devices
