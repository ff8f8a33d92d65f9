#pragma once
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/read_mesh.h"

namespace palpate::mesh_io {

/// A surface after repair, and whether it can be an organ.
struct RepairedSurface {
  geometry::TriangleMesh mesh;
  std::vector<std::string> repairs;  // a sentence for each kind of repair, with counts
  std::vector<std::string> remarks;  // harmless defects that remain
  std::size_t crossing_pairs = 0;    // pairs of triangles that still intersect
  std::string refusal;               // why it cannot be an organ; empty if it can
  std::string remedy = "repair it in a mesh tool first";
};

/// [setup] Makes a triangle surface closed, manifold and oriented outwards, as signed distances need it. It
/// drops triangles that use a vertex twice, duplicates, dangling and internal faces. It welds boundaries,
/// splits non-manifold edges and bow-tie vertices, orients triangles consistently, fills small holes, and
/// removes slivers, small components and inner shells. Repairing twice gives the same result. A valid mesh
/// keeps its vertices, triangles and their order. docs/file-formats.md defines "small"; all tolerances are
/// relative to the mesh's size.
/// @param is_sound findings_of() finds nothing in the mesh and it is one shell, so no repair is tried
[[nodiscard]] RepairedSurface repair_surface(geometry::TriangleMesh mesh, bool is_sound = false);

/// [setup] Repairs a mesh from a file and adds the repairs to its findings. @param name file, for the message
/// @throws InputError naming the defect of a mesh that cannot be an organ.
[[nodiscard]] LoadedMesh repair_organ(LoadedMesh loaded, const std::string& name);

}  // namespace palpate::mesh_io
