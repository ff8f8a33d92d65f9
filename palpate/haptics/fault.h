#pragma once
#include <cstdint>

namespace palpate::haptics {

/// Why a fault was latched. The numbers are in recordings.
enum class Fault : std::uint8_t {
  kNone = 0,
  kNotFinite = 1,  // a sample or a force is not finite
  kDevice = 2,     // the device could not be read or refused a command
  kStale = 3,      // the device gave no new sample for kStaleAfter
  kStalled = 4,    // the loop stood still for kStalledAfter
  kForceOff = 5,   // the device itself switched its force off
};

inline constexpr double kStaleAfter = 5e-3;     // s
inline constexpr double kStalledAfter = 20e-3;  // s

/// [any] As in CSV and JSON: "none", "not-finite", "device", "stale-sample", "stalled-loop", "force-off".
[[nodiscard]] const char* name_of(Fault fault) noexcept;

/// [any] For people: "the device gave no new sample for 5 ms".
[[nodiscard]] const char* words_of(Fault fault) noexcept;

}  // namespace palpate::haptics
