#pragma once
#include <vector>

#include "io/scene/mesh_source.h"
#include "io/scene/scene_file.h"
#include "palpate/tool.h"

namespace palpate::scene {

/// [setup] Reads the meshes of one tool, which may be open, and transforms them to the handle's frame.
/// Repairs and remaining defects are added to `notes`. @throws InputError naming the field or flag.
[[nodiscard]] geometry::Tool load_instrument(const ToolTable& description, MeshNotes& notes);

/// [setup] Chooses the axes of several jaws so that they open away from each other. The axis is x or y, the
/// one that is perpendicular to the line between the jaws' centroids. Pivot and angle do not change. Not for
/// jaws whose axis is in a scene file.
void open_apart(std::vector<geometry::ToolPart>& jaws);

}  // namespace palpate::scene
