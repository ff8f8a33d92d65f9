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

}  // namespace palpate::devices
