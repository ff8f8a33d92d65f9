#pragma once
#include <string>
#include <vector>

#include "io/mesh_io/mesh_file.h"
#include "palpate/mesh.h"

namespace palpate::geometry {

/// What assimp found in a file: vertices in the file's unit and axes, node transforms applied, as they are.
struct ImportedMesh {
  TriangleMesh mesh;
  std::vector<std::string> repairs;  // polygons cut up, lines and points dropped, mirrored parts turned
};

/// [setup] Hands a checked file to assimp. Not to be called from two threads at once (assimp's log is one for
/// all). @throws InputError naming the file.
[[nodiscard]] ImportedMesh import_mesh(const MeshFile& file, const FileFacts& facts);

}  // namespace palpate::geometry
