#pragma once
#include <filesystem>
#include <string_view>
#include <vector>

#include "io/mesh_io/mesh_file.h"

namespace palpate::mesh_io {

/// [setup] Rejects a .gltf or .glb file that an importer would misread, by the name of the extension that it
/// needs, and one that would exhaust its memory or stack: deep nesting, parts that are used many times,
/// counts that no buffer bounds. @return whether positions of vertices are whole numbers
/// (KHR_mesh_quantization)
/// @throws InputError naming the file and the element.
[[nodiscard]] bool check_gltf(const MeshFile& file);

/// [setup] The JSON text of a .gltf or .glb file. @throws InputError for a .glb file without it.
[[nodiscard]] std::string_view gltf_json_text(const MeshFile& file);

/// [setup] A checked file with quantized positions as a file of the same format, whose positions are floats:
/// the whole numbers, or, where an accessor is normalized, numbers from -1 or 0 to 1. It has no other vertex
/// attributes. @throws InputError naming the file and the accessor.
[[nodiscard]] MeshFile with_float_positions(const MeshFile& file);

/// [setup] The separate buffer files that a .gltf or .glb file names; empty for other meshes. @throws
/// InputError when the mesh cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& mesh);

}  // namespace palpate::mesh_io
