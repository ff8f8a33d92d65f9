#include "run/devices/forcedimension_library.h"

#include <filesystem>
#include <system_error>

#include <dlfcn.h>
#include <fmt/core.h>

#include "io/system/cache_folder.h"
#include "io/system/file_exists.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "run/devices/vendor_library.h"

namespace palpate::devices {
namespace {

constexpr int kMajor = 3;
constexpr int kOldestMinor = 3;  // first minor version with dhdSetForceAndTorqueAndGripperForce

const char* const kAdvice = "(the vendor's SDK; give its path with --device forcedimension:/path/libdhd.so)";

std::string in_front(const std::string& name) { return "device forcedimension: " + name + ": "; }

}  // namespace

DhdLibrary::DhdLibrary(const std::string& path) {
  open(path);
  try {
    load();
    check_version();
  } catch (...) {
    dlclose(handle_);
    throw;
  }
}

DhdLibrary::~DhdLibrary() { dlclose(handle_); }

void DhdLibrary::open_file(const std::filesystem::path& file) {
  name_ = file.string();
  if (is_special_file(file)) {  // the loader would block on a FIFO
    throw InputError(in_front(name_) +
                     "is no regular file, must be the vendor's libdhd.so for this computer");
  }
  handle_ = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ != nullptr) return;
  throw InputError(in_front(name_) + "cannot be loaded (" + loader_text() +
                   "), must be the vendor's libdhd.so for this computer");
}

void DhdLibrary::open(const std::string& path) {
  if (!path.empty()) {
    if (std::filesystem::path(path).is_absolute()) return open_file(path);
    throw InputError(in_front(path) + "must be an absolute path, such as /opt/vendor/lib/libdhd.so.3");
  }
  const std::filesystem::path folder = user_config_folder();
  std::string reason;
  for (const char* name : {"libdhd.so.3", "libdhd.so"}) {
    if (!folder.empty() && file_exists(folder / name)) {
      const std::string doubt = distrust_reason(folder);
      if (!doubt.empty()) throw InputError(in_front((folder / name).string()) + "is not loaded: " + doubt);
      return open_file(folder / name);
    }
    name_ = name;
    handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (handle_ != nullptr) return;
    reason = loader_text();
    // A library that exists but cannot be loaded gets the loader's message. A missing library gets a plainer
    // message below.
    if (reason.rfind(name_ + ": cannot open shared object file", 0) != 0) {
      throw InputError(fmt::format("{}cannot be loaded ({}) {}", in_front(name_), reason, kAdvice));
    }
  }
  throw InputError(std::string("device forcedimension: libdhd.so.3 is not installed ") + kAdvice);
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
