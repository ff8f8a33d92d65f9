#pragma once
#include <filesystem>
#include <vector>

#include "io/mesh_io/mesh_file.h"

// One reader per format, as import_mesh(): [setup], @throws InputError.
namespace palpate::mesh_io {

/// STL, text or binary: a list of triangles, each with its own three vertices.
[[nodiscard]] ImportedMesh read_stl(const MeshFile& file);
/// OBJ: vertices and faces. Ignores textures, normals, materials and groups.
[[nodiscard]] ImportedMesh read_obj(const MeshFile& file);
[[nodiscard]] ImportedMesh read_off(const MeshFile& file);
/// PLY, text or binary of either byte order.
[[nodiscard]] ImportedMesh read_ply(const MeshFile& file);
/// Legacy VTK, text or binary, versions 1 to 5: POLYDATA and UNSTRUCTURED_GRID of flat or solid cells.
[[nodiscard]] ImportedMesh read_vtk(const MeshFile& file);
/// Gmsh's MSH of versions 2 and 4, text or binary.
[[nodiscard]] ImportedMesh read_msh(const MeshFile& file);
/// 3DS, by assimp, after checks of the values that assimp trusts.
[[nodiscard]] ImportedMesh read_3ds(const MeshFile& file);
/// glTF 2.0: .gltf or .glb.
[[nodiscard]] ImportedMesh read_gltf(const MeshFile& file);
/// The separate buffer files that a .gltf or .glb file names; empty for other meshes. @throws InputError when
/// the mesh cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& mesh);

}  // namespace palpate::mesh_io
