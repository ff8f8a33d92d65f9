// The one gate between the computed force and the device. Whatever contact computes, what leaves here is
// finite, within the device's limits, without sudden changes, and does not keep on giving energy.
//
//     tissue -> duty limit --> slew reserve -> passivity control -+
//                                                                 +-> clamp -> slew -> command
//     touch noise ------> noise scale ----------------------------+
//     commanded force --> noise scale, duty limit ----------------+
//
//     a latched fault replaces all of this by a ramp to zero
//
// 1. Account. The force of the last tick, times the motion since, is the energy that went to the hand. The
//    observer keeps two accounts: the tissue's, which may only return what the hand has put in, and that
//    of the noise and the commanded force, which are open-loop sources with an allowance (passivity.h).
//    The motion is relative to the organ for the tissue, so that a breathing organ's work is not charged
//    to the hand.
// 2. Duty. The mean square of the written force lowers the force near what the motors hold without a
//    limit.
// 3. Finite. A force that is not finite is a fault.
// 4. Slew reserve. The slew limit delays the fall of a force that the hand moves away from. So the force
//    is limited to what can be brought to zero before the hand gets more energy than it has put in.
// 5. Passivity control. While the tissue has given too much, damping is added against the recent motion.
// 6. Limits. The sum is clamped and then slewed, both as vector norms, so that no direction is favoured. A
//    limit may take away the damping of step 5. keep_dissipation() then moves the limited vector against
//    the motion, as far as both limits allow.
//
// Noise scale, reserve and control act only on a held device (`controlled`); otherwise the energy is only
// observed.
//
// A fault latches. The commands ramp to exactly zero and stay there until reset_fault(). The ramp takes
// kFaultFall, because a step to zero would kick the hand. After Fault::kUnstable it takes kUnstableFall,
// and what gives energy along the motion goes first. After a stall there is no ramp: the watchdog has
// already removed the force, and a ramp would begin with a jump up.

#include "core/haptics/gate.h"

#include <algorithm>
#include <cmath>

#include "palpate/touch_noise.h"

namespace palpate::haptics {
namespace {

// A vector is shortened to this fraction of its limit, so that rounding cannot exceed the limit.
constexpr double kJustBelow = 1.0 - 4e-15;

struct Limited {
  Vec3 value;
  bool clamped = false;
  bool slewed = false;
};

/// Limits `wanted` to the norm `largest` and to a change of `step` from `last`.
Limited limit(const Vec3& wanted, const Vec3& last, double largest, double step) noexcept {
  Limited result{wanted};
  const double norm = wanted.norm();
  if (norm > largest) {
    result.value = wanted * (largest / norm * kJustBelow);
    result.clamped = true;
  }
  const Vec3 change = result.value - last;
  const double size = change.norm();
  if (size > step) {
    result.value = last + change * (step / size * kJustBelow);
    result.slewed = true;
    const double rounded = result.value.norm();
    if (rounded > largest) result.value *= largest / rounded * kJustBelow;
  }
  return result;
}

/// Moves a limited vector against the motion `way` until it dissipates as much as `wanted`, or as the limits
/// allow. They allow every point between two vectors within both limits.
void keep_dissipation(const Vec3& wanted, const Vec3& last, const Vec3& way, double largest, double step,
                      Vec3& value) noexcept {
  const double missing = (value - wanted).dot(way);
  if (!(missing > 0.0)) return;
  const Vec3 most = limit(last - step / way.norm() * way, last, largest, step).value;
  const double possible = (value - most).dot(way);
  if (possible > 0.0) value += std::min(1.0, missing / possible) * (most - value);
}

bool finite(const ForceCommand& tissue, const Vec3& wanted) noexcept {
  return std::isfinite(wanted.norm()) && std::isfinite(tissue.torque.norm()) &&
         std::isfinite(tissue.gripper_force);
}

/// Begins the fall of all commands to zero. @param time [s]
void begin_fall(const GateLimits& limits, double time, GateState& state) noexcept {
  constexpr double kMaxTicks = 1e6;
  const double ticks = std::clamp(std::floor(time / limits.period), 1.0, kMaxTicks);
  state.fault_ticks_left = static_cast<int>(ticks);
  state.fault_step = {state.force / ticks, state.torque / ticks, state.gripper_force / ticks};
}

void latch(const GateLimits& limits, GateState& state, Fault fault) noexcept {
  const double time = fault == Fault::kUnstable ? kUnstableFall : kFaultFall;
  if (state.fault == Fault::kNone) state.fault = fault;
  // A fall that ends earlier continues, also after a reset and a new fault.
  if (state.fault_ticks_left > 0 && state.fault_ticks_left * limits.period <= time) return;
  begin_fall(limits, time, state);
}

/// The next command of the ramp to zero: the step times the ticks left, so the end is exactly zero.
void ramp_to_zero(GateState& state) noexcept {
  if (state.fault_ticks_left > 0) --state.fault_ticks_left;
  const double left = state.fault_ticks_left;
  if (state.fault_ticks_left == 0) state.fault_step = {};
  state.force = state.fault_step.force * left;
  state.torque = state.fault_step.torque * left;
  state.gripper_force = state.fault_step.gripper_force * left;
}

/// Applies clamp and slew limits. @param damped motion against which the passivity controller acts; zero when
/// it does not @return status bits
std::uint32_t apply_limits(const GateLimits& limits, GateState& state, const ForceCommand& tissue,
                           const Vec3& noise, const DeviceMotion& damped) noexcept {
  const Vec3 wanted = tissue.force + noise;
  Limited force = limit(wanted, state.force, limits.max_force, limits.force_step);
  Limited torque = limit(tissue.torque, state.torque, limits.max_torque, limits.torque_step);
  if (!damped.translation.isZero(0.0)) {
    keep_dissipation(wanted, state.force, damped.translation, limits.max_force, limits.force_step,
                     force.value);
  }
  if (!damped.rotation.isZero(0.0)) {
    keep_dissipation(tissue.torque, state.torque, damped.rotation, limits.max_torque, limits.torque_step,
                     torque.value);
  }
  const double grip = std::clamp(tissue.gripper_force, -limits.max_force, limits.max_force);
  state.force = force.value;
  state.torque = torque.value;
  state.gripper_force =
      std::clamp(grip, state.gripper_force - limits.force_step, state.gripper_force + limits.force_step);
  return (force.clamped ? kForceClamped : 0U) | (force.slewed ? kForceSlewed : 0U) |
         (torque.clamped ? kTorqueClamped : 0U) | (torque.slewed ? kTorqueSlewed : 0U);
}

/// The next command of a fade: a ramp to zero without what gives energy along the motion. It never rises
/// again.
void fade_to_zero(const GateLimits& limits, GateState& state, const DeviceMotion& relative) noexcept {
  const Vec3 last_force = state.force;
  const Vec3 last_torque = state.torque;
  ramp_to_zero(state);
  const double left = state.fault_ticks_left;
  if (state.fault_ticks_left == 0) return;
  ForceCommand falling{state.force, state.torque, state.gripper_force};
  remove_giving(relative, falling);
  // What gives energy is gone within kFaultFall, or as fast as the slew limit allows.
  constexpr double kFaster = kUnstableFall / kFaultFall;
  const ForceCommand step = state.fault_step;
  state.force = limit(falling.force, last_force, state.force.norm(),
                      std::max(limits.force_step, kFaster * step.force.norm()))
                    .value;
  state.torque = limit(falling.torque, last_torque, state.torque.norm(),
                       std::max(limits.torque_step, kFaster * step.torque.norm()))
                     .value;
  state.fault_step = {state.force / left, state.torque / left, step.gripper_force};
}

/// Lowers force and torque to what the slew limits can bring to zero in time. @return status bits
std::uint32_t limit_to_reserve(const GateLimits& limits, const PassivityObserver& energy,
                               ForceCommand& tissue) noexcept {
  const SlewReserve most =
      slew_reserve(energy, limits.force_step / limits.period, limits.torque_step / limits.period);
  const double force = tissue.force.norm();
  const double torque = tissue.torque.norm();
  if (force > most.force) tissue.force *= most.force / force;
  if (torque > most.torque) tissue.torque *= most.torque / torque;
  return (force > most.force ? kForceSlewed : 0U) | (torque > most.torque ? kTorqueSlewed : 0U);
}

/// Duty limit: updates the RMS of the written force, and lowers the force near the device's continuous force.
/// @param stimulus_scale gain of the commanded force, lowered too @return status bits
std::uint32_t limit_duty(const GateLimits& limits, GateState& state, bool warm, ForceCommand& tissue,
                         double& stimulus_scale) noexcept {
  if (!std::isfinite(limits.continuous_force)) return 0;
  const double square = state.force.squaredNorm();
  state.square_short += (square - state.square_short) * limits.period / kDutyShort;
  state.square_long += (square - state.square_long) * limits.period / kDutyLong;
  if (warm) {
    const double left = limits.continuous_force * limits.continuous_force - state.square_long;
    state.square_long += std::max(0.0, left) * limits.period / kDutyWarm;
  }
  const double load = std::sqrt(state.square_long) / limits.continuous_force;
  std::uint32_t status = std::sqrt(state.square_short) > limits.continuous_force ? kDutyHigh : 0U;
  if (load > kDutyBegin) {
    const double share = std::max(0.0, (1.0 - load) / (1.0 - kDutyBegin));
    tissue.force *= share;
    tissue.torque *= share;
    stimulus_scale *= share;
    status |= kDutyLimited;
  }
  return status;
}

}  // namespace

double GateLimits::max_sigma() const noexcept {
  return std::min(noise::kMaxSigma, max_force / noise::TouchNoise::kBound);
}

GateOutput pass_gate(const GateLimits& limits, GateState& state, const GateInput& input) noexcept {
  const DeviceMotion relative{input.motion.translation - input.organ.translation,
                              input.motion.rotation - input.organ.rotation};
  observe_tissue(state.energy, {state.force, state.torque, state.gripper_force}, state.noise, relative);
  observe_noise(state.energy, state.noise, input.motion, limits.period);
  average_motion(state.energy, relative, limits.period);
  if (input.outside) reset_surplus(state.energy);

  GateOutput output;
  if (input.controlled) output.noise_scale = noise_scale(state.energy);
  output.stimulus_scale = output.noise_scale;
  ForceCommand tissue = input.tissue;
  output.status |= limit_duty(limits, state, input.warm, tissue, output.stimulus_scale);
  Vec3 noise = output.noise_scale * input.noise;
  if (!input.stimulus.isZero(0.0)) noise += output.stimulus_scale * input.stimulus;
  const bool usable = finite(tissue, tissue.force + noise);
  Fault fault = input.fault == Fault::kNone && !usable ? Fault::kNotFinite : input.fault;
  if (fault == Fault::kNone && input.controlled && is_unstable(state.energy)) fault = Fault::kUnstable;
  const bool fades = state.fault == Fault::kUnstable && state.fault_ticks_left > 0;
  const bool another = fades && fault != Fault::kNone && fault != Fault::kUnstable;
  if (fault != Fault::kNone && (state.fault == Fault::kNone || another)) latch(limits, state, fault);

  if (state.fault != Fault::kNone) {
    // After a stall the hand feels no force any more.
    if (input.fault == Fault::kStalled) state.fault_ticks_left = 0;
    if (state.fault == Fault::kUnstable) {
      fade_to_zero(limits, state, relative);
    } else {
      ramp_to_zero(state);
    }
    state.noise = Vec3::Zero();
  } else {
    state.fault_ticks_left = 0;
    state.fault_step = {};
    bool damps = false;
    if (input.controlled) {
      output.status |= limit_to_reserve(limits, state.energy, tissue);
      damps = control_passivity(state.energy, limits.period, tissue);
      const bool moves = !input.motion.translation.isZero(0.0) && !relative.translation.isZero(0.0);
      observe_control(state.energy, damps && moves && !input.outside, limits.period);
    }
    if (damps) output.status |= kEnergyDamped;
    output.status |= apply_limits(limits, state, tissue, noise, damps ? state.energy.recent : DeviceMotion{});
    state.noise = noise;
  }
  output.command = {state.force, state.torque, state.gripper_force};
  return output;
}

void reset_fault(GateState& state) noexcept {
  if (state.fault == Fault::kUnstable) reset_deficit(state.energy);
  state.fault = Fault::kNone;
}

}  // namespace palpate::haptics
