#pragma once
#include <array>
#include <cstdint>

#include "palpate/device.h"

namespace palpate::haptics {

/// One row of a recording: one hand at one tick. Plain data in SI units, world frame unless noted.
struct TickRow {
  std::uint64_t tick = 0;
  double time = 0.0;  // s
  std::uint32_t hand = 0;
  std::uint32_t phase = 0;  // contact::Phase
  double distance = 0.0;    // m, tool to organ; negative inside
  double depth = 0.0;       // m, penetration depth
  std::uint32_t cutoff_layer = 0;
  std::uint32_t saturated = 0;
  double tissue_force = 0.0;        // N, norm before the gate
  double noise_force = 0.0;         // N, signed along the normal
  double friction = 0.0;            // N
  std::array<double, 3> force{};    // N, commanded force, after the gate
  std::array<double, 3> torque{};   // N m
  double gripper_force = 0.0;       // N
  std::array<double, 3> tool{};     // m, handle
  std::array<double, 4> tool_q{};   // w x y z
  double gripper = 0.0;             // 0 closed .. 1 open
  std::array<double, 3> contact{};  // m
  std::array<double, 3> normal{};
  std::int64_t tick_ns = 0;  // computing time of the tick
  std::int64_t late_ns = 0;  // delay of its start
  std::uint32_t status = 0;  // status bits of contact (tool_contact.h) and of the gate (gate.h)
  std::uint32_t fault = 0;   // latched Fault
  double energy = 0.0;       // J, passivity observer: work of the hand and of the organ motion on the tissue
                             // force that was not returned; outside the tissue a surplus is reset to 0
  double engagement = 1.0;   // gain of force and noise (force ramp), 0 to 1
  // The device's sample, from which a replay computes the tick again:
  std::array<double, 3> device{};           // m, device frame
  std::array<double, 4> device_q{};         // w x y z
  std::array<double, 3> device_velocity{};  // m/s
  double device_gripper = 0.0;
  double device_age = 0.0;  // s
  std::uint32_t buttons = 0;
  std::uint32_t device_valid = 1;  // 0: the device could not be read
  std::uint32_t device_fault = 0;  // Fault of the sample
  std::uint32_t events = 0;        // bits of DeviceState::events (device.h)
  double stimulus_force = 0.0;     // N, commanded force, signed along the normal
  // A needle in the tissue; 0 without one:
  std::uint64_t layer = 0;   // of its tip, from 1
  double inserted_mm = 0.0;  // mm, of the shaft past its entry
  std::int64_t slip = 0;     // 1: the shaft slips inwards, -1: outwards, 0: the tissue moves with it
  double tip_force = 0.0;    // N; the rest is friction on the shaft, or the hub's push
};

}  // namespace palpate::haptics
