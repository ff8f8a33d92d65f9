#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palpate::deform {

/// A symmetric positive matrix in which each block of rows couples with its two neighbours only. Matrices are
/// stored column by column.
struct BlockMatrix {
  std::vector<std::size_t> first;             // row of each block; the number of rows at the end
  std::vector<std::vector<double>> diagonal;  // only lower halves are used
  std::vector<std::vector<double>> coupling;  // rows of block k+1, columns of block k

  [[nodiscard]] std::size_t blocks() const noexcept { return diagonal.size(); }
  [[nodiscard]] std::size_t size(std::size_t block) const noexcept { return first[block + 1] - first[block]; }
};

/// Takes share_m f_m f_m' off a matrix for every mode m.
struct Softening {
  std::vector<double> forces;  // f_m, column by column
  std::vector<double> shares;  // above 0

  [[nodiscard]] bool empty() const noexcept { return shares.empty(); }
};

/// [any] Replaces a matrix by Cholesky's factor. @return false when it is not positive
[[nodiscard]] bool factorize(BlockMatrix& matrix);
/// [any] Replaces columns by those of the inverse times them. @param factor of factorize()
void solve(BlockMatrix& factor, std::vector<double>& columns);

/// The whole inverse of such a matrix with three rows a node: its blocks on the diagonal and below, each
/// column in 32,767ths of its largest entry. [any] once made.
class BlockInverse final {
 public:
  using ByAxis = std::array<std::vector<float>, 3>;
  using Weights = std::span<const std::pair<std::int32_t, float>>;  // of nodes, in their order

  /// [setup] Computed on all processors; the result does not depend on their number. Empty when the matrix is
  /// not positive.
  [[nodiscard]] static std::optional<BlockInverse> of(BlockMatrix matrix, const Softening& softening = {});
  /// [setup] An inverse with the scale() and entries() of one that was computed before. Empty when a matrix
  /// with these blocks has another number of them. @param first as BlockMatrix::first
  [[nodiscard]] static std::optional<BlockInverse> of(std::vector<std::size_t> first,
                                                      std::vector<float> scale,
                                                      std::vector<std::int16_t> entries);

  [[nodiscard]] std::size_t rows() const noexcept { return scale_.size(); }
  [[nodiscard]] const std::vector<float>& scale() const noexcept { return scale_; }
  [[nodiscard]] const std::vector<std::int16_t>& entries() const noexcept { return entries_; }

  /// The weighted sums of the nodes' columns of each axis.
  [[nodiscard]] ByAxis columns(Weights weights) const;

 private:
  // The place of a block's first entry; those of all blocks come before the end's.
  [[nodiscard]] std::size_t start(std::size_t block) const noexcept;
  // Adds the columns of a block's nodes, from the block's first row on.
  void add_columns(std::size_t block, Weights weights, ByAxis& sums) const;
  // Adds the rows of nodes below a block to the block's own rows: its columns by symmetry.
  void add_rows(std::size_t block, Weights weights, ByAxis& sums) const;

  std::vector<std::size_t> first_;     // row of each block; the number of rows at the end
  std::vector<float> scale_;           // per column
  std::vector<std::int16_t> entries_;  // of one block after the other: its columns from its own first row on
};

}  // namespace palpate::deform
