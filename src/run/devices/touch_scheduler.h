#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "palpate/device.h"
#include "palpate/triple_buffer.h"
#include "run/devices/force_hand_over.h"
#include "run/devices/touch_library.h"

namespace palpate::devices {

/// State of an arm, read in one frame of the vendor's scheduler.
struct TouchSample {
  haptics::DeviceState state;  // frame D; the reader sets gripper and age
  std::int64_t taken_ns = 0;   // monotonic; 0: no frame yet
  unsigned calibration = 0;    // kHdCalibrated ..., queried while the arm is being opened
};

/// Causes of an arm's fault; kError: an error of the vendor's library.
enum class TouchError : std::uint32_t { kNone, kError, kInkwell, kNotHeld, kForceDisabled, kSlow };

/// One arm: data that the loop and the vendor's thread exchange without waiting for each other.
struct TouchArm {
  std::string name;      // as Touch_Setup has it; empty: the default device
  std::string model;     // as the arm reports it
  double max_force = 0;  // N, nominal, as the arm reports it
  haptics::DeviceAbilities abilities;
  int calibration_style = 0;
  unsigned handle = kHdInvalidHandle;

  TripleBuffer<TouchSample> samples;         // vendor's thread to loop
  ForceHandover forces;                      // loop to vendor's thread
  std::atomic<bool> opening{true};           // calibration is monitored
  std::atomic<std::uint32_t> last_error{0};  // TouchError << 16 | code of the last error

  /// [rt] Stores the error for TouchDevice::last_error().
  void note(TouchError what, unsigned code = 0) noexcept {
    last_error.store(static_cast<std::uint32_t>(what) << 16U | (code & 0xFFFFU), std::memory_order_relaxed);
  }

  // Used only by the vendor's thread while the scheduler runs:
  bool was_held = false;  // its safety switch was closed once, so it has one
  unsigned error = kHdSuccess;
  std::int64_t error_ns = 0;
  bool warm = false;                // one of its motors is above TouchScheduler::kWarm
  std::int64_t temperature_ns = 0;  // of the last query of the temperatures
};

/// The vendor's scheduler, one per process, with all open arms. One callback at 1 kHz reads each arm's state
/// and sets its force. Arms are added and removed only while the scheduler is stopped.
///
/// The vendor's frame is x right, y up, z towards the user, in mm; the device's frame D is x right, y
/// forward, z up, in m.
class TouchScheduler final {
 public:
  /// Longest gap between writes before the force is zero, because the loop then hangs [ns].
  static constexpr std::int64_t kWriteTimeout = 20'000'000;
  /// How long an error of the vendor's library stays in the samples, so that every tick sees it [ns].
  static constexpr std::int64_t kErrorHoldTime = 20'000'000;
  /// Period of the queries of the motor temperatures [ns].
  static constexpr std::int64_t kTemperaturePeriod = 100'000'000;
  /// A motor above this is warm. 0 is room temperature; at 1 the arm switches its force off (0x0200). The
  /// vendor's example lowers the force above this value.
  static constexpr double kWarm = 0.7;

  /// [setup] The process's scheduler; its library is loaded with the first arm. @throws InputError as
  /// HdLibrary does
  static std::shared_ptr<TouchScheduler> of_process(const std::string& library);

  /// [setup] @param library as HdLibrary takes it
  explicit TouchScheduler(const std::string& library) : library_(library) {}

  /// [setup] Opens the arm `arm.name` at zero force. @throws InputError in one line: no such arm, arm
  /// already open, errors of the vendor's library
  void add(TouchArm& arm);
  /// [setup] Zero force, force output off, arm closed. The other arms continue.
  void remove(TouchArm& arm) noexcept;

 private:
  static unsigned frame(void* scheduler) noexcept;
  void open(TouchArm& arm);
  void close(TouchArm& arm) noexcept;
  void take_out(TouchArm& arm) noexcept;
  void resume();
  void pause() noexcept;
  void exchange(TouchArm& arm, bool quiet) noexcept;
  void read(TouchArm& arm, TouchSample& sample) noexcept;
  void read_switches(TouchArm& arm, haptics::DeviceState& state) noexcept;
  void read_temperature(TouchArm& arm, std::int64_t now) noexcept;
  void take_errors(TouchArm& current, std::int64_t now) noexcept;
  void show_error(TouchArm& arm, haptics::DeviceState& state, std::int64_t now) noexcept;
  [[nodiscard]] Vec3 wanted_force(TouchArm& arm, std::int64_t now) const noexcept;

  HdLibrary library_;
  std::mutex mutex_;             // of add() and remove()
  std::vector<TouchArm*> arms_;  // changes only while the scheduler is stopped
  bool runs_ = false;
  unsigned long callback_ = 0;
  std::atomic<bool> quiet_{false};              // zero force to all arms
  std::atomic<std::uint32_t> quiet_frames_{0};  // frames with zero force to all arms
};

}  // namespace palpate::devices
