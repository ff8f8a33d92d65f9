#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/deform/block_inverse.h"
#include "core/deform/cell_grid.h"
#include "palpate/mesh.h"
#include "palpate/support.h"

namespace palpate::deform {

/// Surface parts are at most this part of a cell long.
inline constexpr double kPartsOfCell = 4.0;

/// Displacements of the nodes that an organ reaches, under unit forces on them, at Young's modulus 1.
struct BodyCompliance {
  std::vector<std::int32_t> unknown_of;  // per node of the grid: its place in `nodes`; -1: not reached
  std::vector<std::int32_t> nodes;       // numbers of the nodes in the grid
  BlockInverse compliance;               // [m/N]
};

/// [setup] The grid with the smallest cells on which an organ needs at most kMostNodes nodes.
[[nodiscard]] CellGrid finest_grid(const geometry::TriangleMesh& organ);

/// [setup] The compliance of an organ on this grid, computed on all processors; the result does not depend
/// on their number. Empty when too little is held. @param organ closed, outwards
[[nodiscard]] std::optional<BodyCompliance> body_compliance(const CellGrid& grid,
                                                            const geometry::TriangleMesh& organ,
                                                            const geometry::HeldSurface& held);

}  // namespace palpate::deform
