#pragma once
#include <string>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// How a mesh is kept in the archive (src/io/shapes/mesh_archive.h).
struct Packing {
  int grid =
      0;  // vertices are rounded to 2^-grid m; 0: every bit of mesh, order of vertices and triangles included
  int divisions = 0;  // how often the reader divides each triangle into four
};

/// [setup] Appends an entry to an archive.
/// @param mesh closed and of one piece unless the packing is exact
/// @throws InputError when the archive does not give back the mesh: bit by bit, or within half a step of the
/// grid.
void pack_mesh(std::string& archive, const std::string& name, const TriangleMesh& mesh,
               const Packing& packing);

}  // namespace palpate::geometry
