#include "run/devices/touch_scheduler.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "io/system/clock.h"
#include "palpate/error.h"
#include "palpate/units.h"
#include "run/devices/models.h"
#include "run/devices/reasons.h"
#include "run/realtime/realtime.h"

namespace palpate::devices {
namespace {

constexpr unsigned long kHdRate = 1000;  // Hz
constexpr double kWeakestArm = 3.3;  // N, for an arm that does not report its largest force: that of a Touch
constexpr int kMaxErrorsAFrame = 16;
constexpr std::size_t kMaxMotors = 16;            // the vendor's largest arms have 6
constexpr std::int64_t kLastFrames = 50'000'000;  // ns for the last frames, with zero force
constexpr std::int64_t kLookAgain = 1'000'000;    // ns

/// Converts a vector from the vendor's frame to D.
Vec3 from_vendor(const double* v) { return {v[0], -v[2], v[1]}; }

/// Rotation of the stylus in D, from the vendor's matrix by columns. The vendor's z axis points from the tip
/// to the handle. An instrument's z axis points from the handle to the tips. The two differ by half a turn
/// about x.
Quat rotation_from_vendor(const double* transform) {
  Mat3 m;
  m.col(0) = from_vendor(transform);
  m.col(1) = -from_vendor(transform + 4);
  m.col(2) = -from_vendor(transform + 8);
  return Quat(m);
}

std::string quoted_name(const TouchArm& arm) {
  return arm.name.empty() ? "the default device" : "\"" + arm.name + "\"";
}

}  // namespace

std::shared_ptr<TouchScheduler> TouchScheduler::of_process(const std::string& library) {
  static std::mutex mutex;
  static std::weak_ptr<TouchScheduler> of_this_process;  // one scheduler per process, as the vendor has
  const std::lock_guard<std::mutex> lock(mutex);
  std::shared_ptr<TouchScheduler> scheduler = of_this_process.lock();
  if (!scheduler) of_this_process = scheduler = std::make_shared<TouchScheduler>(library);
  return scheduler;
}

void TouchScheduler::add(TouchArm& arm) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const TouchArm* other : arms_) {
    if (other->name != arm.name) continue;
    throw InputError(
        fmt::format("device touch: {} is another hand's already, must be a name of its own for "
                    "each arm: --device touch:NAME, as Touch_Setup has it",
                    quoted_name(arm)));
  }
  pause();
  try {
    open(arm);
    arms_.push_back(&arm);
    resume();
  } catch (...) {
    take_out(arm);
    throw;
  }
}

void TouchScheduler::remove(TouchArm& arm) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  take_out(arm);
}

void TouchScheduler::take_out(TouchArm& arm) noexcept {
  pause();
  std::erase(arms_, &arm);
  close(arm);
  try {
    resume();
  } catch (const InputError&) {  // the other arms' samples become stale, and their loop latches that fault
  }
}

void TouchScheduler::open(TouchArm& arm) {
  const HdFunctions& call = library_.call();
  const auto require = [&](const char* what) {
    const HdErrorInfo error = library_.take_error();
    if (error.code == kHdSuccess && arm.handle != kHdInvalidHandle) return;
    const std::string text = error.code == kHdSuccess
                                 ? "the vendor's library gives no reason: run Touch_Setup, then begin again"
                                 : describe_hd_error(error.code);
    std::string reasons;
    for (const Reason& reason : touch_reasons({}, true)) {
      reasons += fmt::format("; {} ({})", reason.what, reason.command);
    }
    throw InputError(fmt::format("device touch: {} {}: {}{}", quoted_name(arm), what, text, reasons));
  };
  library_.take_error();
  arm.handle = call.InitDevice(arm.name.empty() ? nullptr : arm.name.c_str());
  require("cannot be opened");
  call.MakeCurrentDevice(arm.handle);
  const auto text = [&](unsigned what) {
    const char* text = call.GetString(what);
    return std::string(text == nullptr ? "?" : text);
  };
  arm.model = fmt::format("{} (serial number {}, driver {})", text(kHdModel), text(kHdSerialNumber),
                          text(kHdDriverVersion));
  call.GetIntegerv(kHdCalibrationStyle, &arm.calibration_style);
  call.GetDoublev(kHdMaxForce, &arm.max_force);
  if (!std::isfinite(arm.max_force) || arm.max_force <= 0.0) arm.max_force = kWeakestArm;
  arm.abilities = abilities_of_model(text(kHdModel));
  arm.abilities.torque = false;
  arm.abilities.max_force = std::min(arm.abilities.max_force, arm.max_force);
  double continuous = 0.0;
  call.GetDoublev(kHdMaxContinuousForce, &continuous);
  if (std::isfinite(continuous) && continuous > 0.0) arm.abilities.continuous_force = continuous;
  library_.take_error();  // a value that an old arm does not report is no fault
  call.Enable(kHdForceOutput);
  require("cannot switch its force on");
}

void TouchScheduler::close(TouchArm& arm) noexcept {
  if (arm.handle == kHdInvalidHandle) return;
  library_.call().MakeCurrentDevice(arm.handle);
  library_.call().Disable(kHdForceOutput);
  library_.call().DisableDevice(arm.handle);
  arm.handle = kHdInvalidHandle;
  library_.take_error();
}

void TouchScheduler::resume() {
  if (arms_.empty()) return;
  const HdFunctions& call = library_.call();
  if (call.SetSchedulerRate != nullptr) call.SetSchedulerRate(kHdRate);
  library_.take_error();  // an arm without this rate keeps its own; stale samples show a slow one
  runs_ = true;
  const realtime::BlockedSignals signals;  // the vendor's threads must not receive the program's signals
  callback_ = call.ScheduleAsynchronous(&TouchScheduler::frame, this, kHdDefaultPriority);
  call.StartScheduler();
  const HdErrorInfo error = library_.take_error();
  if (error.code == kHdSuccess) return;
  throw InputError("device touch: the vendor's scheduler cannot be started: " +
                   describe_hd_error(error.code));
}

/// Sends zero force to all arms, then stops the scheduler. A scheduler that no longer calls back is stopped
/// without the zero force.
void TouchScheduler::pause() noexcept {
  if (!runs_) return;
  quiet_frames_.store(0);
  quiet_.store(true);
  const std::int64_t deadline = monotonic_ns() + kLastFrames;
  while (quiet_frames_.load() == 0 && monotonic_ns() < deadline) sleep_until_ns(monotonic_ns() + kLookAgain);
  library_.call().StopScheduler();
  library_.call().Unschedule(callback_);
  quiet_.store(false);
  runs_ = false;
}

unsigned TouchScheduler::frame(void* scheduler) noexcept {
  auto& self = *static_cast<TouchScheduler*>(scheduler);
  const bool quiet = self.quiet_.load();
  for (TouchArm* arm : self.arms_) self.exchange(*arm, quiet);
  if (quiet) self.quiet_frames_.fetch_add(1);
  return kHdCallbackContinue;
}

/// Runs one frame of one arm: reads the state and sets the force.
void TouchScheduler::exchange(TouchArm& arm, bool quiet) noexcept {
  const HdFunctions& call = library_.call();
  TouchSample& sample = arm.samples.writable();
  sample = {};
  call.MakeCurrentDevice(arm.handle);
  if (arm.opening.load()) {
    sample.calibration = call.CheckCalibration();
    if (sample.calibration == kHdNeedsUpdate && arm.calibration_style != 0) {
      call.UpdateCalibration(static_cast<unsigned>(arm.calibration_style));
    }
  }
  call.BeginFrame(arm.handle);
  read(arm, sample);
  const std::int64_t now = monotonic_ns();
  read_temperature(arm, now);
  if (arm.warm) sample.state.events |= haptics::kMotorsWarm;
  const bool off = quiet || sample.state.fault != haptics::Fault::kNone;
  const Vec3 force_D = off ? Vec3(Vec3::Zero()) : wanted_force(arm, now);
  const double force[3] = {force_D.x(), force_D.z(), -force_D.y()};
  call.SetDoublev(kHdForce, force);
  call.EndFrame(arm.handle);
  take_errors(arm, now);
  show_error(arm, sample.state, now);
  sample.taken_ns = now;
  arm.samples.publish();
}

void TouchScheduler::read(TouchArm& arm, TouchSample& sample) noexcept {
  const HdFunctions& call = library_.call();
  double position[3] = {};
  double velocity[3] = {};
  double transform[16] = {};
  int buttons = 0;
  call.GetDoublev(kHdPosition, position);
  call.GetDoublev(kHdVelocity, velocity);
  call.GetDoublev(kHdTransform, transform);
  call.GetIntegerv(kHdButtons, &buttons);
  haptics::DeviceState& state = sample.state;
  state.position_D = kMillimetre * from_vendor(position);
  state.velocity_D = kMillimetre * from_vendor(velocity);
  state.orientation_D = rotation_from_vendor(transform);
  state.buttons = static_cast<std::uint32_t>(buttons);
  read_switches(arm, state);
}

/// Reads the switches that switch the force off. An arm without a safety switch reports an open one, so the
/// switch counts only after it was first closed.
void TouchScheduler::read_switches(TouchArm& arm, haptics::DeviceState& state) noexcept {
  const HdFunctions& call = library_.call();
  unsigned char in_hand[8] = {};  // the vendor's boolean has one byte; the spare bytes allow for four
  unsigned char out_of_inkwell[8] = {};
  call.GetBooleanv(kHdSafetySwitch, in_hand);
  call.GetBooleanv(kHdInkwellSwitch, out_of_inkwell);
  arm.was_held = arm.was_held || in_hand[0] != 0;
  TouchError error = TouchError::kNone;
  if (out_of_inkwell[0] == 0) {
    error = TouchError::kInkwell;
  } else if (arm.was_held && in_hand[0] == 0) {
    error = TouchError::kNotHeld;
  } else if (call.IsEnabled(kHdForceOutput) == 0) {
    error = TouchError::kForceDisabled;
  }
  if (error == TouchError::kNone) return;
  state.fault = haptics::Fault::kForceOff;
  arm.note(error);
}

/// Reads the motors' temperatures. An arm that does not report them answers with an error, which is no fault.
void TouchScheduler::read_temperature(TouchArm& arm, std::int64_t now) noexcept {
  if (now - arm.temperature_ns < kTemperaturePeriod) return;
  arm.temperature_ns = now;
  take_errors(arm, now);  // earlier errors do not belong to the temperature
  double motors[kMaxMotors] = {};
  library_.call().GetDoublev(kHdMotorTemperature, motors);
  const bool given = library_.take_error().code == kHdSuccess;
  arm.warm = given && std::any_of(std::begin(motors), std::end(motors), [](double t) { return t >= kWarm; });
}

/// Gives each error to the arm that it names, or to the current arm when it names no open arm.
void TouchScheduler::take_errors(TouchArm& current, std::int64_t now) noexcept {
  for (int i = 0; i < kMaxErrorsAFrame; ++i) {
    const HdErrorInfo error = library_.call().GetError();
    if (error.code == kHdSuccess) return;
    const auto named = std::find_if(arms_.begin(), arms_.end(),
                                    [&](const TouchArm* arm) { return arm->handle == error.device; });
    TouchArm& arm = named == arms_.end() ? current : **named;
    arm.error = error.code;
    arm.error_ns = now;
  }
}

void TouchScheduler::show_error(TouchArm& arm, haptics::DeviceState& state, std::int64_t now) noexcept {
  if (arm.error == kHdSuccess) return;
  if (now - arm.error_ns > kErrorHoldTime) {
    arm.error = kHdSuccess;
    return;
  }
  state.fault = fault_of_hd_error(arm.error);
  arm.note(TouchError::kError, arm.error);
}

/// The loop's newest force [N], limited to the largest force of the arm. Zero after stop() and when the loop
/// no longer writes.
Vec3 TouchScheduler::wanted_force(TouchArm& arm, std::int64_t now) const noexcept {
  const Vec3 force_D = arm.forces.wanted(now, kWriteTimeout).force;
  const double size = force_D.norm();
  return size > arm.max_force ? Vec3(arm.max_force / size * force_D) : force_D;
}

}  // namespace palpate::devices
