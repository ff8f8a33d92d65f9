#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

// What is checked in a mesh file before any importer sees it, for read_mesh.cc.
namespace palpate::geometry {

enum class MeshFormat { kStl, kObj, kPly, kOff, k3ds, kGltf, kGlb };

struct MeshFile {
  std::filesystem::path path;
  MeshFormat format = MeshFormat::kStl;
  std::string bytes;
};

/// What the file itself says about its vertices; known where the format has a list of them (OBJ, PLY, OFF).
struct VertexFacts {
  bool known = false;
  std::size_t vertices = 0;
  std::size_t distinct = 0;
};

/// [setup] Opens and reads the file. @throws InputError: missing, no file, unknown ending, empty, too large.
[[nodiscard]] MeshFile open_mesh_file(const std::filesystem::path& path);

/// [setup] Checks what an importer would trust: declared counts against the file's size, every number finite,
/// every vertex index in range. @throws InputError naming the file and the line or element.
VertexFacts check_mesh_file(const MeshFile& file);

}  // namespace palpate::geometry
