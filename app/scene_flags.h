#pragma once
#include <CLI/CLI.hpp>

#include "palpate/scene.h"

namespace palpate::app {

/// [setup] Adds the flags that select and override a scene, e.g. --organ, to a command. @param request
/// outlives the parse
void add_scene_flags(CLI::App& command, scene::Overrides& request);

}  // namespace palpate::app
