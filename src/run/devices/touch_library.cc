#include "run/devices/touch_library.h"

#include <fmt/core.h>

#include "io/system/shared_library.h"
#include "palpate/error.h"
#include "run/devices/vendor_library.h"

namespace palpate::devices {
namespace {

constexpr int kMaxHdErrors = 64;  // most errors read at once; a library may report errors without end

void look_up(VendorFunctions& lookup, HdFunctions& f) {
  lookup.required(f.InitDevice, "hdInitDevice");
  lookup.required(f.DisableDevice, "hdDisableDevice");
  lookup.required(f.MakeCurrentDevice, "hdMakeCurrentDevice");
  lookup.required(f.BeginFrame, "hdBeginFrame");
  lookup.required(f.EndFrame, "hdEndFrame");
  lookup.required(f.GetError, "hdGetError");
  lookup.required(f.Enable, "hdEnable");
  lookup.required(f.Disable, "hdDisable");
  lookup.required(f.IsEnabled, "hdIsEnabled");
  lookup.required(f.GetBooleanv, "hdGetBooleanv");
  lookup.required(f.GetIntegerv, "hdGetIntegerv");
  lookup.required(f.GetDoublev, "hdGetDoublev");
  lookup.required(f.GetString, "hdGetString");
  lookup.required(f.SetDoublev, "hdSetDoublev");
  lookup.required(f.CheckCalibration, "hdCheckCalibration");
  lookup.required(f.UpdateCalibration, "hdUpdateCalibration");
  lookup.required(f.StartScheduler, "hdStartScheduler");
  lookup.required(f.StopScheduler, "hdStopScheduler");
  lookup.required(f.ScheduleAsynchronous, "hdScheduleAsynchronous");
  lookup.required(f.Unschedule, "hdUnschedule");
  lookup.optional(f.SetSchedulerRate, "hdSetSchedulerRate");
  lookup.optional(f.GetErrorString, "hdGetErrorString");
}

struct HdErrorWords {
  unsigned code;
  const char* what;
  const char* mend;
};

constexpr HdErrorWords kHdErrors[] = {
    {0x0200, "its motors are too warm", "let the arm rest for some minutes, then reset the fault"},
    {0x0201, "it was asked for more force than it can give",
     "lower max_force_N under [safety], then reset the fault"},
    {0x0202, "the force changed faster than it allows",
     "lower max_slew_N_per_ms under [safety], then reset the fault"},
    {0x0203, "it moved faster than it allows", "move it more slowly, then reset the fault"},
    {0x0204, "its force output failed", "switch the arm off and on, then begin again"},
    {0x0300, "the arm is faulty or does not answer",
     "switch it off and on, look at it with Touch_Diagnostic, then begin again"},
    {0x0301, "it is open already",
     "end the other program that uses it; each of two arms needs its own name, --device touch:NAME"},
    {0x0302, "the arm does not communicate",
     "look at its cable and power, give yourself rights on its port (sudo usermod -aG dialout $USER, then "
     "log in again), run Touch_Setup"},
    {0x0303, "its communication is not configured",
     "run Touch_Setup as this user, with GTDD_HOME set as for this program"},
    {0x0304, "the vendor's timer failed", "end other programs that use the arm, then begin again"},
    {0x0402, "the vendor's library lost its frame", "reset the fault; if it comes again, begin again"},
    {0x0501, "the vendor's scheduler is full", "end other programs that use the arm, then begin again"},
    {0x0600, "OpenHaptics has no valid licence",
     "install the licence of your OpenHaptics edition as its manual says, then begin again"},
};

constexpr unsigned kFirstForceError = 0x0200;
constexpr unsigned kLastForceError = 0x0204;

}  // namespace

HdLibrary::HdLibrary(const std::string& file) {
  const SharedLibrary library = open_library(file, Loading::kForever);
  if (library.handle == nullptr) {
    // A missing library gets a plain message. A library that exists but cannot be loaded gets the loader's
    // message.
    if (library.is_missing) {
      throw InputError(fmt::format(
          "device touch: {} is not installed: install 3D Systems' OpenHaptics and Touch Device Driver{} "
          "(docs/devices.md)",
          file, kIsWindows ? "" : ", then sudo ldconfig"));
    }
    throw InputError(
        fmt::format("device touch: {}: cannot be loaded ({}), must be OpenHaptics' library for this computer "
                    "with the Touch Device Driver beside it",
                    file, library.error));
  }
  VendorFunctions lookup(library.handle);
  look_up(lookup, functions_);
  close_library(library.handle);  // it stays loaded
  if (lookup.missing().empty()) return;
  throw InputError(fmt::format("device touch: {}: has no function {}, must be OpenHaptics 3.4 or later", file,
                               lookup.missing()));
}

HdErrorInfo HdLibrary::take_error() const noexcept {
  HdErrorInfo newest = functions_.GetError();
  HdErrorInfo older = newest;
  for (int i = 0; i < kMaxHdErrors && older.code != kHdSuccess; ++i) older = functions_.GetError();
  return newest;
}

haptics::Fault fault_of_hd_error(unsigned code) noexcept {
  const bool force = code >= kFirstForceError && code <= kLastForceError;
  return force ? haptics::Fault::kForceOff : haptics::Fault::kDevice;
}

std::string describe_hd_error(unsigned code) {
  for (const HdErrorWords& error : kHdErrors) {
    if (error.code == code)
      return fmt::format("{} (OpenHaptics error 0x{:04x}): {}", error.what, code, error.mend);
  }
  return fmt::format(
      "OpenHaptics error 0x{:04x}: switch the arm off and on, look at it with Touch_Diagnostic, then begin "
      "again",
      code);
}

}  // namespace palpate::devices
