#pragma once
#include "core/contact/organ_arrays.h"
#include "core/deform/block_inverse.h"
#include "core/deform/cell_pieces.h"
#include "palpate/mesh.h"
#include "palpate/support.h"

namespace palpate::deform {

/// Displacements of the nodes that an organ reaches, under unit forces on them, at Young's modulus 1.
struct BodyCompliance {
  CellPieces pieces;
  BlockInverse compliance;  // [m/N]
};

/// [setup] The pieces in the smallest cells on which an organ needs at most kMostNodes nodes.
[[nodiscard]] CellPieces finest_pieces(const geometry::TriangleMesh& organ);

/// [setup] The compliance of an organ in its finest cells, computed on all processors, or from `store`; the
/// result depends on neither. @param organ closed, outwards @param store may be null @throws as
/// prepare_response()
[[nodiscard]] BodyCompliance body_compliance(const geometry::TriangleMesh& organ,
                                             const geometry::Support& support,
                                             const contact::OrganStore* store);

}  // namespace palpate::deform
