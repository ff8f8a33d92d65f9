#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/contact/organ_arrays.h"
#include "io/scene/scene_file.h"
#include "palpate/read_mesh.h"
#include "palpate/units.h"

namespace palpate::scene {

/// Messages about mesh files; each is a sentence that begins with the file's name.
struct MeshNotes {
  std::vector<std::string> repairs;  // repairs that were made
  std::vector<std::string> remarks;  // defects that remain
};

/// [setup] Reads the mesh file of an instrument's part, without repair. @throws InputError naming the field
/// or flag, also when the unit is missing.
[[nodiscard]] mesh_io::LoadedMesh read_part_source(const LocatedString& mesh,
                                                   const std::optional<LengthUnit>& unit, MeshNotes& notes);

/// [setup] Reads and repairs an organ's mesh file, or takes it from `store` (null: none) where a file of this
/// content was read before. @throws InputError naming the field or flag, also when the unit is missing or the
/// mesh cannot be an organ.
[[nodiscard]] contact::ReadOrgan read_organ_source(const LocatedString& mesh,
                                                   const std::optional<LengthUnit>& unit,
                                                   const contact::OrganStore* store, MeshNotes& notes);

}  // namespace palpate::scene
