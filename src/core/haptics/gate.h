#pragma once
#include <cstdint>

#include "core/haptics/passivity.h"
#include "palpate/device.h"
#include "palpate/tick_row.h"

namespace palpate::haptics {

/// Bits of TickRow::status that the gate sets (contact's bits are below 1 << 8).
inline constexpr std::uint32_t kForceClamped = 1U << 8;
inline constexpr std::uint32_t kForceSlewed = 1U << 9;
inline constexpr std::uint32_t kTorqueClamped = 1U << 10;
inline constexpr std::uint32_t kTorqueSlewed = 1U << 11;
inline constexpr std::uint32_t kEnergyDamped = 1U << 12;  // the passivity controller acted
inline constexpr std::uint32_t kDutyHigh = 1U << 13;      // RMS force over kDutyShort above continuous_force
inline constexpr std::uint32_t kDutyLimited = 1U
                                              << 14;  // the force was lowered: that over kDutyLong, or warm

/// Time constants [s] of the mean squares of the written force: the shorter warns, the longer lowers it.
inline constexpr double kDutyShort = 10.0;
inline constexpr double kDutyLong = 60.0;
/// A device whose motors are warm counts as one at its limit, approached with this time constant [s].
inline constexpr double kDutyWarm = 1.0;
/// From this share of continuous_force on the RMS force over kDutyLong lowers the force, to nothing at 1.
inline constexpr double kDutyBegin = 0.9;

/// Limits a tick; vector (Euclidean) norms.
struct GateLimits {
  double max_force = 20.0;                              // N
  double force_step = 5.0;                              // N a tick
  double max_torque = 0.2;                              // N m
  double torque_step = 0.05;                            // N m a tick
  double period = 1e-3;                                 // s
  double continuous_force = DeviceAbilities::kUnknown;  // N, RMS that the device gives without end

  /// [any] The most [N] that the touch noise's sigma in contact may be: noise::kMostSigma, and no more than
  /// brings the noise's bound to max_force.
  [[nodiscard]] double most_sigma() const noexcept;
};

/// What the gate carries from tick to tick, one a hand.
struct GateState {
  Vec3 force = Vec3::Zero();  // written at the last tick
  Vec3 torque = Vec3::Zero();
  double gripper_force = 0.0;
  Vec3 noise = Vec3::Zero();  // its part of `force`
  EnergyAccount energy;
  double square_short = 0.0;  // N^2, mean square of the written force over kDutyShort
  double square_long = 0.0;   // over kDutyLong; raised while the motors are warm
  ForceCommand fault_step;    // a tick, while a fault brings the force to zero
  int fault_ticks_left = 0;
  Fault fault = Fault::kNone;  // latched until reset
};

/// What one tick brings to the gate.
struct GateInput {
  ForceCommand tissue{};       // from contact
  Vec3 noise = Vec3::Zero();   // N
  DeviceMotion motion{};       // of the device since the last tick
  DeviceMotion organ{};        // of the organ by itself, where the handle is, in the device's lengths
  bool outside = false;        // the tool touches nothing
  bool warm = false;           // the device's motors are: lower the force
  bool controlled = false;     // the passivity controller acts; else the energy is only observed
  Fault fault = Fault::kNone;  // seen this tick outside the gate
};

struct GateOutput {
  ForceCommand command;
  std::uint32_t status = 0;
  double noise_share = 1.0;  // of GateInput::noise that was let through
};

/// From the tick of a fault the force goes linearly to zero and is there within this time, whatever the rate
/// and the slew limit.
inline constexpr double kFaultFall = 10e-3;  // s

/// [rt] The one gate before the hardware: finite check, passivity controller on the tissue's force, + noise
/// (less of it where it has given too much energy), clamp, slew (the norm of a vector each time). The written
/// force is never above max_force and never changes by more than force_step a tick; torque the same; the
/// gripper's force obeys the force's limits. A vector whose norm overflows counts as not finite. A fault
/// latches: everything falls linearly to zero within kFaultFall and stays exactly zero until reset_fault().
/// After a stalled loop it is zero at once: the watchdog has taken the force away meanwhile. The energy
/// observer books what was written, faults or not.
[[nodiscard]] GateOutput pass_gate(const GateLimits& limits, GateState& state,
                                   const GateInput& input) noexcept;

/// [rt] Clears a latched fault; the force then rises from where it is, by the slew limit.
void reset_fault(GateState& state) noexcept;

}  // namespace palpate::haptics
