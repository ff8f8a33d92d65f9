#pragma once
// The organ's visible surface under the instruments, for those who draw.
#include <cstdint>

#include "palpate/mesh.h"
#include "palpate/pose.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/surface.h"
#include "palpate/tick_observer.h"

namespace palpate::python {

/// The organ's surface as the instruments have moved it at one tick. Contact is always solved against the
/// rest surface: this is for the eye.
struct Surface {
  std::uint64_t tick = 0;
  geometry::TriangleMesh mesh;  // the moved surface, m, in the organ's frame
  Pose organ_W;                 // where the organ is at that tick
};

/// [setup] @throws ParameterError for an edge [m] that is neither 0 nor 0.1 mm to 1 m.
void check_surface_edge(double longest_edge);

/// [setup] The organ's rest surface, divided until no edge is longer. @param longest_edge m; 0: as it is
/// @throws ParameterError as check_surface_edge().
[[nodiscard]] geometry::TriangleMesh visible_surface(const scene::Scene& setup, double longest_edge);

/// [setup] The surface at a snapshot's tick.
[[nodiscard]] Surface surface_at(const haptics::Snapshot& snapshot, deform::SurfaceDeformer& deformer);

/// [setup] The surface at a tick of a recording, whose ticks before are run again. @throws InputError.
[[nodiscard]] Surface surface_of(const record::Recording& recording, std::uint64_t tick, double surface_edge,
                                 bool cache);

}  // namespace palpate::python
