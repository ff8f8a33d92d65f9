#pragma once
#include <cstdint>

#include "palpate/haptics/device.h"
#include "palpate/haptics/tick_row.h"

namespace palpate::haptics {

/// Bits of TickRow::status that the gate sets (contact's bits are below 1 << 8).
inline constexpr std::uint32_t kForceClamped = 1U << 8;
inline constexpr std::uint32_t kForceSlewed = 1U << 9;
inline constexpr std::uint32_t kTorqueClamped = 1U << 10;
inline constexpr std::uint32_t kTorqueSlewed = 1U << 11;

/// Limits a tick; vector (Euclidean) norms.
struct GateLimits {
  double max_force = 20.0;    // N
  double force_step = 5.0;    // N a tick
  double max_torque = 0.2;    // N m
  double torque_step = 0.05;  // N m a tick
  double period = 1e-3;       // s
};

/// What the gate carries from tick to tick, one a hand.
struct GateState {
  Vec3 force = Vec3::Zero();  // written at the last tick
  Vec3 torque = Vec3::Zero();
  double gripper_force = 0.0;
  ForceCommand fault_step;  // a tick, while a fault brings the force to zero
  int fault_ticks_left = 0;
  Fault fault = Fault::kNone;  // latched until reset
};

struct GateOutput {
  ForceCommand command;
  std::uint32_t status = 0;
};

/// From the tick of a fault the force goes linearly to zero and is there within this time, whatever the rate
/// and the slew limit.
inline constexpr double kFaultFall = 10e-3;  // s

/// [rt] The one gate before the hardware: finite check, + noise, clamp, slew (the norm of a vector each
/// time). The written force is never above max_force and never changes by more than force_step a tick; torque
/// the same; the gripper's force obeys the force's limits. A vector whose norm overflows counts as not
/// finite. A fault latches: everything falls linearly to zero within kFaultFall and stays exactly zero until
/// reset_fault().
/// @param tissue force [N], torque [N m] and gripper force [N] from contact; @param noise a force [N]
/// @param fault_now a fault seen this tick outside the gate (device could not be read, sample not finite), or
/// kNone
[[nodiscard]] GateOutput pass_gate(const GateLimits& limits, GateState& state, const ForceCommand& tissue,
                                   const Vec3& noise, Fault fault_now) noexcept;

/// [rt] Clears a latched fault; the force then rises from where it is, by the slew limit.
void reset_fault(GateState& state) noexcept;

}  // namespace palpate::haptics
