#pragma once
#include <cstdint>
#include <vector>

#include "core/deform/surface_blocks.h"
#include "palpate/mesh.h"
#include "palpate/pose.h"

namespace palpate::render {

/// A surgical drape spread level under an organ, with the soft shadow of the organ at rest. World frame.
struct Drape {
  std::vector<deform::SurfaceVertex> vertices;  // `moved`: share of the light from above that reaches it
  std::vector<std::uint32_t> corners;           // three per triangle, seen from above
  Vec3 middle = Vec3::Zero();                   // under the organ's middle
  double radius = 0.0;                          // m; the drape is drawn up to here
};

/// [setup] The drape that touches the organ's lowest point. The light is a sky: a place of the drape loses
/// the share that the organ's underside covers, the form factor of a patch A at height h and horizontal
/// distance d, h^2 A / (pi (h^2 + d^2)^2), summed over the underside.
[[nodiscard]] Drape drape_below(const geometry::TriangleMesh& organ, const Pose& organ_W);

}  // namespace palpate::render
