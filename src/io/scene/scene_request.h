#pragma once
#include "io/scene/scene_file.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// [setup] The scene file of a request, or the scene of a run without one, with the request's flags applied.
/// Meshes and paths are not opened.
/// @throws InputError also for a file outside of `request.files_below`, where that is given
[[nodiscard]] SceneFile describe(const Overrides& request);

}  // namespace palpate::scene
