#pragma once
#include <array>
#include <cstdint>

#include "palpate/device.h"

namespace palpate::haptics {

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
  std::uint32_t fault = 0;   // Fault that is latched
  double energy = 0.0;       // J that hand and organ's own motion have put into the tissue's force so far and
                             // not got back
  double engagement = 1.0;   // gain of force and noise (force ramp), 0 to 1
  // The device's own sample, so that the tick can be run again:
  std::array<double, 3> device{};           // m, device frame
  std::array<double, 4> device_q{};         // w x y z
  std::array<double, 3> device_velocity{};  // m/s
  double device_gripper = 0.0;
  double device_age = 0.0;  // s
  std::uint32_t buttons = 0;
  std::uint32_t device_valid = 1;  // 0: it could not be read
  std::uint32_t device_fault = 0;  // Fault that came with the sample
  std::uint32_t events = 0;        // what the user asked (device.h)
};

}  // namespace palpate::haptics
