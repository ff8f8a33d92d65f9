#pragma once
#include <cstddef>
#include <vector>

#include "core/contact/contact.h"
#include "core/haptics/simulation.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

#include "bench/measure/account.h"

namespace palpate::bench {

/// Farther away than this [m] a tick counts as neither approach nor contact.
inline constexpr double kNear = 20e-3;

/// Where the hand was at a tick, and what palpate found there: what a peer is asked about.
struct WayPoint {
  Pose handle_W;
  double gripper = 0.0;
  contact::Phase phase = contact::Phase::kApproach;
  double distance = 0.0;  // tool to organ [m]
};

/// [setup] All ticks of one way, back to back; nothing is timed.
[[nodiscard]] std::vector<WayPoint> walk(const scene::Setup& setup, const haptics::SimulationWorld& world,
                                         const scene::ToolPath& path);

/// [setup] Processor time of whole ticks along the way, `passes` times from a fresh state: device sample,
/// tick, gate, and the row into the ring of a recorder that writes a file meanwhile.
/// @throws std::runtime_error when the way never came into contact, InputError when no temporary file can be
/// made.
[[nodiscard]] TickAccount time_ticks(const scene::Setup& setup, const haptics::SimulationWorld& world,
                                     const scene::ToolPath& path, int passes);

/// [setup] Processor time of OrganSurface::nearest() at the tool's tip along the way, sixteen at a time.
[[nodiscard]] NearestAccount time_nearest(const scene::Setup& setup, const std::vector<WayPoint>& way);

/// [setup] The tool's tip along the way: its farthest vertex along +z, in the organ's frame.
[[nodiscard]] std::vector<Vec3> tip_points(const scene::Setup& setup, const std::vector<WayPoint>& way);

/// So many points are asked between two readings of the clock, which takes as long as one of them.
inline constexpr std::size_t kPointsAtOnce = 16;

}  // namespace palpate::bench
