#pragma once
#include <CLI/CLI.hpp>

#include "palpate/scene.h"

namespace palpate::app {

/// [setup] The flags that say what is to be played, as `palpate run` has them. @param request outlives the
/// parse
void add_scene_flags(CLI::App& command, scene::Overrides& request);

}  // namespace palpate::app
