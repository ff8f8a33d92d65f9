#pragma once
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

}  // namespace palpate::report
