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

/// What one frame of the vendor's scheduler read of an arm.
struct TouchSample {
  haptics::DeviceState state;  // frame D; gripper and age are the reader's
  std::int64_t taken_ns = 0;   // monotonic; 0: no frame yet
  unsigned calibration = 0;    // kHdCalibrated ..., asked for while the arm is being opened
};

/// Why an arm is in a fault, beside errors of the vendor's library.
enum class TouchTrouble : std::uint32_t { kNone, kError, kInkwell, kNotHeld, kForceDisabled, kSlow };

/// One arm: what the loop and the vendor's thread exchange about it without waiting for each other.
struct TouchArm {
  std::string name;      // as Touch_Setup has it; empty: the default device
  std::string model;     // as the arm reports it
  double max_force = 0;  // N, the arm's own nominal one
  haptics::DeviceAbilities abilities;
  int calibration_style = 0;
  unsigned handle = kHdInvalidHandle;

  TripleBuffer<TouchSample> samples;      // vendor's thread to loop
  ForceHandOver forces;                   // loop to vendor's thread
  std::atomic<bool> opening{true};        // its calibration is looked after
  std::atomic<std::uint32_t> trouble{0};  // TouchTrouble << 16 | code, what was last wrong

  /// [rt] Keeps what is wrong for TouchDevice::last_error().
  void note(TouchTrouble what, unsigned code = 0) noexcept {
    trouble.store(static_cast<std::uint32_t>(what) << 16U | (code & 0xFFFFU), std::memory_order_relaxed);
  }

  // The vendor's thread's alone while the scheduler runs:
  bool was_held = false;  // its safety switch was closed once: there is one
  unsigned error = kHdSuccess;
  std::int64_t error_ns = 0;
  bool warm = false;                // one of its motors is above TouchScheduler::kWarm
  std::int64_t temperature_ns = 0;  // when their temperature was last asked for
};

/// The vendor's scheduler, of which a process has one, with all open arms: one callback at 1 kHz reads each
/// arm's state and sets its force. Arms come and go only while the scheduler stands.
///
/// The vendor's frame is x right, y up, z towards the user, in mm; the device's frame D is x right, y
/// forward, z up, in m.
class TouchScheduler final {
 public:
  /// Without a write for so long the loop is dead: zero force [ns].
  static constexpr std::int64_t kNoWrite = 20'000'000;
  /// An error of the vendor's library is shown for so long, so that every tick sees it [ns].
  static constexpr std::int64_t kErrorShown = 20'000'000;
  /// The motors' temperature is asked for so often [ns].
  static constexpr std::int64_t kTemperatureEvery = 100'000'000;
  /// From here on a motor is warm: 0 is room temperature, 1 where the arm takes its force away (0x0200). The
  /// vendor's own example lowers the force from here on.
  static constexpr double kWarm = 0.7;

  /// [setup] The process's scheduler; its library is loaded with the first arm. @throws InputError as
  /// HdLibrary does
  static std::shared_ptr<TouchScheduler> of_process(const std::string& library);

  /// [setup] @param library as HdLibrary takes it
  explicit TouchScheduler(const std::string& library) : library_(library) {}

  /// [setup] Opens the arm `arm.name` at zero force. @throws InputError in one line: no such arm, open
  /// already, each error of the vendor's library
  void add(TouchArm& arm);
  /// [setup] Zero force, force output off, closed. The other arms go on.
  void remove(TouchArm& arm) noexcept;

 private:
  static unsigned frame(void* scheduler) noexcept;
  void open(TouchArm& arm);
  void close(TouchArm& arm) noexcept;
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
  std::vector<TouchArm*> arms_;  // changes only while the scheduler stands
  bool runs_ = false;
  unsigned long callback_ = 0;
  std::atomic<bool> quiet_{false};              // zero force to all arms
  std::atomic<std::uint32_t> quiet_frames_{0};  // that have given it
};

}  // namespace palpate::devices
