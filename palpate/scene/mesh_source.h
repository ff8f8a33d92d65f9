#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/base/units.h"
#include "palpate/geometry/read_mesh.h"
#include "palpate/scene/scene_file.h"

namespace palpate::scene {

/// [setup] Reads the mesh file that a user named; what was repaired or is wrong with it goes into `remarks`,
/// a sentence each. @throws InputError naming the field or flag, also when the unit is missing.
[[nodiscard]] geometry::LoadedMesh read_mesh_source(const Stated& mesh, const std::optional<LengthUnit>& unit,
                                                    std::vector<std::string>& remarks);

}  // namespace palpate::scene
