#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/units.h"

namespace palpate::mesh_io {

/// Properties of a mesh, and the repairs and defects of its file.
struct MeshFindings {
  bool closed = false;
  bool manifold = false;
  int shells = 0;
  double volume = 0.0;                        // [m^3]
  std::optional<std::size_t> crossing_pairs;  // pairs of triangles that intersect; empty: not searched
  std::vector<std::string> repairs;           // repairs that were made, one sentence per repair
  std::vector<std::string> defects;           // remaining defects; an organ must not have any
  std::vector<std::string> remarks;           // harmless remaining defects
};

struct LoadedMesh {
  geometry::TriangleMesh mesh;  // metres
  MeshFindings findings;
  std::string space{};  // axes that the file's header declares: "LPS" of SPACE=LPS (3D Slicer); empty: none
};

/// [setup] File name extensions of the meshes that read_mesh() reads: ".stl", ".obj", ...
[[nodiscard]] std::vector<std::string> mesh_file_extensions();
/// [setup] Whether a path has one of these extensions, in lower or upper case.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& path);

/// [setup] Reads a triangle mesh, or the outer surface of a solid mesh (legacy VTK, Gmsh); the file name
/// extension decides the format. Merges vertices with exactly equal coordinates, drops unused ones, and lists
/// these repairs. Applies node transforms and keeps the file's axes. Keeps the order and orientation of the
/// triangles. Coordinates of STL, OBJ and OFF are 32-bit floats. Call from one thread at a time.
/// @param unit of the coordinates in the file; it is never guessed, and a missing unit is an error
/// @throws InputError that names the file and the defect: missing, unknown extension, empty, truncated, NaN,
/// index out of range, no triangles, ...
[[nodiscard]] LoadedMesh read_mesh(const std::filesystem::path& file, std::optional<LengthUnit> unit);

/// [setup] The properties of any mesh, also of a built-in one; `repairs` is empty. `closed`: every edge
/// has at least two triangles. `manifold`: no edge has more than two, and no vertex joins separate surfaces.
/// `shells`: components that are connected by edges. A sliver is a triangle whose height is below 2e-7 of its
/// longest edge.
[[nodiscard]] MeshFindings findings_of(const geometry::TriangleMesh& mesh);

/// [setup] Rejects a mesh that cannot be an organ: open, not manifold, oriented inwards, or with a bounding
/// box outside 5 mm to 2 m. @param name file or built-in name, for the message @throws InputError that names
/// the defects.
void require_organ(const LoadedMesh& loaded, const std::string& name);

/// [setup] Rejects a mesh that cannot be a tool: a largest side outside 0.1 mm to 5 m, as of a file whose
/// numbers were misread. @param name file, for the message @throws InputError that names the size.
void require_tool(const LoadedMesh& loaded, const std::string& name);

}  // namespace palpate::mesh_io

namespace palpate::geometry {  // the names of earlier versions
using mesh_io::findings_of;
using mesh_io::is_mesh_file;
using mesh_io::LoadedMesh;
using mesh_io::mesh_file_extensions;
using mesh_io::MeshFindings;
using mesh_io::read_mesh;
using mesh_io::require_organ;
}  // namespace palpate::geometry
