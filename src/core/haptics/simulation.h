#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/contact.h"
#include "core/haptics/engagement.h"
#include "core/haptics/gate.h"
#include "core/haptics/workspace.h"
#include "palpate/device.h"
#include "palpate/organ_motion.h"
#include "palpate/tick_row.h"
#include "palpate/touch_noise.h"

namespace palpate::haptics {

/// A device position farther out [m] than this is no hand's: the sample is refused.
inline constexpr double kFarthest = 100.0;

/// Everything a tick needs that does not change: organ and its motion, tools, laws, noise, limits, rate.
struct SimulationWorld {
  contact::World contact;
  noise::TouchNoise noise;
  GateLimits limits;
  std::vector<WorkspaceMapping> mappings;  // one a hand
  Pose organ_W;                            // at rest
  double rate_Hz = 1000.0;
  model::OrganMotion organ_motion{};  // breathing, heartbeat; by itself an organ lies still
  [[nodiscard]] std::size_t hands() const noexcept { return mappings.size(); }
};

/// The touch noise on its way to another strength.
struct NoiseGlide {
  double gain = 0.0;             // K to come to [N m]
  double threshold = 0.0;        // d0 to come to [m]
  std::uint32_t ticks_left = 0;  // 0: it is there
};

/// Everything that changes from tick to tick. Copyable; a copy replays the same.
struct SimulationState {
  /// [setup] The state before tick 0.
  explicit SimulationState(const SimulationWorld& world);

  contact::State contact;
  std::vector<noise::TouchNoise::State> noise;
  std::vector<GateState> gates;
  std::vector<DeviceTrack> tracks;
  std::vector<Engagement> engagements;       // of held devices
  std::vector<DeviceMotion> motions;         // of the devices since the last tick
  std::vector<contact::ToolInput> inputs;    // the last good pose and opening of every hand
  std::vector<contact::ToolResult> results;  // of the last tick, for the picture
  Pose organ_W;                              // at the last tick
  bool noise_enabled = true;
  // What live changes (live_changes.h) made of the world's:
  noise::TouchNoise touch_noise;  // in force
  NoiseGlide noise_glide;
  model::ReachParameters reach;  // for the picture
  std::uint64_t change = 0;      // number of the last change that a tick used; 0: none
};

/// [any] The device's sample that a row was made from, bit for bit.
[[nodiscard]] DeviceState sample_of(const TickRow& row) noexcept;

/// [rt] One haptic tick (docs/model.md, section 4): samples in, rows and commands out. A pure function of its
/// arguments; it reads no clock, so tick_ns and late_ns stay 0.
///
/// A sample that cannot be used (it says so, is not finite, older than kStaleAfter, a quaternion that is
/// none, farther than kFarthest) latches a fault on its hand; contact then goes on with the hand's last good
/// pose, so that the other hands and the picture stay as they were. Rows hold finite numbers only, but for
/// `device`, `device_q`, `device_velocity` and `device_gripper`: they are the sample as it came, so that a
/// replay meets the same fault.
/// @param samples, commands, rows one entry a hand
void tick(const SimulationWorld& world, SimulationState& state, std::uint64_t tick_number,
          std::span<const DeviceState> samples, std::span<ForceCommand> commands,
          std::span<TickRow> rows) noexcept;

}  // namespace palpate::haptics
