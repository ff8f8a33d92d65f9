#pragma once
#include "palpate/offscreen.h"
#include "palpate/scene.h"

namespace palpate::report {

/// [any] What the pictures of a scene show.
[[nodiscard]] render::Subject subject_of(const scene::Scene& scene);

}  // namespace palpate::report
