#include "core/haptics/simulation.h"

#include <algorithm>
#include <cmath>

#include "palpate/units.h"

namespace palpate::haptics {
namespace {

bool finite(const contact::ToolResult& result) noexcept {
  return std::isfinite(result.distance) && result.nearest_W.allFinite() && result.away_W.allFinite() &&
         std::isfinite(result.force_W.norm()) && std::isfinite(result.torque_W.norm()) &&
         std::isfinite(result.friction) && std::isfinite(result.depth) && result.contact_W.allFinite() &&
         result.normal_W.allFinite();
}

std::array<double, 3> plain(const Vec3& v) noexcept { return {v.x(), v.y(), v.z()}; }
std::array<double, 4> plain(const Quat& q) noexcept { return {q.w(), q.x(), q.y(), q.z()}; }

/// Fills the columns of pose and contact.
void describe_contact(const contact::ToolInput& input, const contact::ToolResult& result,
                      TickRow& row) noexcept {
  row.phase = static_cast<std::uint32_t>(result.phase);
  row.distance = result.distance;
  row.depth = result.depth;
  row.cutoff_layer = static_cast<std::uint32_t>(result.cutoff_layer);
  row.saturated = result.saturated ? 1 : 0;
  row.tissue_force = result.force_W.norm();
  row.friction = result.friction;
  row.tool = plain(input.pose_W.position);
  row.tool_q = plain(input.pose_W.rotation);
  row.gripper = input.gripper;
  row.contact = plain(result.contact_W);
  row.normal = plain(result.normal_W);
  row.layer = result.needle.layer;
  row.inserted_mm = result.needle.length / kMillimetre;
  row.slip = result.needle.slip;
  row.tip_force = result.needle.tip_force;
}

void copy_sample(const DeviceState& sample, std::uint32_t events_of_tick, TickRow& row) noexcept {
  row.device = plain(sample.position_D);
  row.device_q = plain(sample.orientation_D);
  row.device_velocity = plain(sample.velocity_D);
  row.device_gripper = sample.gripper;
  row.buttons = sample.buttons;
  row.device_age = sample.age;
  row.device_valid = sample.fault == Fault::kDevice ? 0 : 1;
  row.device_fault = static_cast<std::uint32_t>(sample.fault);
  row.events = (sample.events & ~kEventsOfTick) | events_of_tick;
}

/// Reads a hand's sample: sets the tool's pose and returns the device's motion. An invalid sample keeps the
/// last valid pose.
DeviceMotion read_sample(const SimulationWorld& world, SimulationState& state, std::size_t hand,
                         const DeviceState& sample) noexcept {
  if ((sample.events & kResetFault) != 0) reset_fault(state.gates[hand]);
  if (sample_fault(sample) != Fault::kNone) return {};
  const WorkspaceMapping& mapping = world.mappings[hand];
  DeviceTrack& track = state.tracks[hand];
  DeviceMotion motion = follow(mapping, track, sample, 1.0 / world.rate_Hz);
  state.inputs[hand].pose_W = mapping.apply(sample.position_D, sample.orientation_D, track.index_D);
  state.inputs[hand].gripper = std::clamp(sample.gripper, 0.0, 1.0);
  return motion;
}

/// One tick of the noise crossfade: moves gain and threshold towards their new values without a step.
void advance_crossfade(NoiseCrossfade& crossfade, noise::TouchNoise& noise) noexcept {
  const noise::NoiseSettings& now = noise.settings();
  const double share = 1.0 / static_cast<double>(crossfade.ticks_left);
  if (--crossfade.ticks_left == 0) {
    noise.set_strength(crossfade.gain, crossfade.threshold);
  } else {
    noise.set_strength(now.gain + share * (crossfade.gain - now.gain),
                       now.threshold + share * (crossfade.threshold - now.threshold));
  }
}

/// Gain of a hand's force; 1 on a device that nobody holds.
double force_ramp_gain(const SimulationWorld& world, SimulationState& state, std::size_t hand, Fault fault,
                       bool outside) noexcept {
  if (!world.mappings[hand].held) return 1.0;
  const DeviceTrack& track = state.tracks[hand];
  const bool usable = fault == Fault::kNone && state.gates[hand].fault == Fault::kNone;
  return advance_force_ramp(state.force_ramps[hand], {track.position_D, usable, outside, track.clutched},
                            1.0 / world.rate_Hz);
}

/// The organ's own motion since the last tick at a hand's handle, in the device's lengths.
DeviceMotion organ_at_handle(const Pose& before_W, const Pose& now_W, const Vec3& handle_W,
                             double scale) noexcept {
  const Pose step = now_W * before_W.inverse();
  const double sign = step.rotation.w() < 0.0 ? -2.0 : 2.0;  // 2 sin(a/2) approximates a
  return {(step * handle_W - handle_W) / scale, sign * step.rotation.vec()};
}

/// The force on one hand in a tick, and its parts.
struct HandForce {
  double gain = 0.0;      // of the force ramp
  double noise = 0.0;     // touch noise before gain and gate [N]
  double stimulus = 0.0;  // before gain and gate [N]
  GateOutput out;
};

/// The force on one hand, from contact, noise and stimulus through the gate.
HandForce force_of_hand(const SimulationWorld& world, SimulationState& state, std::uint64_t tick_number,
                        std::size_t hand, const DeviceState& sample, const DeviceMotion& organ) noexcept {
  contact::ToolResult& result = state.results[hand];
  GateState& gate = state.gates[hand];
  Fault fault = sample_fault(sample);
  if (!finite(result)) {
    if (fault == Fault::kNone) fault = Fault::kNotFinite;
    result = contact::ToolResult{};
  }
  const bool touching = result.phase != contact::Phase::kApproach;
  const bool outside = !touching && result.distance > 0.0;
  HandForce force;
  force.noise =
      state.touch_noise.force(state.noise[hand], state.noise_enabled, static_cast<std::uint32_t>(hand),
                              tick_number, touching ? 0.0 : result.distance);
  force.stimulus = state.stimuli[hand].force();
  force.gain = force_ramp_gain(world, state, hand, fault, outside);
  const double tissue_gain = force.gain * world.mappings[hand].force_scale;
  const bool gives_torque = world.mappings[hand].torque;
  const double torque_gain = gives_torque ? tissue_gain : 0.0;
  const auto felt = [gives_torque](const DeviceMotion& all) {  // turns do no work on a device without torque
    return gives_torque ? all : DeviceMotion{all.translation, Vec3::Zero()};
  };
  force.out = pass_gate(world.limits, gate,
                        {.tissue = {tissue_gain * result.force_W, torque_gain * result.torque_W, 0.0},
                         .noise = force.gain * force.noise * result.away_W,  // [Zhang 2011, eq. 2]
                         .stimulus = force.gain * force.stimulus * result.away_W,
                         .motion = felt(state.motions[hand]),
                         .organ = felt(organ),
                         .outside = outside,
                         .warm = (sample.events & kMotorsWarm) != 0,
                         .controlled = world.mappings[hand].held,
                         .fault = fault});
  if (gate.fault != Fault::kNone) state.stimuli[hand] = {};
  return force;
}

/// Fills the row of one hand.
void fill_row(const SimulationWorld& world, const SimulationState& state, std::uint64_t tick_number,
              std::size_t hand, const DeviceState& sample, const HandForce& force, TickRow& row) noexcept {
  const contact::ToolResult& result = state.results[hand];
  const GateState& gate = state.gates[hand];
  const GateOutput& out = force.out;
  row = TickRow{};
  row.tick = tick_number;
  row.time = static_cast<double>(tick_number) / world.rate_Hz;
  row.hand = static_cast<std::uint32_t>(hand);
  describe_contact(state.inputs[hand], result, row);
  row.noise_force = gate.fault == Fault::kNone ? out.noise_scale * force.gain * force.noise : 0.0;
  row.stimulus_force = gate.fault == Fault::kNone ? out.stimulus_scale * force.gain * force.stimulus : 0.0;
  row.force = plain(out.command.force);
  row.torque = plain(out.command.torque);
  row.gripper_force = out.command.gripper_force;
  row.status = result.status | out.status;
  row.fault = static_cast<std::uint32_t>(gate.fault);
  row.energy = gate.energy.tissue;
  row.engagement = force.gain;
  const std::uint32_t of_needle =
      (result.needle.punctured ? kPuncture : 0U) | (result.needle.left ? kExit : 0U);
  copy_sample(sample, state.interval_events | of_needle, row);
}

}  // namespace

Fault sample_fault(const DeviceState& sample) noexcept {
  if (sample.fault != Fault::kNone) return sample.fault;
  const double norm = sample.orientation_D.norm();
  if (!sample.position_D.allFinite() || !sample.velocity_D.allFinite() || !std::isfinite(sample.gripper) ||
      !std::isfinite(norm) || !std::isfinite(sample.age)) {
    return Fault::kNotFinite;
  }
  if (sample.age > kStaleAfter) return Fault::kStale;
  if (std::abs(norm - 1.0) > kQuaternionSlack) return Fault::kDevice;
  if (sample.position_D.cwiseAbs().maxCoeff() > kFarthest) return Fault::kDevice;
  return Fault::kNone;
}

SimulationState::SimulationState(const SimulationWorld& world)
    : contact(world.contact),
      noise(world.hands()),
      gates(world.hands()),
      tracks(world.hands()),
      force_ramps(world.hands()),
      motions(world.hands()),
      inputs(world.hands()),
      results(world.hands()),
      organ_W(world.organ_W),
      noise_enabled(world.noise.settings().enabled),
      touch_noise(world.noise),
      stimuli(world.hands()),
      reach(world.contact.tissue().reach) {}

DeviceState sample_of(const TickRow& row) noexcept {
  DeviceState sample;
  sample.position_D = Vec3(row.device[0], row.device[1], row.device[2]);
  sample.orientation_D = Quat(row.device_q[0], row.device_q[1], row.device_q[2], row.device_q[3]);
  sample.velocity_D = Vec3(row.device_velocity[0], row.device_velocity[1], row.device_velocity[2]);
  sample.gripper = row.device_gripper;
  sample.age = row.device_age;
  sample.buttons = row.buttons;
  sample.fault = static_cast<Fault>(row.device_fault);
  sample.events = row.events;
  return sample;
}

void tick(const SimulationWorld& world, SimulationState& state, std::uint64_t tick_number,
          std::span<const DeviceState> samples, std::span<ForceCommand> commands,
          std::span<TickRow> rows) noexcept {
  const std::size_t hands = world.hands();
  if (state.noise_crossfade.ticks_left > 0) advance_crossfade(state.noise_crossfade, state.touch_noise);
  for (StimulusRamp& ramp : state.stimuli) {
    if (ramp.ticks_left > 0) --ramp.ticks_left;
  }
  for (std::size_t hand = 0; hand < hands; ++hand) {
    state.motions[hand] = read_sample(world, state, hand, samples[hand]);
  }
  const Pose before_W = state.organ_W;
  state.organ_W = world.organ_motion.pose_at(world.organ_W, tick_number, world.rate_Hz);
  contact::move_inclusions(state.contact, static_cast<double>(tick_number) / world.rate_Hz);
  contact::advance(world.contact, state.organ_W, state.inputs, state.contact, state.results);
  for (std::size_t hand = 0; hand < hands; ++hand) {
    DeviceMotion organ;
    if (world.organ_motion.moves()) {
      organ = organ_at_handle(before_W, state.organ_W, state.inputs[hand].pose_W.position,
                              world.mappings[hand].scale);
    }
    const HandForce force = force_of_hand(world, state, tick_number, hand, samples[hand], organ);
    commands[hand] = force.out.command;
    fill_row(world, state, tick_number, hand, samples[hand], force, rows[hand]);
  }
  state.interval_events = 0;
}

}  // namespace palpate::haptics
