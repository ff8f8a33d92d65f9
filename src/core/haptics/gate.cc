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

bool finite(const ForceCommand& tissue, const Vec3& wanted) noexcept {
  return std::isfinite(wanted.norm()) && std::isfinite(tissue.torque.norm()) &&
         std::isfinite(tissue.gripper_force);
}

void latch(const GateLimits& limits, GateState& state, Fault fault) noexcept {
  state.fault = fault;
  // After a reset and a new fault during a ramp-down, the ramp-down continues.
  if (state.fault_ticks_left > 0 && fault != Fault::kStalled) return;
  constexpr double kMaxTicks = 1e6;
  const double whole = std::clamp(std::floor(kFaultFall / limits.period), 1.0, kMaxTicks);
  // after a stall the hand feels no force any more
  const double ticks = fault == Fault::kStalled ? 1.0 : whole;
  state.fault_ticks_left = static_cast<int>(ticks);
  state.fault_step = {state.force / ticks, state.torque / ticks, state.gripper_force / ticks};
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

/// Applies clamp and slew limits. @return status bits
std::uint32_t apply_limits(const GateLimits& limits, GateState& state, const ForceCommand& tissue,
                           const Vec3& noise) noexcept {
  const Limited force = limit(tissue.force + noise, state.force, limits.max_force, limits.force_step);
  const Limited torque = limit(tissue.torque, state.torque, limits.max_torque, limits.torque_step);
  const double grip = std::clamp(tissue.gripper_force, -limits.max_force, limits.max_force);
  state.force = force.value;
  state.torque = torque.value;
  state.gripper_force =
      std::clamp(grip, state.gripper_force - limits.force_step, state.gripper_force + limits.force_step);
  return (force.clamped ? kForceClamped : 0U) | (force.slewed ? kForceSlewed : 0U) |
         (torque.clamped ? kTorqueClamped : 0U) | (torque.slewed ? kTorqueSlewed : 0U);
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
  if (input.outside) reset_surplus(state.energy);

  GateOutput output;
  if (input.controlled) output.noise_scale = noise_scale(state.energy);
  output.stimulus_scale = output.noise_scale;
  ForceCommand tissue = input.tissue;
  output.status |= limit_duty(limits, state, input.warm, tissue, output.stimulus_scale);
  Vec3 noise = output.noise_scale * input.noise;
  if (!input.stimulus.isZero(0.0)) noise += output.stimulus_scale * input.stimulus;
  const bool usable = finite(tissue, tissue.force + noise);
  const Fault fault = input.fault == Fault::kNone && !usable ? Fault::kNotFinite : input.fault;
  if (state.fault == Fault::kNone && fault != Fault::kNone) latch(limits, state, fault);

  if (state.fault != Fault::kNone) {
    ramp_to_zero(state);
    state.noise = Vec3::Zero();
  } else {
    state.fault_ticks_left = 0;
    state.fault_step = {};
    if (input.controlled && control_passivity(state.energy, relative, limits.period, tissue)) {
      output.status |= kEnergyDamped;
    }
    output.status |= apply_limits(limits, state, tissue, noise);
    state.noise = noise;
  }
  output.command = {state.force, state.torque, state.gripper_force};
  return output;
}

void reset_fault(GateState& state) noexcept { state.fault = Fault::kNone; }

}  // namespace palpate::haptics
