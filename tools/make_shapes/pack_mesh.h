#pragma once
#include <string>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// How the archive stores a mesh (src/io/shapes/mesh_archive.h).
struct Packing {
  int grid =
      0;  // vertices are rounded to 2^-grid m; 0: every bit of mesh, order of vertices and triangles included
  int divisions = 0;  // how often the reader divides each triangle into four
};

/// [setup] Appends an entry to an archive. @param mesh closed and connected, unless the packing is exact
/// @throws InputError when the entry does not read back as the mesh: bit for bit, or within half a step of
/// the grid.
void pack_mesh(std::string& archive, const std::string& name, const TriangleMesh& mesh,
               const Packing& packing);

}  // namespace palpate::geometry
