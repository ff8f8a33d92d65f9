#pragma once
#include <vector>

#include "palpate/offscreen.h"
#include "palpate/scene.h"
#include "palpate/support.h"

namespace palpate::report {

/// [any] What the pictures of a scene show.
[[nodiscard]] render::Subject subject_of(const scene::Scene& scene);

/// [setup] An organ from above (-z) and beside it from below, y upwards in both, with the parts of the
/// surface that a support holds in colour. @param height of the picture, in pixels @throws as
/// OffscreenRenderer
[[nodiscard]] render::Image draw_held(const geometry::TriangleMesh& organ, const geometry::Support& support,
                                      int height);

/// Places of an organ's surface that are close enough to colour it.
struct SurfacePlaces {
  std::vector<Vec3> points;   // [m], organ frame
  std::vector<Vec3> normals;  // outwards, any length
};
[[nodiscard]] SurfacePlaces places_of(const geometry::TriangleMesh& organ);
/// [setup] 1 where the support holds a place, else NaN. @throws as geometry::validate()
[[nodiscard]] std::vector<float> held_values(const geometry::TriangleMesh& organ, const SurfacePlaces& places,
                                             const geometry::Support& support);

/// [setup] An organ at rest from above and from below, as draw_held(), with these values in colour.
[[nodiscard]] render::Image draw_both_sides(const geometry::TriangleMesh& organ, render::SurfaceValues values,
                                            int height);

}  // namespace palpate::report
