#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/units.h"

namespace palpate::geometry {

/// What was found in a mesh file and what was done about it.
struct MeshFindings {
  bool closed = false;
  bool manifold = false;
  int shells = 0;
  double volume = 0.0;  // [m^3]
  std::optional<std::size_t>
      crossing_pairs;                // of triangles that go through each other, once they were looked for
  std::vector<std::string> repairs;  // done, in words
  std::vector<std::string> defects;  // left as they are, in words: an organ may not have them
  std::vector<std::string> remarks;  // left as they are and harmless, in words
};

struct LoadedMesh {
  TriangleMesh mesh;  // metres
  MeshFindings findings;
};

/// [setup] Endings of the mesh files that read_mesh() reads: ".stl", ".obj", ...
[[nodiscard]] std::vector<std::string> mesh_file_endings();
/// [setup] Whether a path has one of these endings, in small or capital letters.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& path);

/// [setup] Reads a triangle mesh, or the outer surface of a solid mesh (legacy VTK, Gmsh), told by the file's
/// ending; merges duplicate vertices, drops unreferenced ones and says so. Node transforms are applied, an
/// importer's axis change undone. Vertices at exactly equal places are one; the triangles' order and turning
/// stay. Coordinates of STL, OBJ and OFF are 32-bit floats, others as the file has them. Not to be called
/// from two threads at once.
/// @param unit of the file's numbers; never guessed: none is an error
/// @throws InputError naming the file and what is wrong: missing, unknown ending, empty, truncated, NaN,
/// index out of range, no triangles, ...
[[nodiscard]] LoadedMesh read_mesh(const std::filesystem::path& file, std::optional<LengthUnit> unit);

/// [setup] What can be said of any mesh, built-in ones too (`repairs` stays empty). `closed`: no edge of one
/// triangle; `manifold`: no edge of more than two, no vertex where separate surfaces touch; `shells`: parts
/// that hang together by edges; triangles without area are those lower than 2e-7 of their longest edge.
[[nodiscard]] MeshFindings findings_of(const TriangleMesh& mesh);

/// [setup] Refuses what cannot be an organ: open, not manifold, turned inwards, bounding box outside 5 mm to
/// 2 m. @param name file or built-in name, for the message. @throws InputError
/// in words.
void require_organ(const LoadedMesh& loaded, const std::string& name);

}  // namespace palpate::geometry
