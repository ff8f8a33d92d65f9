#include "run/devices/reasons.h"

#include "io/system/files.h"
#include "io/system/path_text.h"

namespace palpate::devices {

std::string Machine::variable_of_process(const char* name) { return to_text(environment_path(name)); }

bool Machine::may_read_and_write(const std::filesystem::path& file) { return may_write(file); }

std::vector<Reason> forcedimension_reasons(const Machine& /*machine*/, bool library) {
  if (!library)
    return {
        {"dhd64.dll of Force Dimension's SDK is not found", "set PATH=%PATH%;C:\\folder\\of\\the\\SDK\\bin"}};
  return {{"no device is connected and switched on", "devmgmt.msc"}};
}

std::vector<Reason> touch_reasons(const Machine& /*machine*/, bool library) {
  if (!library) return {{"hd.dll of OpenHaptics with the Touch Device Driver is not found", "where hd.dll"}};
  return {{"no arm is set up, connected and switched on", "Touch_Setup"}};
}

std::vector<Reason> haply_reasons(const Machine& /*machine*/) {
  return {{"Haply's Inverse Service does not run on this computer", "services.msc"}};
}

std::vector<Reason> mouse_reasons(const Machine& /*machine*/) {
  return {{"palpate for Windows has no window: use its page", "palpate run --page"}};
}

std::vector<Reason> gamepad_reasons(const Machine& machine) { return mouse_reasons(machine); }

}  // namespace palpate::devices
