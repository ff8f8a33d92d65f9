#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "core/deform/block_inverse.h"
#include "core/deform/cell_pieces.h"
#include "palpate/mesh.h"
#include "palpate/support.h"

namespace palpate::deform {

inline constexpr double kOutside = 1e-4;  // stiffness outside the organ in cut cells
inline constexpr double kHeldInside =
    15.0;  // of springs inside, times Young's modulus by the square of a cell
inline constexpr double kHeldStiffness = 15.0;  // of the held surface's springs, times Young's modulus / cell

/// Stiffness of the pieces of an organ at Young's modulus 1, and of the springs that hold it.
class BodyStiffness final {
 public:
  /// Couples the nodes of a piece with each other: 3 x 3 blocks in the nodes' order.
  struct OfPiece {
    std::vector<std::int32_t> nodes;  // ascending
    Eigen::MatrixXd matrix;
  };

  /// [setup] @param pieces must live as long @param held its surface is held by springs, its inside by others
  BodyStiffness(const CellPieces& pieces, const geometry::TriangleMesh& organ,
                const geometry::HeldSurface& held);

  [[nodiscard]] std::vector<std::int32_t> nodes_of(std::size_t piece) const;
  [[nodiscard]] OfPiece of(std::size_t piece) const;

 private:
  using Products = Eigen::Matrix<double, CellGrid::kNodesOfCell, CellGrid::kNodesOfCell>;
  // Between the splines of a piece: entry (3 first + i, 3 second + j).
  [[nodiscard]] Eigen::MatrixXd of_splines(std::size_t piece) const;

  const CellPieces& pieces_;
  Eigen::MatrixXd whole_;                    // products of slopes over a whole cell
  std::map<std::size_t, Products> springs_;  // by piece
};

/// Sums couplings of nodes in blocks, two planes of nodes each.
class BlockSum final {
 public:
  /// [setup] @param planes the first node of each plane, and the number of nodes at the end
  explicit BlockSum(const std::vector<std::size_t>& planes);
  /// Adds the coupling of two nodes; the one with the larger number is the row.
  void add(std::int32_t row, std::int32_t column, const Eigen::Matrix3d& stiffness);
  [[nodiscard]] BlockMatrix& matrix() noexcept { return matrix_; }
  /// [setup] BlockMatrix::first of such a sum.
  [[nodiscard]] static std::vector<std::size_t> first_rows(const std::vector<std::size_t>& planes);

 private:
  BlockMatrix matrix_;
  std::vector<std::size_t> block_of_;  // per node
};

}  // namespace palpate::deform
