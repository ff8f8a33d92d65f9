#pragma once
#include <CLI/CLI.hpp>

#include "palpate/scene.h"

namespace palpate::app {

/// [setup] Adds the flags that select and override a scene, e.g. --organ, to a command. @param request
/// outlives the parse
void add_scene_flags(CLI::App& command, scene::Overrides& request);

/// [setup] Adds those of them that describe organ, tool and rate: all but --task, --device, --seed and the
/// flags of the noise and the device's fit.
void add_organ_and_tool_flags(CLI::App& command, scene::Overrides& request);

}  // namespace palpate::app
