// A stand-in for OpenHaptics' HD library with the same C interface, for tests without hardware. Each function
// behaves as the vendor documents it, on simulated arms that a test controls (`hd_stand_in.h`). The scheduler
// has its own thread, which calls back at 1 kHz or once per step that the test asks for.
#include "run/devices/test/stand_in/hd_stand_in.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>

namespace {

using palpate::devices::stand_in::HdArm;
using palpate::devices::stand_in::HdWorld;
using palpate::devices::stand_in::kHdArms;

using Callback = unsigned (*)(void*);

struct ErrorInfo {
  unsigned code;
  int internal_code;
  unsigned device;
};

struct Scheduled {
  unsigned long handle = 0;
  Callback callback = nullptr;
  void* data = nullptr;
};

constexpr unsigned kInvalid = 0xFFFFFFFFU;
constexpr unsigned kBadHandle = 0x0104;
constexpr unsigned kAlreadyOpen = 0x0301;
constexpr unsigned kCommunication = 0x0302;

HdWorld world;
std::vector<ErrorInfo> errors;
std::vector<Scheduled> scheduled;
unsigned current = kInvalid;
unsigned framed = kInvalid;  // the arm whose frame is open
unsigned long handles = 0;
std::atomic<bool> running{false};
std::thread scheduler;

HdArm* find(unsigned device) {
  return device < kHdArms && world.arms[device].open ? &world.arms[device] : nullptr;
}

void fail(unsigned code, unsigned device) {
  if (code != 0) errors.push_back({code, -1, device});
}

/// The current arm. Its state may be read only on the scheduler's thread, within a frame of this arm; other
/// calls are counted as illegal.
HdArm* framed_arm() {
  const bool legal = std::this_thread::get_id() == scheduler.get_id() && framed == current;
  HdArm* arm = find(current);
  if (!legal || arm == nullptr) ++world.illegal;
  return legal ? arm : nullptr;
}

bool next_frame_is_due() {
  std::unique_lock lock(world.mutex);
  if (world.stepped) {
    const auto due = [] { return world.stepped && world.done < world.asked; };
    return world.changed.wait_for(lock, std::chrono::milliseconds(1), due);
  }
  lock.unlock();
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  lock.lock();
  return !world.silent;
}

void serve() {
  { const std::lock_guard lock(world.mutex); }  // waits until the starter has stored the thread
  while (running.load()) {
    if (!next_frame_is_due()) continue;
    std::vector<Scheduled> now;
    {
      const std::lock_guard lock(world.mutex);
      now = scheduled;
    }
    for (const Scheduled& one : now) one.callback(one.data);
    const std::lock_guard lock(world.mutex);
    if (world.stepped) ++world.done;
    world.changed.notify_all();
  }
}

}  // namespace

// The names are the vendor's.
// NOLINTBEGIN
extern "C" {

__attribute__((visibility("default"))) HdWorld* palpate_hd_stand_in() { return &world; }

unsigned hdInitDevice(const char* name) {
  const std::lock_guard lock(world.mutex);
  const char* wanted = name == nullptr ? "Default Device" : name;
  for (unsigned device = 0; device < kHdArms; ++device) {
    HdArm& arm = world.arms[device];
    if (std::strcmp(arm.name, wanted) != 0) continue;
    const unsigned error = arm.open ? kAlreadyOpen : arm.init_error;
    fail(error, kInvalid);
    if (error != 0) return kInvalid;
    if (const char* motors = std::getenv("PALPATE_STAND_IN_MOTORS")) {  // for a test of the whole program
      arm.temperatures.assign(3, std::atof(motors));
    }
    arm.open = true;
    ++arm.opens;
    return current = device;
  }
  fail(kCommunication, kInvalid);
  return kInvalid;
}

void hdDisableDevice(unsigned device) {
  const std::lock_guard lock(world.mutex);
  HdArm* arm = find(device);
  if (arm == nullptr) return fail(kBadHandle, device);
  arm->open = false;
  ++arm->closes;
  world.order.push_back("close");
}

void hdMakeCurrentDevice(unsigned device) {
  const std::lock_guard lock(world.mutex);
  if (find(device) == nullptr) return fail(kBadHandle, device);
  current = device;
}

void hdBeginFrame(unsigned device) {
  const std::lock_guard lock(world.mutex);
  if (find(device) == nullptr) return fail(kBadHandle, device);
  if (std::this_thread::get_id() != scheduler.get_id()) ++world.illegal;
  current = framed = device;
  fail(find(device)->begin_error, device);
}

void hdEndFrame(unsigned device) {
  const std::lock_guard lock(world.mutex);
  HdArm* arm = find(device);
  if (arm == nullptr || framed != device) return fail(0x0402, device);
  framed = kInvalid;
  ++arm->frames;
  fail(arm->frame_error, device);
}

ErrorInfo hdGetError() {
  const std::lock_guard lock(world.mutex);
  if (errors.empty()) return {0, 0, kInvalid};
  const ErrorInfo newest = errors.back();
  errors.pop_back();
  return newest;
}

const char* hdGetErrorString(unsigned) { return "the stand-in's error"; }

void hdEnable(unsigned what) {
  const std::lock_guard lock(world.mutex);
  HdArm* arm = find(current);
  if (arm == nullptr) return fail(kBadHandle, current);
  if (arm->enable_error != 0) return fail(arm->enable_error, current);
  if (what == 0x4000) arm->force_enabled = true;
}

void hdDisable(unsigned what) {
  const std::lock_guard lock(world.mutex);
  HdArm* arm = find(current);
  if (arm == nullptr) return fail(kBadHandle, current);
  if (what == 0x4000) arm->force_enabled = false;
  world.order.push_back("disable force");
}

unsigned char hdIsEnabled(unsigned what) {
  const std::lock_guard lock(world.mutex);
  const HdArm* arm = find(current);
  return arm != nullptr && what == 0x4000 && arm->force_enabled ? 1 : 0;
}

void hdGetBooleanv(unsigned what, unsigned char* values) {
  const std::lock_guard lock(world.mutex);
  const HdArm* arm = framed_arm();
  if (arm == nullptr) return;
  if (what == 0x2001) *values = arm->held ? 1 : 0;
  if (what == 0x2002) *values = arm->in_inkwell ? 0 : 1;
}

void hdGetIntegerv(unsigned what, int* values) {
  const std::lock_guard lock(world.mutex);
  if (what == 0x2555) {
    *values = world.arms[current].calibration_style;
  } else if (const HdArm* arm = framed_arm(); arm != nullptr && what == 0x2000) {
    *values = arm->buttons;
  }
}

void hdGetDoublev(unsigned what, double* values) {
  const std::lock_guard lock(world.mutex);
  if (what == 0x2603) {
    *values = world.arms[current].max_force;
    return;
  }
  if (what == 0x2604) {
    *values = world.arms[current].continuous_force;
    return;
  }
  HdArm* arm = framed_arm();
  if (arm == nullptr) return;
  if (what == 0x2605) {
    ++arm->temperatures_asked;
    if (arm->temperatures.empty()) return fail(0x0100, current);
    std::copy(arm->temperatures.begin(), arm->temperatures.end(), values);
  }
  if (what == 0x2050) std::copy_n(arm->position, 3, values);
  if (what == 0x2051) std::copy_n(arm->velocity, 3, values);
  if (what == 0x2052) std::copy_n(arm->transform, 16, values);
}

const char* hdGetString(unsigned what) {
  switch (what) {
    case 0x2501:
      return "Stand-in Touch";
    case 0x2502:
      return "4.0";
    case 0x2504:
      return "1234";
    default:
      return nullptr;
  }
}

#ifndef STAND_IN_NO_FORCE
void hdSetDoublev(unsigned what, const double* values) {
  const std::lock_guard lock(world.mutex);
  HdArm* arm = framed_arm();
  if (arm == nullptr || what != 0x2700) return;
  const bool zero = values[0] == 0.0 && values[1] == 0.0 && values[2] == 0.0;
  const bool was_zero = arm->force[0] == 0.0 && arm->force[1] == 0.0 && arm->force[2] == 0.0;
  if (zero && !was_zero) world.order.push_back("zero");
  std::copy_n(values, 3, arm->force);
}
#endif

unsigned hdCheckCalibration() {
  const std::lock_guard lock(world.mutex);
  return world.arms[current].calibration;
}

void hdUpdateCalibration(unsigned style) {
  const std::lock_guard lock(world.mutex);
  HdArm& arm = world.arms[current];
  ++arm.updates;
  arm.update_style = style;
  arm.calibration = arm.after_update;
}

void hdSetSchedulerRate(unsigned long rate) {
  const std::lock_guard lock(world.mutex);
  world.rate = rate;
}

void hdStartScheduler() {
  const std::lock_guard lock(world.mutex);
  fail(world.start_error, kInvalid);
  if (world.start_error != 0 || running.load()) return;
  running.store(true);
  world.running = true;
  ++world.starts;
  scheduler = std::thread(serve);
}

void hdStopScheduler() {
  {
    const std::lock_guard lock(world.mutex);
    world.running = false;
    world.order.push_back("stop");
  }
  running.store(false);
  if (scheduler.joinable()) scheduler.join();
}

unsigned long hdScheduleAsynchronous(Callback callback, void* data, unsigned short) {
  const std::lock_guard lock(world.mutex);
  scheduled.push_back({++handles, callback, data});
  world.callbacks = static_cast<int>(scheduled.size());
  return handles;
}

void hdUnschedule(unsigned long handle) {
  const std::lock_guard lock(world.mutex);
  scheduled.erase(std::remove_if(scheduled.begin(), scheduled.end(),
                                 [handle](const Scheduled& one) { return one.handle == handle; }),
                  scheduled.end());
  world.callbacks = static_cast<int>(scheduled.size());
}

}  // extern "C"
// NOLINTEND
