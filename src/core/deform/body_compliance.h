#pragma once
#include <cstdint>
#include <vector>

#include "core/contact/organ_arrays.h"
#include "core/deform/block_inverse.h"
#include "core/deform/cell_grid.h"
#include "palpate/mesh.h"
#include "palpate/support.h"

namespace palpate::deform {

/// Surface parts are at most this part of a cell long.
inline constexpr double kPartsOfCell = 4.0;

/// Displacements of the nodes that an organ reaches, under unit forces on them, at Young's modulus 1.
struct BodyCompliance {
  CellGrid grid;
  std::vector<std::int32_t> unknown_of;  // per node of the grid: its place in `nodes`; -1: not reached
  std::vector<std::int32_t> nodes;       // numbers of the nodes in the grid
  BlockInverse compliance;               // [m/N]
};

/// [setup] The grid with the smallest cells on which an organ needs at most kMostNodes nodes.
[[nodiscard]] CellGrid finest_grid(const geometry::TriangleMesh& organ);

/// [setup] The compliance of an organ on its finest grid, computed on all processors, or from `store`; the
/// result depends on neither. @param organ closed, outwards @param store may be null @throws as
/// prepare_response()
[[nodiscard]] BodyCompliance body_compliance(const geometry::TriangleMesh& organ,
                                             const geometry::Support& support,
                                             const contact::OrganStore* store);

}  // namespace palpate::deform
