#pragma once
#include <array>
#include <cstdint>

namespace palpate::haptics {

/// Why a fault was latched.
enum class Fault : std::uint8_t { kNone = 0, kNotFinite = 1, kDevice = 2 };

/// One row of a recording: one hand at one tick. Plain data, SI, world frame unless said.
struct TickRow {
  std::uint64_t tick = 0;
  double time = 0.0;  // s
  std::uint32_t hand = 0;
  std::uint32_t phase = 0;  // contact::Phase
  double distance = 0.0;    // m, negative inside
  double depth = 0.0;       // m
  std::uint32_t cutoff_layer = 0;
  std::uint32_t saturated = 0;
  double tissue_force = 0.0;       // N, norm before the gate
  double noise_force = 0.0;        // N, signed along the normal
  double friction = 0.0;           // N
  std::array<double, 3> force{};   // N, what went to the device
  std::array<double, 3> torque{};  // N m
  double gripper_force = 0.0;      // N
  std::array<double, 3> tool{};    // m
  std::array<double, 4> tool_q{};  // w x y z
  double gripper = 0.0;
  std::array<double, 3> contact{};  // m
  std::array<double, 3> normal{};
  std::int64_t tick_ns = 0;  // the tick's own computing time
  std::int64_t late_ns = 0;  // how late it began
  std::uint32_t status = 0;  // contact status bits, and the gate's (gate.h)
  std::uint32_t fault = 0;   // Fault
  // The device's own sample, so that the tick can be run again:
  std::array<double, 3> device{};           // m, device frame
  std::array<double, 4> device_q{};         // w x y z
  std::array<double, 3> device_velocity{};  // m/s
  double device_gripper = 0.0;
  std::uint32_t buttons = 0;
  std::uint32_t device_valid = 1;
};

}  // namespace palpate::haptics
