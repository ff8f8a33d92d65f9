#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

// What is checked in a mesh file before any importer sees it, for read_mesh.cc.
namespace palpate::geometry {

enum class MeshFormat { kStl, kObj, kPly, kOff, k3ds, kGltf, kGlb, kVtk };

struct MeshFile {
  std::filesystem::path path;
  MeshFormat format = MeshFormat::kStl;
  std::string bytes;
};

/// What was seen while checking.
struct FileFacts {
  bool has_vertex_list = false;  // the format has one: OBJ, PLY, OFF
  std::size_t vertices = 0;
  std::size_t distinct_vertices = 0;
  std::string cleaned;    // OBJ, PLY, OFF: vertices and faces alone, as OBJ, for the importer
  std::size_t lines = 0;  // OBJ: lines, points and curves that `cleaned` leaves out
};

/// [setup] Opens and reads the file. @throws InputError: missing, no file, unknown ending, empty, too large.
[[nodiscard]] MeshFile open_mesh_file(const std::filesystem::path& path);

/// [setup] Checks what an importer would trust: declared counts against the file's size, every number finite,
/// every vertex index in range. @throws InputError naming the file and the line or element.
FileFacts check_mesh_file(const MeshFile& file);

}  // namespace palpate::geometry
