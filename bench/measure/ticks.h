#pragma once
#include <cstddef>
#include <vector>

#include "core/haptics/simulation.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

#include "bench/measure/account.h"

namespace palpate::bench {

/// Largest distance [m] of a tick that counts as approach.
inline constexpr double kNear = 20e-3;

/// Pose of the tool at a tick and Palpate's result, as reference for peers.
struct PathPoint {
  Pose handle_W;
  double gripper = 0.0;
  contact::Phase phase = contact::Phase::kApproach;
  double distance = 0.0;  // from tool to organ [m]
};

/// [setup] Runs all ticks of the path without timing.
[[nodiscard]] std::vector<PathPoint> run_path(const scene::Scene& scene,
                                              const haptics::SimulationWorld& world,
                                              const scene::ToolPath& path);

/// [setup] CPU time of whole ticks along the path, `passes` times from a new state: device sample, tick,
/// gate, and the row into the ring of a recorder that writes a file meanwhile. @throws std::runtime_error
/// when the path has no contact, InputError when no temporary file can be made.
[[nodiscard]] TickAccount time_ticks(const scene::Scene& scene, const haptics::SimulationWorld& world,
                                     const scene::ToolPath& path, int passes);

/// [setup] CPU time of OrganSurface::nearest() at the tool's tip along the path, sixteen queries at a time.
[[nodiscard]] NearestAccount time_nearest(const scene::Scene& scene, const std::vector<PathPoint>& way);

/// [setup] Positions of the tool's tip along the path: its farthest vertex along +z, in the organ's frame.
[[nodiscard]] std::vector<Vec3> tip_points(const scene::Scene& scene, const std::vector<PathPoint>& way);

/// Queries between two readings of the clock, because a reading takes as long as one query.
inline constexpr std::size_t kPointsAtOnce = 16;

}  // namespace palpate::bench
