#pragma once
#include "io/mesh_io/mesh_file.h"

namespace palpate::geometry {

/// [setup] Walks a PLY file, text or binary, element by element: that all it declares is there, that every
/// coordinate is finite and every vertex index in range. @throws InputError naming the file and the element.
FileFacts check_ply(const MeshFile& file);

}  // namespace palpate::geometry
