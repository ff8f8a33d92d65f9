#pragma once
#include <filesystem>
#include <vector>

#include "io/mesh_io/mesh_file.h"

namespace palpate::geometry {

/// [setup] Looks through the JSON of a .gltf or .glb file for what would take an importer's memory or stack:
/// nesting, parts that are used again and again, counts that no buffer bounds. @throws InputError naming the
/// file and the element.
void check_gltf(const MeshFile& file);

/// [setup] The files of buffers that a .gltf or .glb file names; other meshes have none. @throws InputError
/// when the mesh cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& mesh);

}  // namespace palpate::geometry
