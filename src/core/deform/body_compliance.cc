// How a whole organ moves when its surface is pressed: a linear elastic body that a support holds.
//
// The organ is cut into cubic cells. Over each lie 27 quadratic B-splines, and the displacement is their sum
// with one vector a node:
//
//        +-----+-----+-----+        whole cells: the same stiffness, computed once
//        |  ..-+-----+-..  |        cut cells: integrated over the part inside the organ
//        +-'---+-----+---'-+        (cell_pieces.h)
//        |'    |     |    '|
//        +-----+-----+-----+
//
// The splines' slopes are continuous, so about a thousand nodes describe how an organ bends and bulges. Close
// to a contact, where cells are too coarse, the half-space's closed form corrects the field
// (response_field.h).
//
// 1. The largest number of cells is chosen that needs at most kMostNodes nodes.
// 2. The stiffness matrix is assembled cell by cell (body_stiffness.h). The held surface is a layer of stiff
//    springs. Where an attachment ends, cells are too large, and smaller ones there say how much softer it is
//    (attachment_joints.h).
// 3. Nodes are ordered by planes across the longest axis of the grid. Two planes make a block, and a block
//    couples with its two neighbours only.
// 4. The inverse (block_inverse.h), one column a node and direction, is the compliance: displacements under
//    unit forces. All forces of a picture then cost one sum over the loaded nodes' columns.
//
// Sources: finite cells (Parvizian, Duester and Rank 2007); B-splines as elements (Hoellig 2003).

#include "core/deform/body_compliance.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Core>

#include "core/base/content_hash.h"
#include "core/deform/attachment_joints.h"
#include "core/deform/body_stiffness.h"
#include "core/deform/half_space.h"
#include "palpate/error.h"

namespace palpate::deform {
namespace {

using Eigen::Index;

#ifdef __EMSCRIPTEN__  // has no vectors, and the page waits for the result
constexpr std::size_t kMostNodes = 400;
#else
constexpr std::size_t kMostNodes = 960;  // half their inverse has 9 MB
#endif
// Rises when the same organ and support get another response.
constexpr std::uint64_t kResponseVersion = 5;
constexpr double kFewestCells = 3.0;  // along the longest extent
constexpr double kMostCells = 60.0;
constexpr int kSteps = 6;             // at most, of the search for the finest cells
constexpr double kFineEnough = 1.02;  // between the finest cells that are known to do and too fine ones

// Hash of everything that a response depends on.
ContentHash response_key(const geometry::TriangleMesh& organ, const geometry::Support& support) {
  ContentHasher hasher;
  hasher.add(kResponseVersion).add(kMostNodes).add(kPoisson);
  hasher.add(kOutside).add(kHeldInside).add(kHeldStiffness);
  hasher.add(std::span<const Vec3>(organ.vertices)).add(std::span<const geometry::Triangle>(organ.triangles));
  hasher.add(support.bed.has_value()).add(support.faces.has_value()).add(support.attachments.size());
  if (support.bed) hasher.add(support.bed->direction).add(support.bed->share);
  if (support.faces) hasher.add(support.faces->away_from);
  for (const auto* list : {&support.attachments, &support.painted})
    for (const geometry::Attachment& one : *list) hasher.add(one.point).add(one.radius);
  return hasher.hash();
}

// The compliance that a cache has kept; empty when it has none that is possible.
std::optional<BodyCompliance> kept_compliance(const contact::OrganStore& store, const ContentHash& key,
                                              const geometry::TriangleMesh& organ) {
  std::optional<contact::ResponseArrays> arrays = store.load_response(key);
  const geometry::Bounds box = geometry::bounds(organ);
  if (!arrays) return std::nullopt;
  const double cells = box.size().maxCoeff() / arrays->cell_edge;  // along the longest extent
  if (!(cells > 0.5 * kFewestCells && cells < 2.0 * kMostCells)) return std::nullopt;
  BodyCompliance made{CellPieces(CellGrid(box, arrays->cell_edge), organ), {}};
  std::optional<BlockInverse> inverse = BlockInverse::of(
      BlockSum::first_rows(made.pieces.planes()), std::move(arrays->scale), std::move(arrays->entries));
  if (!inverse) return std::nullopt;
  made.compliance = *std::move(inverse);
  return made;
}

}  // namespace

CellPieces finest_pieces(const geometry::TriangleMesh& organ) {
  const geometry::Bounds box = geometry::bounds(organ);
  double most = box.size().maxCoeff() / kFewestCells;
  double least = box.size().maxCoeff() / kMostCells;
  CellPieces best(CellGrid(box, most), organ);
  double nodes = static_cast<double>(best.nodes());
  double edge = most;
  for (int step = 0; step < kSteps && most > kFineEnough * least; ++step) {
    // Where the nodes would fit if their number went with the square of 1 / edge.
    edge = std::clamp(edge * std::sqrt(nodes / static_cast<double>(kMostNodes)), kFineEnough * least,
                      most / kFineEnough);
    CellPieces next(CellGrid(box, edge), organ);
    nodes = static_cast<double>(next.nodes());
    const bool fits = next.nodes() <= kMostNodes;
    (fits ? most : least) = edge;
    if (fits) best = std::move(next);
  }
  return best;
}

BodyCompliance body_compliance(const geometry::TriangleMesh& organ, const geometry::Support& support,
                               const contact::OrganStore* store) {
  const ContentHash key = store != nullptr ? response_key(organ, support) : ContentHash{};
  if (store != nullptr) {
    if (std::optional<BodyCompliance> kept = kept_compliance(*store, key, organ)) return *std::move(kept);
  }
  const geometry::HeldSurface held(support, organ);
  geometry::check_support(support, organ);
  BodyCompliance made{finest_pieces(organ), {}};
  const BodyStiffness stiffness(made.pieces, organ, held);
  BlockSum sum(made.pieces.planes());
  for (std::size_t piece = 0; piece < made.pieces.pieces().size(); ++piece) {
    const auto [nodes, matrix] = stiffness.of(piece);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b)
        sum.add(nodes[a], nodes[b], matrix.block<3, 3>(3 * static_cast<Index>(a), 3 * static_cast<Index>(b)));
  }
  std::optional<BlockInverse> inverse =
      BlockInverse::of(std::move(sum.matrix()), softened_joints(made.pieces, organ, support));
  if (!inverse)
    throw InputError("support: holds too little of the organ's surface, so the organ would turn away");
  made.compliance = *std::move(inverse);
  if (store != nullptr)
    store->store_response(
        key, {made.pieces.cells().whole().edge(), made.compliance.scale(), made.compliance.entries()});
  return made;
}

}  // namespace palpate::deform
