#pragma once
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/read_mesh.h"
#include "palpate/units.h"

// A mesh file in memory and its reader, for read_mesh.cc and formats/.
namespace palpate::mesh_io {

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
  geometry::TriangleMesh mesh;
  std::vector<std::string> repairs;  // divided polygons, dropped lines and points, mirrored parts
};

/// [setup] Adds what was done with the parts of a file that has parts. @param mirrored parts whose triangles
/// were turned @param lines lines and points that were dropped
void note_parts(ImportedMesh& imported, std::size_t mirrored, std::size_t lines);

/// [any] The format by the file's extension; empty for an extension without a reader.
[[nodiscard]] std::optional<MeshFormat> mesh_format(const std::filesystem::path& path);

/// [setup] Opens and reads the file. @throws InputError: missing, no file, unknown extension, empty, too
/// large.
[[nodiscard]] MeshFile open_mesh_file(const std::filesystem::path& path);

/// [setup] The axes that a file's header declares as 3D Slicer writes it, in upper case: SPACE=LPS in the
/// header of an STL, in a comment of a PLY or OBJ, in the title of a VTK file or in its field data; or
/// LPS or RAS by another program's words, such as "space: left-posterior-superior". Empty: none.
[[nodiscard]] std::string declared_space(const MeshFile& file);

/// [setup] Reads the mesh with its format's reader. The reader bounds declared counts by the file's size and
/// checks all coordinates and vertex indices. Call from one thread at a time (assimp has one global log).
/// @throws InputError naming the file, the line, byte or element, the value and what would be right.
[[nodiscard]] ImportedMesh import_mesh(const MeshFile& file);

/// [setup] As read_mesh() of a path. @throws InputError
[[nodiscard]] LoadedMesh read_mesh(MeshFile file, LengthUnit unit);

}  // namespace palpate::mesh_io
