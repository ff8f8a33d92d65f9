#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace palpate::scene {

/// What can be made to go wrong with an emulated device.
enum class EmulatedFaultKind : std::uint8_t {
  kFreeze,      // the last good sample again and again, growing old
  kDropOut,     // it cannot be read
  kNotANumber,  // a position that is no number
  kSpike,       // the position 50 mm off, along the device's -z
  kLate,        // every sample is `age` old
  kWrongUnits,  // positions in mm where m are due: a thousand times too far
  kForceOff,    // the device says that it switched its force off, and does
  kRefuse,      // it refuses every command
};

struct EmulatedFaultName {
  std::string_view name;  // as in a scene
  EmulatedFaultKind kind;
};

/// [any] All kinds with their names, in the order in which they are listed to people.
[[nodiscard]] std::span<const EmulatedFaultName> emulated_fault_names() noexcept;

/// [any]
[[nodiscard]] std::string_view name_of(EmulatedFaultKind kind) noexcept;

/// [any] The kind of that name, if there is one.
[[nodiscard]] std::optional<EmulatedFaultKind> find_emulated_fault(std::string_view name) noexcept;

inline constexpr double kLongestFaultAge = 1.0;  // s, of late samples

/// One fault and when it happens, in the time of the ticks.
struct EmulatedFault {
  EmulatedFaultKind kind = EmulatedFaultKind::kFreeze;
  double time = 0.0;      // s, >= 0: the first tick at or after it
  double duration = 0.0;  // s, >= 0; 0: one tick
  double age = 8e-3;      // s, of late samples; > 0, at most kLongestFaultAge
};

/// The hand's pull towards where it wants to be.
struct HandGrip {
  double stiffness = 0.0;  // N/m, >= 0
  double damping = 0.0;    // N s/m, >= 0
};

// A hand that holds harder is stiffer and better damped [Hasser and Cutkosky 2002]; a finger's measured
// stiffness is some hundred N/m [Hajian and Howe 1997]. The damping is chosen low, so that what is stable
// here does not owe it to the hand.
inline constexpr HandGrip kLightGrip{50.0, 1.0};
inline constexpr HandGrip kFirmGrip{500.0, 5.0};

// A calm device of the desk-top kind, unless a scene says otherwise.
inline constexpr double kEmulatedDamping = 1.5;      // N s/m: enough for every built-in tissue at 1 kHz
inline constexpr double kEmulatedFriction = 0.05;    // N
inline constexpr double kEmulatedResolution = 1e-5;  // m

/// What only the emulated hand has, beside DeviceDynamics.
struct EmulatedHand {
  double mass = 0.25;  // kg, > 0: the moving part of the device and of the hand
  HandGrip grip = kFirmGrip;
  std::vector<EmulatedFault> faults{};
};

}  // namespace palpate::scene
