#include "run/devices/touch.h"

#include <algorithm>

#include <fmt/core.h>

#include "io/system/clock.h"
#include "palpate/error.h"
#include "run/devices/touch_library.h"

namespace palpate::devices {
namespace {

constexpr std::int64_t kFirstFrameLimit = 500'000'000;     // ns
constexpr std::int64_t kCalibrationLimit = 2'000'000'000;  // ns
constexpr std::int64_t kReadyPollPeriod = 1'000'000;       // ns
constexpr std::size_t kLongestArmName = 64;

const char* const kTouchPrefix = "device touch: ";

/// Refuses an arm name that is not a plain file name. The vendor's library makes a file name of it, which
/// must not lead to another folder.
const std::string& checked_arm_name(const std::string& name) {
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 && c != 0x7F && c != '/' && c != '\\';
  });
  if (plain && name.size() <= kLongestArmName && name.rfind('.', 0) != 0) return name;
  throw InputError(
      "device touch: the name after \"touch:\" must be the arm's name in Touch_Setup, as in touch:Left, at "
      "most 64 letters without / and without a point in front; the library is where the system's loader "
      "finds it");
}

std::string calibration_text(int style) {
  const auto has = [style](unsigned one) { return (static_cast<unsigned>(style) & one) != 0; };
  if (has(kHdStyleInkwell))
    return "put the stylus into the inkwell until its light is steady, then begin again";
  if (has(kHdStyleEncoderReset)) {
    return "hold the arm in its reset position as its manual says, calibrate it with Touch_Diagnostic, then "
           "begin again";
  }
  return "move the stylus through its whole workspace, calibrate it with Touch_Diagnostic, then begin again";
}

}  // namespace

TouchDevice::TouchDevice(const std::string& name, const std::string& library) {
  arm_.name = checked_arm_name(name);
  scheduler_ = TouchScheduler::of_process(library);
  scheduler_->add(arm_);
  try {
    wait_until_ready();
  } catch (...) {
    scheduler_->remove(arm_);
    throw;
  }
  arm_.opening.store(false);
}

TouchDevice::~TouchDevice() { scheduler_->remove(arm_); }

/// Waits until a frame shows a calibrated arm without an error. @throws InputError with the reason
void TouchDevice::wait_until_ready() {
  const std::int64_t begun = monotonic_ns();
  for (;; sleep_until_ns(monotonic_ns() + kReadyPollPeriod)) {
    arm_.samples.refresh();
    const TouchSample& sample = arm_.samples.value();
    const std::int64_t waited = monotonic_ns() - begun;
    if (sample.taken_ns == 0) {
      if (waited < kFirstFrameLimit) continue;
      throw InputError(
          fmt::format("{}the vendor's scheduler called nothing back for {} ms: switch the arm "
                      "off and on, look at it with Touch_Diagnostic, then begin again",
                      kTouchPrefix, kFirstFrameLimit / 1'000'000));
    }
    if (sample.state.fault == haptics::Fault::kDevice) throw InputError(kTouchPrefix + last_error());
    if (sample.calibration == kHdCalibrated) return;
    if (sample.calibration == kHdNeedsUpdate && waited < kCalibrationLimit) continue;
    throw InputError(fmt::format("{}the arm is not calibrated: {}", kTouchPrefix,
                                 calibration_text(arm_.calibration_style)));
  }
}

haptics::DeviceState TouchDevice::read(std::uint64_t tick, double time) noexcept {
  arm_.samples.refresh();
  const TouchSample& newest = arm_.samples.value();
  haptics::DeviceState state = newest.state;
  state.age = 1e-9 * static_cast<double>(std::max<std::int64_t>(0, monotonic_ns() - newest.taken_ns));
  if (state.age > haptics::kStaleAfter) arm_.note(TouchError::kSlow);
  const double most = tick == 0 ? 0.0 : kJawSpeed * std::max(0.0, time - read_time_);
  const double wanted = (state.buttons & 1U) != 0 ? 0.0 : 1.0;
  gripper_ += std::clamp(wanted - gripper_, -most, most);
  read_time_ = time;
  state.gripper = gripper_;
  return state;
}

bool TouchDevice::write(const haptics::ForceCommand& command_D) noexcept {
  return arm_.forces.write(command_D);
}

void TouchDevice::stop() noexcept { arm_.forces.stop(); }

std::string TouchDevice::last_error() const {
  const std::uint32_t last_error = arm_.last_error.load(std::memory_order_relaxed);
  switch (static_cast<TouchError>(last_error >> 16U)) {
    case TouchError::kError:
      return describe_hd_error(last_error & 0xFFFFU);
    case TouchError::kInkwell:
      return "the stylus is in the inkwell: take it out, then reset the fault";
    case TouchError::kNotHeld:
      return "the stylus was let go: hold it, then reset the fault";
    case TouchError::kForceDisabled:
      return "the arm switched its force off: let it rest for some minutes, then begin again";
    case TouchError::kSlow:
      return "the vendor's scheduler gives samples too slowly or none: end other programs, look at the arm "
             "with Touch_Diagnostic, then reset the fault";
    case TouchError::kNone:
      break;
  }
  return {};
}

std::string TouchDevice::description() const {
  return fmt::format("{}, at most {:.3g} N", arm_.model, arm_.max_force);
}

Probe probe_touch(const std::string& library) {
  try {
    const HdLibrary opened(library);
    return {"touch", true, library + " is there; `palpate devices --try touch` opens the arm"};
  } catch (const InputError& error) {
    const std::string message = error.what();
    const bool installed = message.find("is not installed") == std::string::npos;
    return {"touch", false, message.substr(std::string(kTouchPrefix).size()), installed};
  }
}

}  // namespace palpate::devices
