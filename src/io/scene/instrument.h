#pragma once
#include <vector>

#include "io/scene/mesh_source.h"
#include "io/scene/scene_file.h"
#include "palpate/tool.h"

namespace palpate::scene {

/// [setup] Reads the meshes of one tool and places them in the handle's frame; they need not be closed. What
/// was repaired or is wrong with them goes into `notes`. @throws InputError naming the field or flag.
[[nodiscard]] geometry::Tool load_instrument(const ToolDescription& description, MeshNotes& notes);

/// [setup] Turns the openings of several jaws, each about its own axis, so that they open apart: the axis is
/// x or y, whichever is across the line between the jaws' middles, and the sign takes each jaw away from
/// the others. Pivot and size of the opening stay. [Not for jaws whose axis a scene gives.]
void open_apart(std::vector<geometry::ToolPart>& jaws);

}  // namespace palpate::scene
