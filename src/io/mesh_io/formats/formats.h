#pragma once
#include "io/mesh_io/mesh_file.h"

// One reader a format, each as import_mesh() says: [setup], @throws InputError.
namespace palpate::geometry {

/// STL, text or binary: a list of triangles with corners of their own.
[[nodiscard]] ImportedMesh read_stl(const MeshFile& file);
/// Vertices and faces; textures, normals, materials and groups are nothing to a surface.
[[nodiscard]] ImportedMesh read_obj(const MeshFile& file);
[[nodiscard]] ImportedMesh read_off(const MeshFile& file);
/// PLY, text or binary of either byte order.
[[nodiscard]] ImportedMesh read_ply(const MeshFile& file);
/// Legacy VTK, text or binary, versions 1 to 5: POLYDATA and UNSTRUCTURED_GRID of flat or solid cells.
[[nodiscard]] ImportedMesh read_vtk(const MeshFile& file);
/// Gmsh's MSH of versions 2 and 4, text or binary.
[[nodiscard]] ImportedMesh read_msh(const MeshFile& file);
/// 3DS and glTF, by assimp after a check of what it would believe.
[[nodiscard]] ImportedMesh read_3ds(const MeshFile& file);
[[nodiscard]] ImportedMesh read_gltf(const MeshFile& file);

}  // namespace palpate::geometry
