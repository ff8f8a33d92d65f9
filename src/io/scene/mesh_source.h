#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/scene/scene_file.h"
#include "palpate/read_mesh.h"
#include "palpate/units.h"

namespace palpate::scene {

/// What is to be told of mesh files, a sentence each, beginning with the file.
struct MeshNotes {
  std::vector<std::string> repairs;  // what was done
  std::vector<std::string> remarks;  // what is wrong and was left
};

/// [setup] Reads the mesh file of an instrument's part that a user named, to be used as it is.
/// @throws InputError naming the field or flag, also when the unit is missing.
[[nodiscard]] geometry::LoadedMesh read_part_source(const Stated& mesh, const std::optional<LengthUnit>& unit,
                                                    MeshNotes& notes);

/// [setup] Reads the mesh file of an organ that a user named and repairs it. @throws InputError as above, and
/// when it cannot be an organ.
[[nodiscard]] geometry::TriangleMesh read_organ_source(const Stated& mesh,
                                                       const std::optional<LengthUnit>& unit,
                                                       MeshNotes& notes);

}  // namespace palpate::scene
