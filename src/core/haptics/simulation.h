#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/contact.h"
#include "core/haptics/force_ramp.h"
#include "core/haptics/gate.h"
#include "core/haptics/workspace.h"
#include "palpate/device.h"
#include "palpate/organ_motion.h"
#include "palpate/tick_row.h"
#include "palpate/touch_noise.h"

namespace palpate::haptics {

/// Samples with a position farther out than this [m] are invalid.
inline constexpr double kFarthest = 100.0;
/// Tolerance of a unit quaternion's norm in samples, for rounding in files.
inline constexpr double kQuaternionSlack = 0.05;

/// The constant part of a simulation: organ and its motion, tools, laws, noise, limits, rate.
struct SimulationWorld {
  contact::World contact;
  noise::TouchNoise noise;
  GateLimits limits;
  std::vector<WorkspaceMapping> mappings;  // one per hand
  Pose organ_W;                            // at rest
  double rate_Hz = 1000.0;
  model::OrganMotion organ_motion{};  // breathing and heartbeat; by default none
  [[nodiscard]] std::size_t hands() const noexcept { return mappings.size(); }
};

/// Noise crossfade: the touch noise on its way to new parameters.
struct NoiseCrossfade {
  double gain = 0.0;             // K at the end [N m]
  double threshold = 0.0;        // d_0 at the end [m]
  std::uint32_t ticks_left = 0;  // 0: finished
};

/// The commanded force of one hand: a linear ramp between two values.
struct StimulusRamp {
  double from = 0.0;             // N, before the ramp
  double to = 0.0;               // N, at its end
  std::uint32_t ticks = 0;       // duration
  std::uint32_t ticks_left = 0;  // 0: the end is reached

  /// [rt] The force at this tick [N].
  [[nodiscard]] double force() const noexcept {
    return ticks_left == 0 ? to : to + (from - to) * static_cast<double>(ticks_left) / ticks;
  }
};

/// The changing part of a simulation. A copy continues with the same results.
struct SimulationState {
  /// [setup] The state before tick 0.
  explicit SimulationState(const SimulationWorld& world);

  contact::State contact;
  std::vector<noise::TouchNoise::State> noise;
  std::vector<GateState> gates;
  std::vector<DeviceTrack> tracks;
  std::vector<ForceRamp> force_ramps;        // of held devices
  std::vector<DeviceMotion> motions;         // of the devices, since the last tick
  std::vector<contact::ToolInput> inputs;    // last valid pose and gripper value of each hand
  std::vector<contact::ToolResult> results;  // of the last tick, for pictures
  Pose organ_W;                              // in the last tick
  bool noise_enabled = true;
  // Values that parameter updates (parameter_updates.h) have changed:
  noise::TouchNoise touch_noise;  // in force
  NoiseCrossfade noise_crossfade;
  std::vector<StimulusRamp> stimuli;  // per hand
  std::uint32_t interval = 0;         // number of the stimulus interval; 0: none
  std::uint32_t interval_events = 0;  // kIntervalBegan, kIntervalEnded: for the rows of the next tick
  model::FalloffRatios reach;         // for pictures
  std::uint64_t change = 0;           // number of the last parameter update; 0: none
};

/// [any] The device sample of a row, bit for bit.
[[nodiscard]] DeviceState sample_of(const TickRow& row) noexcept;

/// [rt] The fault of a sample, or kNone: one that it reports, a number that is not finite, an age over
/// kStaleAfter, a position beyond kFarthest, no unit quaternion.
[[nodiscard]] Fault sample_fault(const DeviceState& sample) noexcept;

/// [rt] One haptic tick (docs/model.md, section 4): samples in, rows and commands out. A pure function of its
/// arguments; it reads no clock, so tick_ns and late_ns stay 0.
///
/// A sample with a sample_fault() latches it on its hand. Contact then uses the hand's last valid pose. All
/// values of a row are finite, except `device`, `device_q`, `device_velocity`, `device_gripper` and
/// `device_age`: they are the sample as received, so that a replay gives the same fault.
/// @param samples, commands, rows one entry per hand
void tick(const SimulationWorld& world, SimulationState& state, std::uint64_t tick_number,
          std::span<const DeviceState> samples, std::span<ForceCommand> commands,
          std::span<TickRow> rows) noexcept;

}  // namespace palpate::haptics
