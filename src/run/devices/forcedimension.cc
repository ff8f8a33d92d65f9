#include "run/devices/forcedimension.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/core.h>

#include "palpate/error.h"
#include "run/devices/models.h"

namespace palpate::devices {
namespace {

// Values of the upper 16 bits of last_error_. The lower 16 bits contain the vendor's error number or
// force-off cause.
constexpr std::uint32_t kNotRead = 1;
constexpr std::uint32_t kNoStatus = 2;
constexpr std::uint32_t kRefused = 3;
constexpr std::uint32_t kForceOff = 4;
constexpr std::uint32_t kUncalibrated = 5;  // force off without a cause; the device waits for calibration
constexpr std::uint32_t kNoPower = 6;       // force off without a cause; the device has no power

constexpr int kOn = 1;
constexpr unsigned char kWatchdogSteps = 160;  // steps of 125 us: 20 ms, as haptics::kStalledAfter
constexpr std::chrono::milliseconds kOpeningStep{10};
constexpr int kOpeningSteps = 20;

const char* describe_cause(int cause) noexcept {
  switch (cause) {
    case 1:
      return "its force button was pressed";
    case 2:
      return "it moved faster than its velocity limit";
    case 3:
      return "its watchdog had no command for 20 ms";
    case 4:
      return "a program switched the force off";
    case 5:
      return "the USB connection was lost";
    case 6:
      return "its dead-man switch was released";
    default:
      return "it does not say why";
  }
}

std::string force_off_text(int cause) {
  return std::string("the device switched its force off: ") + describe_cause(cause) +
         "; press its force button until its light is on";
}

const char* const kCalibrateWords =
    "the device is not calibrated: put its end where the vendor's manual says until its light stops blinking";

/// Why a status reports the force as off: what << 16 | code. 0 when the force is on.
std::uint32_t force_off_in(const int* status) noexcept {
  if (status[kDhdStatusForce] == kOn) return 0;
  const int cause = status[kDhdStatusForceOffCause];
  if (cause > 0) return kForceOff << 16U | (static_cast<std::uint32_t>(cause) & 0xFFFFU);
  if (status[kDhdStatusReset] == kOn) return kUncalibrated << 16U;
  if (status[kDhdStatusPower] != kOn) return kNoPower << 16U;
  return kForceOff << 16U;
}

}  // namespace

ForceDimensionDevice::ForceDimensionDevice(const std::string& library, std::size_t ordinal)
    : library_(library), message_prefix_("device forcedimension: ") {
  open(ordinal);
  try {
    begin();
  } catch (...) {
    close();
    throw;
  }
}

ForceDimensionDevice::~ForceDimensionDevice() { close(); }

void ForceDimensionDevice::open(std::size_t ordinal) {
  const DhdFunctions& call = library_.call();
  const int count = call.GetDeviceCount();
  if (count < 0) throw InputError(message_prefix_ + "cannot look for devices: " + library_.last_error());
  if (static_cast<std::size_t>(count) <= ordinal) {
    throw InputError(fmt::format(
        "{}{}, must be at least {}, switched on and open to this user (docs/devices.md)", message_prefix_,
        count == 0 ? "no device is connected" : std::to_string(count) + " connected", ordinal + 1));
  }
  // Without dhdOpenID, dhdOpen opens the first device that is not open yet. That device is the next in order.
  const int id = call.OpenID != nullptr ? call.OpenID(static_cast<char>(ordinal)) : call.Open();
  if (id < 0) {
    throw InputError(
        fmt::format("{}device {} cannot be opened: {}, must be switched on, open to this user and used by no "
                    "other program (docs/devices.md)",
                    message_prefix_, ordinal, library_.last_error()));
  }
  id_ = static_cast<char>(id);
}

/// Prepares an opened device for the first tick. It reads the abilities, requires calibration, switches the
/// force on and waits until the samples are readable.
void ForceDimensionDevice::begin() {
  const DhdFunctions& call = library_.call();
  falcon_ = call.GetSystemType != nullptr && call.GetSystemType(id_) == kDhdFalcon;
  const bool six = !falcon_ && (call.HasWrist == nullptr || call.HasWrist(id_));
  has_wrist_ = six || call.GetPosition == nullptr;
  has_gripper_ =
      !falcon_ && call.GetGripperAngleRad != nullptr && (call.HasGripper == nullptr || call.HasGripper(id_));
  require_calibrated();
  set_force({});
  crash_stop_.emplace([](void* self) noexcept { static_cast<ForceDimensionDevice*>(self)->switch_off(); },
                      this);
  if (call.EnableForce(kOn, id_) < 0) {
    throw InputError(message_prefix_ + "its force cannot be switched on: " + library_.last_error());
  }
  // The velocity needs a few samples, and the force needs a moment to switch on.
  for (int step = 0;; ++step) {
    haptics::DeviceState first;
    if (set_force({}) && read_pose(first) >= 0 && ask_status() && !force_off_) break;
    if (step == kOpeningSteps) throw InputError(message_prefix_ + last_error());
    std::this_thread::sleep_for(kOpeningStep);
  }
  read_gripper();
  last_error_.store(0, std::memory_order_relaxed);
}

void ForceDimensionDevice::require_calibrated() const {
  int status[kDhdStatusSize] = {};
  if (library_.call().GetStatus(status, id_) < 0) {
    throw InputError(message_prefix_ + "its status cannot be read: " + library_.last_error());
  }
  if (status[kDhdStatusReset] == kOn) throw InputError(message_prefix_ + calibration_text());
}

/// Zero force, force off, brakes on. A program that crashes calls it, too: another thread may be about to
/// write a force, which has no effect after dhdStop.
void ForceDimensionDevice::switch_off() noexcept {
  set_force({});
  library_.call().SetBrakes(kOn, id_);
  library_.call().Stop(id_);
}

void ForceDimensionDevice::close() noexcept {
  crash_stop_.reset();
  if (watchdog_armed_) {
    set_force({});
    arm_watchdog(0);  // otherwise the firmware's watchdog stays armed after this program
  }
  switch_off();
  library_.call().Close(id_);
}

haptics::DeviceState ForceDimensionDevice::read(std::uint64_t tick, double time) noexcept {
  if (tick == 0) sampled_ = next_status_ = time;
  haptics::DeviceState state;
  const int result = read_pose(state);
  if (result >= 0 && result != kDhdTimeGuarded) sampled_ = time;
  state.age = std::max(0.0, time - sampled_);
  read_gripper();
  state.gripper = gripper_;
  state.buttons = read_buttons();
  bool status_read = true;
  if (time >= next_status_ || force_off_) {
    status_read = ask_status();
    next_status_ = time + kStatusPeriod;
  }
  if (force_off_) {
    state.fault = haptics::Fault::kForceOff;
  } else if (result < 0 || !status_read) {
    state.fault = haptics::Fault::kDevice;
  }
  return state;
}

/// Reads position, orientation and velocity. @return the result of the position's call, or a negative number
int ForceDimensionDevice::read_pose(haptics::DeviceState& state) noexcept {
  const DhdFunctions& call = library_.call();
  Vec3& p = state.position_D;
  Vec3& v = state.velocity_D;
  int result = 0;
  if (has_wrist_) {
    double rotation[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    result = call.GetPositionAndOrientationFrame(&p[0], &p[1], &p[2], rotation, id_);
    Mat3 m;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) m(row, column) = rotation[row][column];
    }
    if (result >= 0) state.orientation_D = Quat(m);
  } else {
    result = call.GetPosition(&p[0], &p[1], &p[2], id_);
  }
  if (result < 0 || call.GetLinearVelocity(&v[0], &v[1], &v[2], id_) < 0) {
    note(kNotRead, call.ErrorGetLast());
    return -1;
  }
  return result;
}

void ForceDimensionDevice::read_gripper() noexcept {
  double angle = 0.0;
  if (!has_gripper_ || library_.call().GetGripperAngleRad(&angle, id_) < 0) return;
  gripper_ = std::clamp(std::abs(angle) / kOpenAngle, 0.0, 1.0);
}

std::uint32_t ForceDimensionDevice::read_buttons() const noexcept {
  const DhdFunctions& call = library_.call();
  if (call.GetButtonMask != nullptr) return call.GetButtonMask(id_);
  std::uint32_t mask = 0;
  for (int index = 0; index < kDhdButtons; ++index) {
    if (call.GetButton(index, id_) == kOn) mask |= std::uint32_t{1} << static_cast<unsigned>(index);
  }
  return mask;
}

/// Reads whether the force is on. @return false when the status cannot be read; force_off_ then does not
/// change
bool ForceDimensionDevice::ask_status() noexcept {
  int status[kDhdStatusSize] = {};
  if (library_.call().GetStatus(status, id_) < 0) {
    note(kNoStatus, library_.call().ErrorGetLast());
    return false;
  }
  const std::uint32_t off = force_off_in(status);
  force_off_ = off != 0;
  if (force_off_) last_error_.store(off, std::memory_order_relaxed);
  return true;
}

bool ForceDimensionDevice::write(const haptics::ForceCommand& command_D) noexcept {
  if (!watchdog_armed_) arm_watchdog(kWatchdogSteps);
  return set_force(command_D);
}

bool ForceDimensionDevice::set_force(const haptics::ForceCommand& command_D) noexcept {
  const bool off = is_crashing();
  const Vec3 f = off ? Vec3(Vec3::Zero()) : command_D.force;
  const Vec3 t = off || !has_wrist_ ? Vec3(Vec3::Zero()) : command_D.torque;
  const double gripper = off || !has_gripper_ ? 0.0 : command_D.gripper_force;
  // A result of 0 or more is a success. The vendor returns a positive one for a time-guarded call or a
  // saturated motor.
  const int result = library_.call().SetForceAndTorqueAndGripperForce(f.x(), f.y(), f.z(), t.x(), t.y(),
                                                                      t.z(), gripper, id_);
  if (result < 0) note(kRefused, library_.call().ErrorGetLast());
  return result >= 0;
}

/// Sets the firmware's watchdog, where library and device have one. The vendor offers this function only in
/// expert mode, which is left again at once.
void ForceDimensionDevice::arm_watchdog(unsigned char steps) noexcept {
  const DhdFunctions& call = library_.call();
  watchdog_armed_ = true;
  if (call.SetWatchdog == nullptr || call.EnableExpertMode == nullptr || call.DisableExpertMode == nullptr) {
    return;
  }
  call.EnableExpertMode();
  call.SetWatchdog(steps, id_);
  call.DisableExpertMode();
}

void ForceDimensionDevice::stop() noexcept {
  // The vendor documents the library as thread-safe. set_force() changes only an atomic of this object.
  set_force({});
}

void ForceDimensionDevice::note(std::uint32_t what, int code) noexcept {
  last_error_.store(what << 16U | (static_cast<std::uint32_t>(code) & 0xFFFFU), std::memory_order_relaxed);
}

std::string ForceDimensionDevice::calibration_text() const {
  return falcon_ ? "the device is not calibrated: draw its grip out as far as it goes and push it in again, "
                   "slowly, until its light changes"
                 : kCalibrateWords;
}

std::string ForceDimensionDevice::last_error() const {
  const std::uint32_t last_error = last_error_.load(std::memory_order_relaxed);
  const auto code = static_cast<int>(last_error & 0xFFFFU);
  const auto error = [&] {
    const char* text = library_.call().ErrorGetStr == nullptr ? nullptr : library_.call().ErrorGetStr(code);
    return text == nullptr ? "the vendor's error " + std::to_string(code) : std::string(text);
  };
  switch (last_error >> 16U) {
    case kNotRead:
      return "the device could not be read: " + error();
    case kNoStatus:
      return "the device's status could not be read: " + error();
    case kRefused:
      return "the device refused a force: " + error();
    case kForceOff:
      return force_off_text(code);
    case kUncalibrated:
      return calibration_text();
    case kNoPower:
      return "the device has no power: switch it on";
    default:
      return {};
  }
}

haptics::DeviceAbilities ForceDimensionDevice::abilities() const {
  const char* name = library_.call().GetSystemName(id_);
  return abilities_of_model(falcon_ ? "Falcon" : name == nullptr ? "" : name);
}

std::string ForceDimensionDevice::description() const {
  const char* name = library_.call().GetSystemName(id_);
  return fmt::format("{} ({}, {})", name == nullptr ? "unknown device" : name, library_.name(),
                     library_.version());
}

Probe probe_forcedimension(const std::string& library) {
  Probe probe{"forcedimension", false, {}};
  try {
    const DhdLibrary opened(library);
    const int count = opened.call().GetDeviceCount();
    const std::string which = opened.name() + " " + opened.version();
    if (count > 0) {
      probe.available = true;
      probe.text = fmt::format("{}{} connected ({})", count, count == 1 ? " device" : " devices", which);
    } else if (count == 0) {
      probe.text = "no device is connected, switched on and open to this user (docs/devices.md); " + which;
    } else {
      probe.text = fmt::format("cannot look for devices: {}; {}", opened.last_error(), which);
    }
  } catch (const InputError& error) {
    const std::string text = error.what();
    const std::string place = "device forcedimension: ";
    probe.library = text.find("is not installed") == std::string::npos;
    probe.text = text.rfind(place, 0) == 0 ? text.substr(place.size()) : text;
  }
  return probe;
}

}  // namespace palpate::devices
