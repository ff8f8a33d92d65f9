#pragma once
// The organ's visible surface, for display.
#include <cstdint>

#include "palpate/mesh.h"
#include "palpate/pose.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/surface.h"
#include "palpate/tick_observer.h"

namespace palpate::python {

/// The organ's surface at one tick, deformed by the instruments. It is for display only; contact is always
/// computed on the rest surface.
struct Surface {
  std::uint64_t tick = 0;
  geometry::TriangleMesh mesh;  // deformed surface, m, organ frame
  Pose organ_W;                 // pose of the organ at that tick
};

/// [setup] @throws ParameterError unless the edge is 0 or 0.1 mm to 1 m.
void check_surface_edge(double longest_edge);

/// [setup] The organ's rest surface, subdivided until no edge is longer than `longest_edge`.
/// @param longest_edge m; 0: no subdivision @throws ParameterError as check_surface_edge() does
[[nodiscard]] geometry::TriangleMesh visible_surface(const scene::Scene& scene, double longest_edge);

/// [setup] The surface at the tick of a snapshot.
[[nodiscard]] Surface surface_at(const haptics::Snapshot& snapshot, deform::SurfaceDeformer& deformer);

/// [setup] The surface at a tick of a recording, computed by a replay up to that tick. @throws InputError
[[nodiscard]] Surface surface_of(const record::Recording& recording, std::uint64_t tick, double surface_edge,
                                 bool cache);

}  // namespace palpate::python
