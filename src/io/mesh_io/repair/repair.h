#pragma once
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/read_mesh.h"

namespace palpate::geometry {

/// A surface made fit to be an organ, or as far as that went.
struct RepairedSurface {
  TriangleMesh mesh;
  std::vector<std::string> repairs;  // what was done, in words with counts
  std::vector<std::string> remarks;  // what is left and does no harm
  std::size_t crossing_pairs = 0;    // of triangles left that go through each other
  std::string refusal;               // why it cannot be an organ; empty: it can
};

/// [setup] Makes a triangle surface closed, manifold and turned outwards, with SurfaceDistance in mind: drops
/// triangles that name a vertex twice, duplicates, dangling and internal faces, joins boundaries that meet,
/// parts surfaces that touch in a vertex or an edge, turns triangles alike and outwards, closes small holes,
/// takes out triangles without area, drops small components and inner shells. What it returns it leaves alone
/// when called again. A mesh that needs nothing keeps its vertices and triangles and their order.
/// docs/file-formats.md says what is small. All tolerances are shares of the mesh's own size.
[[nodiscard]] RepairedSurface repair_surface(TriangleMesh mesh);

/// [setup] Repairs what was read from a file, adds what was done to its findings, and refuses what cannot be
/// an organ all the same. @param name file, for the message. @throws InputError in words.
[[nodiscard]] LoadedMesh repair_organ(LoadedMesh loaded, const std::string& name);

}  // namespace palpate::geometry
