#pragma once
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "palpate/mesh.h"

// A mesh file and its reader, for read_mesh.cc and formats/.
namespace palpate::geometry {

inline constexpr std::size_t kMostTriangles = 20'000'000;
/// What a mesh file can hold, and squares of it can be summed.
inline constexpr double kLargestCoordinate = std::numeric_limits<float>::max();

enum class MeshFormat { kStl, kObj, kPly, kOff, k3ds, kGltf, kGlb, kVtk, kMsh };

struct MeshFile {
  std::filesystem::path path;
  MeshFormat format = MeshFormat::kStl;
  std::string bytes;
};

/// What a file holds: vertices in the file's unit and axes, node transforms applied.
struct ImportedMesh {
  TriangleMesh mesh;
  std::vector<std::string> repairs;  // polygons cut up, lines and points dropped, mirrored parts turned
};

/// [any] By the path's ending; none for one that no reader has.
[[nodiscard]] std::optional<MeshFormat> mesh_format(const std::filesystem::path& path);

/// [setup] Opens and reads the file. @throws InputError: missing, no file, unknown ending, empty, too large.
[[nodiscard]] MeshFile open_mesh_file(const std::filesystem::path& path);

/// [setup] The mesh by its format's reader, which bounds declared counts by the file's size and checks every
/// coordinate and vertex index. Not to be called from two threads at once (assimp has one log for all).
/// @throws InputError naming the file, the line, byte or element, the value and what would be right.
[[nodiscard]] ImportedMesh import_mesh(const MeshFile& file);

}  // namespace palpate::geometry
