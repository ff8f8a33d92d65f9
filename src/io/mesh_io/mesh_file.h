#pragma once
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "palpate/mesh.h"

// A mesh file in memory and its reader, for read_mesh.cc and formats/.
namespace palpate::geometry {

inline constexpr std::size_t kMaxTriangles = 20'000'000;
/// Largest coordinate of a mesh; sums of its squares stay finite.
inline constexpr double kLargestCoordinate = std::numeric_limits<float>::max();

enum class MeshFormat { kStl, kObj, kPly, kOff, k3ds, kGltf, kGlb, kVtk, kMsh };

struct MeshFile {
  std::filesystem::path path;
  MeshFormat format = MeshFormat::kStl;
  std::string bytes;
};

/// The content of a mesh file: vertices in the file's unit and axes, node transforms applied.
struct ImportedMesh {
  TriangleMesh mesh;
  std::vector<std::string> repairs;  // divided polygons, dropped lines and points, mirrored parts
};

/// [any] The format by the file's extension; empty for an extension without a reader.
[[nodiscard]] std::optional<MeshFormat> mesh_format(const std::filesystem::path& path);

/// [setup] Opens and reads the file. @throws InputError: missing, no file, unknown extension, empty, too
/// large.
[[nodiscard]] MeshFile open_mesh_file(const std::filesystem::path& path);

/// [setup] Reads the mesh with its format's reader. The reader bounds declared counts by the file's size and
/// checks all coordinates and vertex indices. Call from one thread at a time (assimp has one global log).
/// @throws InputError naming the file, the line, byte or element, the value and what would be right.
[[nodiscard]] ImportedMesh import_mesh(const MeshFile& file);

}  // namespace palpate::geometry
