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

/// [setup] Reads a triangle mesh (STL, OBJ, PLY, OFF, 3DS, glTF, legacy VTK, told by the file's ending),
/// merges duplicate vertices, drops unreferenced ones and says so. Node transforms are applied, an importer's
/// axis change undone. Vertices at exactly equal places are one; the triangles' order and turning stay.
/// Coordinates are kept as 32-bit floats, of VTK as they are. Not to be called from two threads at once.
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
