// A stand-in for Force Dimension's library with the same C interface, for tests without hardware. Each
// function behaves as the vendor documents it, on simulated devices that a test controls (`dhd_stand_in.h`).
// It is also built in variants that lack something (`STAND_IN_...`).
#include "run/devices/test/stand_in/dhd_stand_in.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <mutex>
#include <string>
#include <thread>

namespace {

using palpate::devices::stand_in::Device;
using palpate::devices::stand_in::kDevices;
using palpate::devices::stand_in::Library;

constexpr double kStep = 1e-3;  // s from one command to the next
constexpr int kInvalidDevice = 5;

Library library;
std::mutex mutex;  // the vendor's library is thread-safe; so is this one
thread_local int last_error = 0;

int fail(int error) {
  last_error = error;
  return -1;
}

int result_of(int result, const Device& device) { return result < 0 ? fail(device.error) : result; }

Device* find(char id) {
  if (id < 0 || id >= kDevices || !library.devices[static_cast<unsigned char>(id)].open) return nullptr;
  return &library.devices[static_cast<unsigned char>(id)];
}

[[maybe_unused]] void take_step(Device& device) {
  if (!(device.mass > 0.0)) return;
  for (int k = 0; k < 3; ++k) {
    const double given = device.force_on ? device.force[k] : 0.0;
    const double force = device.hand_force[k] + given - device.damping * device.velocity[k];
    device.velocity[k] += force / device.mass * kStep;
    device.position[k] += device.velocity[k] * kStep;
  }
}

// For a test of a whole program: a hand of 0.25 kg presses with 0.5 N from command kPress on, and at command
// kFault the fault comes that PALPATE_STAND_IN_FAULT names.
constexpr unsigned long kPress = 900;
constexpr unsigned long kFault = 1300;

std::string scripted_fault() {
  const char* name = std::getenv("PALPATE_STAND_IN_FAULT");
  return name == nullptr ? "" : name;
}

void rest_above_the_organ(Device& device) {
  device.mass = 0.25;
  device.damping = 5.0;
  device.position[2] = 0.03;
}

[[maybe_unused]] void play_script(Device& device) {
  const std::string fault = scripted_fault();
  if (fault.empty()) return;
  if (device.writes == kPress) device.hand_force[2] = -0.5;
  if (device.writes != kFault) return;
  device.error = 2;
  if (fault == "unreadable") device.pose_result = -1;
  if (fault == "refused") device.write_result = -1;
  if (fault == "stale") device.pose_result = 1;
  if (fault == "nan") device.position[1] = std::numeric_limits<double>::quiet_NaN();
  if (fault == "too-fast") device.force_off_cause = 2;
  if (fault == "usb-lost") device.force_off_cause = 5;
}

/// Calls `use(device)` with the open device `id`. @return its result, or -1 when no such device is open
template <typename Use>
int with(char id, Use use) {
  const std::lock_guard lock(mutex);
  Device* device = find(id);
  return device == nullptr ? fail(kInvalidDevice) : use(*device);
}

int open_number(int index) {
  if (index < 0 || index >= library.count || index >= kDevices) return fail(kInvalidDevice);
  Device& device = library.devices[index];
  if (device.open_result < 0) return fail(device.error);
  device.open = true;
  ++device.opens;
  if (!scripted_fault().empty()) rest_above_the_organ(device);
  return index;
}

/// Position that a pose call reads. A time-guarded call reads the previous sample.
const double* sample(Device& device) {
  if (device.pose_result != 1) std::copy_n(device.position, 3, device.guarded_position);
  return device.guarded_position;
}

}  // namespace

// The names are the vendor's.
// NOLINTBEGIN
extern "C" {

__attribute__((visibility("default"))) Library* palpate_stand_in() { return &library; }

void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
#ifdef STAND_IN_OLD
  const int version[4] = {3, 2, 2, 1466};
#else
  const int* version = library.version;
#endif
  *major = version[0];
  *minor = version[1];
  *release = version[2];
  *revision = version[3];
}

int dhdGetDeviceCount() { return library.count < 0 ? fail(2) : library.count; }

#ifndef STAND_IN_BARE
int dhdOpenID(char index) {
  const std::lock_guard lock(mutex);
  return open_number(index);
}
#endif

int dhdOpen() {
  const std::lock_guard lock(mutex);
  for (int index = 0; index < library.count && index < kDevices; ++index) {
    if (!library.devices[index].open) return open_number(index);
  }
  return fail(kInvalidDevice);
}

int dhdClose(char id) {
  return with(id, [](Device& device) {
    device.open = false;
    ++device.closes;
    return 0;
  });
}

int dhdStop(char id) {
  return with(id, [](Device& device) {
    device.force_on = false;
    device.brakes = true;
    return 0;
  });
}

const char* dhdGetSystemName(char) { return "stand-in.7"; }

int dhdGetStatus(int* status, char id) {
  return with(id, [status](Device& device) {
    if (device.force_off_cause != 0) device.force_on = false;
    std::fill_n(status, 16, 0);
    status[0] = device.powered ? 1 : 0;
    status[1] = 1;
    status[3] = device.uncalibrated ? 1 : 0;
    status[5] = device.force_on && device.powered && !device.uncalibrated ? 1 : 0;
    status[14] = device.force_off_cause;
    return result_of(device.status_result, device);
  });
}

int dhdEnableForce(unsigned char on, char id) {
  return with(id, [on](Device& device) {
    if (device.enable_result < 0) return fail(device.error);
    device.force_on = on != 0;
    return 0;
  });
}

int dhdSetBrakes(int on, char id) {
  return with(id, [on](Device& device) {
    device.brakes = on != 0;
    return 0;
  });
}

int dhdGetPositionAndOrientationFrame(double* x, double* y, double* z, double (*rotation)[3], char id) {
  return with(id, [=](Device& device) {
    const double* p = sample(device);
    *x = p[0];
    *y = p[1];
    *z = p[2];
    for (int row = 0; row < 3; ++row) std::copy_n(device.rotation[row], 3, rotation[row]);
    return result_of(device.pose_result, device);
  });
}

int dhdGetLinearVelocity(double* x, double* y, double* z, char id) {
  return with(id, [=](Device& device) {
    *x = device.velocity[0];
    *y = device.velocity[1];
    *z = device.velocity[2];
    return result_of(device.velocity_result, device);
  });
}

int dhdGetButton(int index, char id) {
  return with(id,
              [index](Device& device) { return static_cast<int>(device.buttons >> unsigned(index) & 1U); });
}

#ifndef STAND_IN_NO_FORCE
int dhdSetForceAndTorqueAndGripperForce(double fx, double fy, double fz, double tx, double ty, double tz,
                                        double gripper, char id) {
  static std::atomic<unsigned long> commands{0};
  if (++commands == kFault && scripted_fault() == "hung")
    std::this_thread::sleep_for(std::chrono::seconds(1));
  return with(id, [=](Device& device) {
    if (device.write_result < 0) return fail(device.error);
    const double force[3] = {fx, fy, fz};
    const double torque[3] = {tx, ty, tz};
    std::copy_n(force, 3, device.force);
    std::copy_n(torque, 3, device.torque);
    device.gripper_force = gripper;
    ++device.writes;
    play_script(device);
    take_step(device);
    return device.write_result;
  });
}
#endif

int dhdErrorGetLast() { return last_error; }

const char* dhdErrorGetLastStr() { return "the stand-in's last error"; }

#ifndef STAND_IN_BARE
unsigned dhdGetButtonMask(char id) {
  const std::lock_guard lock(mutex);
  const Device* device = find(id);
  return device == nullptr ? 0 : device->buttons;
}

int dhdGetSystemType(char id) {
  return with(id, [](Device& device) { return device.type; });
}

bool dhdHasWrist(char id) {
  const std::lock_guard lock(mutex);
  const Device* device = find(id);
  return device != nullptr && device->has_wrist;
}

bool dhdHasGripper(char id) {
  const std::lock_guard lock(mutex);
  const Device* device = find(id);
  return device != nullptr && device->has_gripper;
}

int dhdGetPosition(double* x, double* y, double* z, char id) {
  return with(id, [=](Device& device) {
    const double* p = sample(device);
    *x = p[0];
    *y = p[1];
    *z = p[2];
    return result_of(device.pose_result, device);
  });
}

int dhdGetGripperAngleRad(double* angle, char id) {
  return with(id, [angle](Device& device) {
    *angle = device.gripper_angle;
    return 0;
  });
}

const char* dhdErrorGetStr(int error) {
  return error == 2 ? "the stand-in lost its cable" : "the stand-in's other error";
}

int dhdEnableExpertMode() {
  library.expert = true;
  return 0;
}

int dhdDisableExpertMode() {
  library.expert = false;
  return 0;
}

int dhdSetWatchdog(unsigned char steps, char id) {
  constexpr int kExpertDisabled = 9;
  return with(id, [steps](Device& device) {
    if (!library.expert) return fail(kExpertDisabled);
    device.watchdog = steps;
    return 0;
  });
}
#endif

}  // extern "C"
// NOLINTEND
