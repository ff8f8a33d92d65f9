#pragma once
#include "core/deform/block_inverse.h"
#include "core/deform/cell_pieces.h"
#include "palpate/mesh.h"
#include "palpate/support.h"

namespace palpate::deform {

/// [setup] By how much the stiffness of an organ in cells is too large at its attachments.
/// @param organ closed, outwards
[[nodiscard]] Softening softened_joints(const CellPieces& pieces, const geometry::TriangleMesh& organ,
                                        const geometry::Support& support);

}  // namespace palpate::deform
