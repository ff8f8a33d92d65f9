#pragma once
#include <cstdint>

#include "core/haptics/passivity.h"
#include "palpate/device.h"
#include "palpate/tick_row.h"

namespace palpate::haptics {

/// Bits of TickRow::status that the gate sets. Bits below 1 << 8 are contact's.
inline constexpr std::uint32_t kForceClamped = 1U << 8;
inline constexpr std::uint32_t kForceSlewed = 1U << 9;
inline constexpr std::uint32_t kTorqueClamped = 1U << 10;
inline constexpr std::uint32_t kTorqueSlewed = 1U << 11;
inline constexpr std::uint32_t kEnergyDamped = 1U << 12;  // the passivity controller acted
inline constexpr std::uint32_t kDutyHigh = 1U << 13;      // RMS force over kDutyShort above continuous_force
// force lowered: RMS force over kDutyLong near continuous_force, or warm motors
inline constexpr std::uint32_t kDutyLimited = 1U << 14;

/// Time constants [s] of the written force's mean squares. The short one warns, the long one lowers the
/// force.
inline constexpr double kDutyShort = 10.0;
inline constexpr double kDutyLong = 60.0;
/// While the motors are warm, the long mean square approaches its limit with this time constant [s].
inline constexpr double kDutyWarm = 1.0;
/// Above this fraction of continuous_force, the RMS force over kDutyLong lowers the force, to zero at 1.
inline constexpr double kDutyBegin = 0.9;

/// Limits per tick, as Euclidean norms of vectors.
struct GateLimits {
  double max_force = 20.0;    // N
  double force_step = 5.0;    // N per tick
  double max_torque = 0.2;    // N m
  double torque_step = 0.05;  // N m per tick
  double period = 1e-3;       // s
  // N, RMS force that the device can hold without a time limit
  double continuous_force = DeviceAbilities::kUnknown;

  /// [any] Largest allowed sigma [N] of the touch noise in contact: noise::kMaxSigma, or less, so that the
  /// bound of the noise stays below max_force.
  [[nodiscard]] double max_sigma() const noexcept;
};

/// State of the gate, one per hand.
struct GateState {
  Vec3 force = Vec3::Zero();  // written in the last tick
  Vec3 torque = Vec3::Zero();
  double gripper_force = 0.0;
  Vec3 noise = Vec3::Zero();  // touch noise and commanded force in `force`
  PassivityObserver energy;
  double square_short = 0.0;  // N^2, mean square of the written force over kDutyShort
  double square_long = 0.0;   // N^2, over kDutyLong; raised while the motors are warm
  ForceCommand fault_step;    // change per tick while a fault brings the force to zero
  int fault_ticks_left = 0;
  Fault fault = Fault::kNone;  // latched until reset
};

/// Input of the gate in one tick.
struct GateInput {
  ForceCommand tissue{};         // from contact
  Vec3 noise = Vec3::Zero();     // N
  Vec3 stimulus = Vec3::Zero();  // N, commanded force
  DeviceMotion motion{};         // of the device since the last tick
  DeviceMotion organ{};          // motion of the organ itself at the handle, in the device's lengths
  bool outside = false;          // the tool is not in contact
  bool warm = false;             // the device reports warm motors: lower the force
  bool controlled = false;       // the passivity controller acts; otherwise energy is only observed
  Fault fault = Fault::kNone;    // detected in this tick outside the gate
};

struct GateOutput {
  ForceCommand command;
  std::uint32_t status = 0;
  double noise_scale = 1.0;     // gain that was applied to GateInput::noise
  double stimulus_scale = 1.0;  // and to GateInput::stimulus
};

/// After a fault the force ramps linearly to zero within this time, at any rate and slew limit.
inline constexpr double kFaultFall = 10e-3;  // s
/// After Fault::kUnstable the force fades within this time; what gives energy along the motion is gone within
/// kFaultFall.
inline constexpr double kUnstableFall = 50e-3;  // s

/// [rt] The one gate before the hardware. Order: finite check, slew reserve and passivity controller on the
/// tissue force, + noise and commanded force (lowered when they have given too much energy), clamp, slew,
/// both on vector norms. Within the limits the controller's dissipation comes first. The written force never
/// exceeds max_force and, except in the fall after a fault, never changes by more than force_step per tick.
/// Torque obeys its own limits and the gripper force the limits of the force. A vector whose norm overflows
/// counts as not finite.
///
/// A fault latches: all commands ramp linearly to zero within kFaultFall and stay exactly zero until
/// reset_fault(). After a stalled loop they are zero at once, because the watchdog has already removed the
/// force. A held device that is_unstable() latches Fault::kUnstable. The passivity observer integrates what
/// was written, also during faults.
[[nodiscard]] GateOutput pass_gate(const GateLimits& limits, GateState& state,
                                   const GateInput& input) noexcept;

/// [rt] Clears a latched fault; after Fault::kUnstable also the energy deficit. The force then rises from its
/// present value, within the slew limit.
void reset_fault(GateState& state) noexcept;

}  // namespace palpate::haptics
