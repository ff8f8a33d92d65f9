#pragma once
#include <filesystem>
#include <vector>

#include "io/mesh_io/mesh_file.h"

namespace palpate::geometry {

/// [setup] Rejects a .gltf or .glb file that would exhaust an importer's memory or stack: deep nesting, parts
/// that are used many times, counts that no buffer bounds. @throws InputError naming the file and the
/// element.
void check_gltf(const MeshFile& file);

/// [setup] The separate buffer files that a .gltf or .glb file names; empty for other meshes. @throws
/// InputError when the mesh cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& mesh);

}  // namespace palpate::geometry
