#pragma once
#include "io/mesh_io/import_mesh.h"
#include "io/mesh_io/mesh_file.h"

namespace palpate::geometry {

/// [setup] Reads a legacy VTK file (.vtk), text or binary, versions 1 to 5: POLYDATA (polygons, triangle
/// strips) and UNSTRUCTURED_GRID of triangles, strips, polygons, pixels and quads. Vertices, lines, fields,
/// metadata and what belongs to points or cells are passed over. Coordinates keep all their bits.
/// @throws InputError naming the file, the line (text) or byte (binary), the field and the value.
[[nodiscard]] ImportedMesh read_vtk(const MeshFile& file);

}  // namespace palpate::geometry
